#include "floor/floor.h"

namespace weir::passes {

void CameraRays::describe(PassDescription& d) {
  d.doc("One camera ray a pixel and nothing else: what a traced G-buffer costs at the least");
  d.output("triangle", storageImage(Format::R32U)).doc("Index of the triangle that it met, 0xffffffff where none was");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
}

void CameraRays::prepare(PrepareContext& c) {
  kernel_ = c.rayKernel("camera_rays.glsl");
}

void CameraRays::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
