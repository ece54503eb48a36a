#include "reference/path_tracer.h"

#include "common/layouts.h"

namespace weir::passes {

void PathTracer::describe(PassDescription& d) {
  d.doc(
      "Unbiased path tracing from the first visible surface: all lights, all materials, any number of bounces; nothing "
      "is reused or clamped");
  d.input("surface", perPixel<PackedSurface>());
  d.input("emission", storageImage(Format::RGBA32F));
  d.output("color", storageImage(Format::RGBA32F)).radiance();
  d.param("maxBounces", 64)
      .range(0, 1024)
      .unit("bounces")
      .doc("Bounces of indirect light; 0: direct light only. What more of them would bring is left out");
  d.param("samples", 1).range(1, 1024).doc("Paths a pixel and frame");
  d.param("rouletteStart", 3)
      .range(0, 1024)
      .unit("bounces")
      .doc(
          "After so many bounces a path goes on with the probability of its throughput's largest colour, and then "
          "stands for those that ended: without bias. From maxBounces on: never");
  d.param("lightSampling", "mis")
      .oneOf({"mis", "lights", "bsdf"})
      .specialises()
      .doc(
          "How light from emissive triangles and environment is found: by light samples and by the BSDF's rays, "
          "weighed "
          "by the balance heuristic, or by one of them alone: noisier, and a check");
  d.param("uniformShare", 0.1f)
      .range(0, 1)
      .doc("Share of the light samples picked uniformly among all lights, the rest by power");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
}

void PathTracer::prepare(PrepareContext& c) {
  kernel_ = c.rayKernel("path_tracer.glsl");
}

void PathTracer::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
