#include <weir/scene/emission_map.h>
#include <weir/scene/mipmaps.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace weir::scene {
namespace {

// What a colour that nobody sees still counts for, so that texels around a cut-out have one.
constexpr float kLeastWeight = 1.0f / 256.0f;

float weightOf(float alpha) {
  return kLeastWeight + alpha * (1.0f - kLeastWeight);
}

/// The texels of the larger level that one of the smaller covers along an axis: two, or three where the side is odd and
/// the outer ones are covered in part (Guthe and Heckbert 2005, "Non-power-of-two mipmapping").
struct Taps {
  uint32_t first = 0, count = 1;
  std::array<float, 3> weights{1.0f, 0.0f, 0.0f};
};

Taps tapsOf(uint32_t i, uint32_t side) {
  if (side == 1) return {};
  const uint32_t half = side / 2;
  if (side % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0.0f}};
  const auto n = static_cast<float>(side);
  return {2 * i, 3, {static_cast<float>(half - i) / n, static_cast<float>(half) / n, static_cast<float>(i + 1) / n}};
}

/// A level as floats, colours linear and, where they are weighted, multiplied by their weight.
using Level = std::vector<glm::vec4>;

/// Halves a level whose texel (x, y) is texel(y * width + x).
template <class Texel>
Level halve(uint32_t width, uint32_t height, const Texel& texel) {
  const uint32_t w = std::max(1u, width / 2), h = std::max(1u, height / 2);
  Level result(static_cast<size_t>(w) * h);
  std::vector<Taps> columns(w);
  for (uint32_t x = 0; x < w; ++x) columns[x] = tapsOf(x, width);
  for (uint32_t y = 0; y < h; ++y) {
    const Taps rows = tapsOf(y, height);
    glm::vec4* to = result.data() + static_cast<size_t>(y) * w;
    for (uint32_t j = 0; j < rows.count; ++j) {
      const size_t row = static_cast<size_t>(rows.first + j) * width;
      for (uint32_t x = 0; x < w; ++x) {
        const Taps& taps = columns[x];
        glm::vec4 sum = texel(row + taps.first) * taps.weights[0];
        for (uint32_t i = 1; i < taps.count; ++i) sum += texel(row + taps.first + i) * taps.weights[i];
        to[x] += sum * rows.weights[j];
      }
    }
  }
  return result;
}

/// Truncation after adding this rounds what isn't negative to the nearest; lround() takes longer than all else here.
constexpr float kToNearest = 0.5f;

uint8_t toCode(float value) {
  return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + kToNearest);
}

/// Linear to the nearest sRGB code (IEC 61966-2-1), to 1/40 of a code step.
uint8_t toSrgbCode(float linear) {
  static const std::vector<uint8_t> table = [] {
    std::vector<uint8_t> t(65536);
    for (size_t i = 0; i < t.size(); ++i) {
      const double l = static_cast<double>(i) / 65535.0;
      t[i] = static_cast<uint8_t>((l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055) * 255.0 +
                                  double{kToNearest});
    }
    return t;
  }();
  return table[static_cast<size_t>(std::clamp(linear, 0.0f, 1.0f) * 65535.0f + kToNearest)];
}

void store(const Level& level, const MipContent& content, std::vector<uint8_t>& to) {
  for (glm::vec4 t : level) {
    if (content.weightByAlpha) t = glm::vec4(glm::vec3(t) / weightOf(t.a), t.a);
    for (int c = 0; c < 3; ++c) to.push_back(content.srgb ? toSrgbCode(t[c]) : toCode(t[c]));
    to.push_back(toCode(t.a));
  }
}

}  // namespace

uint32_t mipLevelCount(uint32_t width, uint32_t height) {
  return static_cast<uint32_t>(std::bit_width(std::max(width, height)));
}

std::vector<uint8_t> makeMipmaps(const Image& image, const MipContent& content) {
  std::vector<uint8_t> result;
  if (image.width * image.height <= 1) return result;
  result.reserve(image.rgba.size() / 2);
  std::array<float, 256> decode{};
  for (int i = 0; i < 256; ++i) {
    const auto code = static_cast<uint8_t>(i);
    decode[i] = content.srgb ? srgbToLinear(code) : static_cast<float>(i) / 255.0f;
  }
  const auto fromImage = [&](size_t i) {
    const uint8_t* c = image.rgba.data() + 4 * i;
    glm::vec4 t(decode[c[0]], decode[c[1]], decode[c[2]], static_cast<float>(c[3]) / 255.0f);
    return content.weightByAlpha ? glm::vec4(glm::vec3(t) * weightOf(t.a), t.a) : t;
  };
  uint32_t width = image.width, height = image.height;
  Level level = halve(width, height, fromImage);
  for (;;) {
    store(level, content, result);
    width = std::max(1u, width / 2);
    height = std::max(1u, height / 2);
    if (width * height == 1) return result;
    level = halve(width, height, [&](size_t i) { return level[i]; });
  }
}

}  // namespace weir::scene
