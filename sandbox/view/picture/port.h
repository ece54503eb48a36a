// A port as it lies on the device after a frame.
#pragma once

#include <weir/execute/frame_constants.h>
#include <weir/execute/resources.h>

namespace weir::view {

/// What `execute::Executor::locate` gives, in VK_IMAGE_LAYOUT_GENERAL, or an UploadedPicture; and of the frame that
/// made it what positions follow from.
struct Port {
  const execute::Storage& storage;
  const graph::Resource& resource;
  execute::GpuCamera camera = {};  ///< execute::toGpu; of ports `@previous` the camera of the frame before
  bool f90 = false;                ///< the scene has that trait: surfaces pack roughness in another way
};

}  // namespace weir::view
