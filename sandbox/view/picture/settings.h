// What shaders/view/settings.glsl reads, number for number.
#pragma once

#include <weir/execute/frame_constants.h>

#include <cstdint>

namespace weir::view {

struct Settings {
  execute::GpuCamera camera;
  float place[2], scale[2];
  int32_t clip[2];
  uint32_t clipSize[2], extent[2];
  uint32_t elements, perPixel, element, stride, code, word, shows, flags;
  float low, high, gain;
  uint32_t background;
};
static_assert(sizeof(Settings) == 152);

/// Bits of Settings::flags.
enum Flag : uint32_t {
  kFalseColor = 1,
  kLogarithmic = 2,
  kEncoded = 4,
  kMarkRange = 8,
  kBox = 16,
  kAbsolute = 32,
  kSigned = 64,
};

}  // namespace weir::view
