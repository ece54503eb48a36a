#include <weir/image/flip_filters.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weir::image {
namespace {

constexpr double kPi = std::numbers::pi;

/// Table 1: spatial Gaussians a · sqrt(π/b) · exp(-π² r²/b), r in degrees, per opponent channel.
struct Spread {
  double a, b;
};
constexpr Spread kSpreads[3][2] = {
    {{1.0, 0.0047}, {0.0, 1e-5}}, {{1.0, 0.0053}, {0.0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};
constexpr double kWidestSpread = 0.04;
constexpr double kFeatureWidth = 0.082;  // degrees, the width of what counts as an edge or a point

int radiusOf(double sigmaPixels) {
  return std::max(1, static_cast<int>(std::ceil(3.0 * sigmaPixels)));
}

/// Drops outer taps that cannot be seen in a float.
Kernel trimmed(const std::vector<double>& taps) {
  double largest = 0;
  for (double t : taps) largest = std::max(largest, std::abs(t));
  size_t cut = 0;
  while (2 * cut + 3 < taps.size() && std::abs(taps[cut]) < 1e-10 * largest) ++cut;
  Kernel kernel;
  for (size_t i = cut; i < taps.size() - cut; ++i) kernel.push_back(float(taps[i]));
  return kernel;
}

double sum(const std::vector<double>& taps) {
  double total = 0;
  for (double t : taps) total += t;
  return total;
}

Sensitivity makeSensitivity(const Spread (&spreads)[2], double pixelsPerDegree) {
  // One radius for all channels: three standard deviations of the widest Gaussian.
  const int radius = radiusOf(std::sqrt(kWidestSpread / (2.0 * kPi * kPi)) * pixelsPerDegree);
  Sensitivity result;
  double shares[2] = {}, total = 0;
  for (size_t g = 0; g < 2; ++g) {
    if (spreads[g].a == 0.0) continue;
    std::vector<double> taps;
    for (int i = -radius; i <= radius; ++i) {
      const double r = i / pixelsPerDegree;
      taps.push_back(std::exp(-kPi * kPi * r * r / spreads[g].b));
    }
    const double area = sum(taps);
    shares[g] = spreads[g].a * std::sqrt(kPi / spreads[g].b) * area * area;
    total += shares[g];
    for (double& t : taps) t /= area;
    result.kernels[g] = trimmed(taps);
  }
  for (size_t g = 0; g < 2; ++g) result.weights[g] = float(shares[g] / total);
  return result;
}

/// Scales positive taps to sum to 1 and negative ones to -1, so that a step of height 1 answers with 1 (section 4.2).
void normaliseSigns(std::vector<double>& taps) {
  double positive = 0, negative = 0;
  for (double t : taps) (t > 0 ? positive : negative) += t;
  for (double& t : taps) t /= t > 0 ? positive : -negative;
}

void rows(const Plane& in, const Kernel& kernel, Plane& out) {
  const size_t radius = kernel.size() / 2, width = in.width;
  std::vector<float> padded(width + 2 * radius);
  for (uint32_t y = 0; y < in.height; ++y) {
    const float* row = &in.values[size_t{y} * width];
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy(row, row + width, padded.begin() + static_cast<std::ptrdiff_t>(radius));
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(radius), radius, row[width - 1]);
    float* target = &out.values[size_t{y} * width];
    std::fill_n(target, width, 0.0f);
    for (size_t k = 0; k < kernel.size(); ++k) {  // taps outside, pixels inside: the compiler vectorises pixels
      for (size_t x = 0; x < width; ++x) target[x] += kernel[k] * padded[x + k];
    }
  }
}

/// Adds weight · (in convolved along columns) to `out`.
void addColumns(const Plane& in, const Kernel& kernel, float weight, Plane& out) {
  const int radius = static_cast<int>(kernel.size() / 2), height = static_cast<int>(in.height);
  const size_t width = in.width;
  for (int y = 0; y < height; ++y) {
    float* target = &out.values[size_t(y) * width];
    for (int k = -radius; k <= radius; ++k) {
      const float tap = weight * kernel[size_t(k + radius)];
      const float* row = &in.values[size_t(std::clamp(y + k, 0, height - 1)) * width];
      for (size_t x = 0; x < width; ++x) target[x] += tap * row[x];
    }
  }
}

}  // namespace

FlipKernels makeFlipKernels(double pixelsPerDegree) {
  FlipKernels result;
  for (size_t c = 0; c < 3; ++c) result.sensitivity[c] = makeSensitivity(kSpreads[c], pixelsPerDegree);
  const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
  const int radius = radiusOf(sigma);
  std::vector<double> smooth, first, second;
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2.0 * sigma * sigma));
    smooth.push_back(g);
    first.push_back(-i * g);
    second.push_back((i * i / (sigma * sigma) - 1.0) * g);
  }
  const double area = sum(smooth);
  for (double& t : smooth) t /= area;
  normaliseSigns(first);
  normaliseSigns(second);
  result.smooth = trimmed(smooth);
  result.first = trimmed(first);
  result.second = trimmed(second);
  return result;
}

Plane applySensitivity(const Plane& plane, const Sensitivity& sensitivity) {
  Plane along(plane.width, plane.height), result(plane.width, plane.height);
  for (size_t g = 0; g < 2; ++g) {
    if (sensitivity.kernels[g].empty()) continue;
    rows(plane, sensitivity.kernels[g], along);
    addColumns(along, sensitivity.kernels[g], sensitivity.weights[g], result);
  }
  return result;
}

Features findFeatures(const Plane& lightness, const FlipKernels& kernels) {
  const auto length = [&](const Kernel& derivative) {
    Plane along(lightness.width, lightness.height), x = along, y = along;
    rows(lightness, derivative, along);
    addColumns(along, kernels.smooth, 1.0f, x);
    rows(lightness, kernels.smooth, along);
    addColumns(along, derivative, 1.0f, y);
    for (size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
    return x;
  };
  return {length(kernels.first), length(kernels.second)};
}

}  // namespace weir::image
