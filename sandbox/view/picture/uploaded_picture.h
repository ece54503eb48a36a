// A picture from a file, on the device, so that it is shown as a port is.
#pragma once

#include <weir/execute/resources.h>
#include <weir/image/image.h>

#include <string>

namespace weir::view {

class UploadedPicture {
 public:
  /// RGBA32F; waits for the copy. InputError when it has no pixels, fewer values than pixels, or more of them than the
  /// device's images can have.
  UploadedPicture(const gpu::Device& device, const image::Picture& picture, const std::string& name);

  const execute::Storage& storage() const { return storage_; }
  const graph::Resource& resource() const { return resource_; }

 private:
  execute::Storage storage_;
  graph::Resource resource_;
};

}  // namespace weir::view
