// What this room accepts from files, so that a corrupt header cannot ask for all memory. Internal to framework/image.
#pragma once

#include <weir/core/error.h>
#include <weir/image/image.h>

#include <cstdint>
#include <string>

namespace weir::image {

constexpr uint64_t kMaxSide = 65536;
constexpr uint64_t kMaxPixels = uint64_t{1} << 28;

/// "cannot read 'x.exr': reason", the shape of every InputError of this room.
[[noreturn]] void failRead(const std::string& path, const std::string& reason);
/// Throws InputError unless 1 <= side <= kMaxSide and width·height <= kMaxPixels.
void checkReadSize(const std::string& path, uint64_t width, uint64_t height);
/// Throws RuntimeError unless the picture has a size and 4 floats a pixel.
void checkWritable(const std::string& path, const Picture& picture);

}  // namespace weir::image
