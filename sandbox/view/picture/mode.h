// How a channel is shown: what a user turns in the panel beside the picture.
#pragma once

#include <cstdint>

namespace weir::view {

enum class Sign : uint8_t {
  Plain,
  Absolute,  ///< |v|
  Split,     ///< negative red, positive green, by their size
};

/// Values v become (v · 2^exposure - low) / (high - low), which is clamped to 0 … 1 and shown grey, as a colour or in
/// false colour. Numbers that are not finite are magenta, as in PNG files. What is out of bounds (a range that is not
/// finite, |exposure| above kMostExposure) is an InputError when it is drawn; an empty range (low >= high) shows which
/// values reach `high`.
struct PictureMode {
  float low = 0.0f, high = 1.0f;
  float exposure = 0.0f;  ///< EV; only of channels that are `exposed`
  /// Dark violet over blue and green to light yellow, evenly; of colours their luminance.
  bool falseColor = false;
  /// By the logarithm of v; then `low` <= 0 stands for high / 65536, and what is not positive counts as below.
  bool logarithmic = false;
  Sign sign = Sign::Plain;
  bool markRange = false;  ///< blue below the range, red above it
  bool box = true;         ///< shrunk pictures: the mean of what a canvas pixel covers; else the one in its middle
  uint32_t element = 0;    ///< which of a pixel's elements, where a port has several
};
inline constexpr float kMostExposure = 64.0f;

}  // namespace weir::view
