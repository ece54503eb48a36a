#include <weir/scene/emission_map.h>
#include <weir/scene/lights.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace weir::scene {
namespace {

/// A span of base texels [low, high) of one axis.
struct Piece {
  uint32_t low, high;
};

/// The texels of [low, high) texture units after wrapping, as at most two pieces. A span of a whole period takes all of
/// them; a mirrored one is widened to the texels it touches, each counted once (this is a mean, not an integral).
int wrapSpan(double low, double high, uint32_t size, Wrap wrap, Piece (&pieces)[2]) {
  const double n = size;
  // Grown by a texel on both sides: what bilinear filtering can reach.
  const double first = std::floor(low * n) - 1.0, last = std::floor(high * n) + 2.0;
  const auto whole = [&] {
    pieces[0] = {0, size};
    return 1;
  };
  if (!(last - first < n)) return whole();
  if (wrap == Wrap::ClampToEdge) {
    const double a = std::clamp(first, 0.0, n - 1.0), b = std::clamp(last, a + 1.0, n);
    pieces[0] = {static_cast<uint32_t>(a), static_cast<uint32_t>(b)};
    return 1;
  }
  const double period = wrap == Wrap::Repeat ? n : 2.0 * n;
  const double start = first - std::floor(first / period) * period;  // in [0, period)
  const double end = start + (last - first);
  const auto at = [](double x) { return static_cast<uint32_t>(x); };
  if (wrap == Wrap::Repeat) {
    if (!(start < n)) return whole();  // huge coordinates leave no fraction
    pieces[0] = {at(start), at(std::min(end, n))};
    if (end <= n) return 1;
    pieces[1] = {0, at(end - n)};
    return 2;
  }
  // Mirrored: [0,n) forwards, [n,2n) backwards, then forwards again.
  if (end <= n)
    pieces[0] = {at(start), at(end)};
  else if (start < n)
    pieces[0] = {at(std::min(start, 2 * n - end)), size};
  else if (end <= 2 * n)
    pieces[0] = {at(2 * n - end), at(2 * n - start)};
  else
    pieces[0] = {0, at(std::max(2 * n - start, end - 2 * n))};
  if (pieces[0].high > size || pieces[0].low >= pieces[0].high) return whole();
  return 1;
}

}  // namespace

float srgbToLinear(uint8_t code) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t;
    for (int i = 0; i < 256; ++i) {
      const double c = i / 255.0;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table[code];
}

TexelSums::TexelSums(const Image& image, Wrap wrapS, Wrap wrapT, double most)
    : width_(image.width), height_(image.height), wrapS_(wrapS), wrapT_(wrapT), scale_(most / kUnit) {}

template <typename Value>
void TexelSums::fill(const Image& image, const Value& value) {
  table_.assign(static_cast<size_t>(width_ + 1) * (height_ + 1), 0);
  for (uint32_t y = 0; y < height_; ++y) {
    uint64_t row = 0;
    const uint8_t* texel = image.rgba.data() + static_cast<size_t>(y) * width_ * 4;
    for (uint32_t x = 0; x < width_; ++x, texel += 4) {
      const double v = value(texel);
      if (v > 0.0) row += std::max<uint64_t>(1, static_cast<uint64_t>(std::min(v, kUnit)));
      table_[static_cast<size_t>(y + 1) * (width_ + 1) + x + 1] = sum(x + 1, y) + row;
    }
  }
}

EmissionMap::EmissionMap(const Image& image, Wrap wrapS, Wrap wrapT, const glm::vec3& factor)
    : TexelSums(image, wrapS, wrapT, luminance(factor)) {
  const double brightest = luminance(factor);
  double red[256], green[256], blue[256];
  for (int i = 0; i < 256; ++i) {
    const double linear = srgbToLinear(static_cast<uint8_t>(i)) * kUnit / brightest;
    red[i] = 0.2126 * factor.x * linear;
    green[i] = 0.7152 * factor.y * linear;
    blue[i] = 0.0722 * factor.z * linear;
  }
  fill(image, [&](const uint8_t* texel) { return red[texel[0]] + green[texel[1]] + blue[texel[2]]; });
}

CoverageMap::CoverageMap(const Image& image, Wrap wrapS, Wrap wrapT, float factor, std::optional<float> cutoff)
    : TexelSums(image, wrapS, wrapT, 1.0) {
  double coverage[256];
  for (int i = 0; i < 256; ++i) {
    const double alpha = static_cast<double>(factor) * i / 255.0;
    // Devices filter with errors of their own: what just misses the cutoff may pass it there.
    constexpr double kSlack = 1.0 / 256.0;
    coverage[i] = kUnit * (cutoff ? (alpha >= *cutoff - kSlack ? 1.0 : 0.0) : std::clamp(alpha, 0.0, 1.0));
  }
  fill(image, [&](const uint8_t* texel) { return coverage[texel[3]]; });
}

double TexelSums::mean(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) const {
  const glm::vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  Piece columns[2], rows[2];
  const int nx = wrapSpan(low.x, high.x, width_, wrapS_, columns), ny = wrapSpan(low.y, high.y, height_, wrapT_, rows);
  uint64_t total = 0, texels = 0;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const Piece &x = columns[i], &y = rows[j];
      total += sum(x.high, y.high) - sum(x.low, y.high) - sum(x.high, y.low) + sum(x.low, y.low);
      texels += static_cast<uint64_t>(x.high - x.low) * (y.high - y.low);
    }
  return static_cast<double>(total) * scale_ / static_cast<double>(std::max<uint64_t>(texels, 1));
}

}  // namespace weir::scene
