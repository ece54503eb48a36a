#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/bench_pictures.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace weir::render {
namespace {

constexpr uint32_t kCropSide = 256;

/// Nine colours of matplotlib's "magma" (CC0), evenly spaced; straight lines between them.
constexpr std::array<std::array<uint8_t, 3>, 9> kMagma = {{{0x00, 0x00, 0x04},
                                                           {0x1c, 0x10, 0x44},
                                                           {0x4f, 0x12, 0x7b},
                                                           {0x81, 0x25, 0x81},
                                                           {0xb5, 0x36, 0x7a},
                                                           {0xe5, 0x50, 0x64},
                                                           {0xfb, 0x87, 0x61},
                                                           {0xfe, 0xc2, 0x87},
                                                           {0xfc, 0xfd, 0xbf}}};

}  // namespace

Crop cropOf(const std::optional<Crop>& asked, uint32_t width, uint32_t height) {
  if (!asked) {
    const uint32_t w = std::min(width, kCropSide), h = std::min(height, kCropSide);
    return {(width - w) / 2, (height - h) / 2, w, h};
  }
  const Crop& c = *asked;
  if (c[2] == 0 || c[3] == 0 || uint64_t{c[0]} + c[2] > width || uint64_t{c[1]} + c[3] > height)
    throw InputError(fmt::format("--crop {},{},{},{}: must lie inside of {}x{} pixels and hold some", c[0], c[1], c[2],
                                 c[3], width, height));
  return c;
}

image::Picture cropped(const image::Picture& picture, const Crop& crop) {
  const auto [x, y, w, h] = crop;
  image::Picture result{w, h, {}, {}};
  result.rgba.reserve(size_t{4} * w * h);
  for (uint32_t row = y; row < y + h; ++row) {
    const float* from = picture.at(x, row);
    result.rgba.insert(result.rgba.end(), from, from + size_t{4} * w);
  }
  return result;
}

float displayScale(const image::Picture& reference) {
  std::vector<float> brightest;
  for (size_t i = 0; i < reference.rgba.size(); i += 4)
    brightest.push_back(std::max({reference.rgba[i], reference.rgba[i + 1], reference.rgba[i + 2]}));
  if (brightest.empty()) return 1.0f;
  const auto at = brightest.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(brightest.size() - 1));
  std::nth_element(brightest.begin(), at, brightest.end());
  return *at > 0.0f && std::isfinite(1.0f / *at) ? 1.0f / *at : 1.0f;
}

image::Picture scaled(image::Picture picture, float scale) {
  for (float& v : picture.rgba) v *= scale;
  return picture;
}

image::Picture heatMap(std::span<const float> values, uint32_t width, const Crop& crop) {
  const auto [x, y, w, h] = crop;
  image::Picture result{w, h, std::vector<float>(size_t{4} * w * h, 1.0f), {}};
  for (uint32_t row = 0; row < h; ++row) {
    for (uint32_t column = 0; column < w; ++column) {
      const float value = std::clamp(values[size_t{y + row} * width + x + column], 0.0f, 1.0f);
      const float place = value * static_cast<float>(kMagma.size() - 1);
      const size_t low = std::min(static_cast<size_t>(place), kMagma.size() - 2);
      const float share = place - static_cast<float>(low);
      for (size_t c = 0; c < 3; ++c) {
        const float a = kMagma[low][c], b = kMagma[low + 1][c];
        result.at(column, row)[c] = (a + (b - a) * share) / 255.0f;
      }
    }
  }
  return result;
}

}  // namespace weir::render
