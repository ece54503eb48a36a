// Section and equation numbers are those of the 2020 paper unless "HDR" stands before them.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/image/flip.h>
#include <weir/image/flip_filters.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <limits>
#include <numbers>

namespace weir::image {
namespace {

using Rgb = std::array<float, 3>;
using Matrix = std::array<std::array<double, 3>, 3>;

constexpr float kColourExponent = 0.7f;    // q_c, compresses large colour differences
constexpr float kColourKnee = 0.4f;        // p_c, of the largest difference
constexpr float kColourKneeValue = 0.95f;  // p_t, what the knee is mapped to
constexpr float kFeatureExponent = 0.5f;   // q_f

double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Matrix inverse(const Matrix& m) {
  const double d = determinant(m);
  Matrix result;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) {
      const size_t a = (c + 1) % 3, b = (c + 2) % 3, e = (r + 1) % 3, f = (r + 2) % 3;
      result[r][c] = (m[a][e] * m[b][f] - m[a][f] * m[b][e]) / d;
    }
  }
  return result;
}

Rgb multiply(const Matrix& m, const Rgb& v) {
  Rgb result;
  for (size_t r = 0; r < 3; ++r) result[r] = float(m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2]);
  return result;
}

/// Linear Rec.709 to XYZ relative to the white point (Y of white is 1), from the primaries and D65 of BT.709-6.
struct ColourSpace {
  Matrix toXyz, toRgb;
  Rgb white;

  ColourSpace() {
    constexpr double primaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}}, w[2] = {0.3127, 0.3290};
    for (size_t c = 0; c < 3; ++c) {
      const double x = primaries[c][0], y = primaries[c][1];
      toXyz[0][c] = x / y;
      toXyz[1][c] = 1.0;
      toXyz[2][c] = (1.0 - x - y) / y;
    }
    const std::array<double, 3> whiteXyz{w[0] / w[1], 1.0, (1.0 - w[0] - w[1]) / w[1]};
    const Matrix scale = inverse(toXyz);
    for (size_t c = 0; c < 3; ++c) {
      const double s = scale[c][0] * whiteXyz[0] + scale[c][1] * whiteXyz[1] + scale[c][2] * whiteXyz[2];
      for (size_t r = 0; r < 3; ++r) toXyz[r][c] *= s;
    }
    toRgb = inverse(toXyz);
    for (size_t c = 0; c < 3; ++c) white[c] = float(whiteXyz[c]);
  }

  /// Section 4.1.1: the linearised CIELAB that the contrast sensitivity functions were measured in.
  Rgb toOpponent(const Rgb& rgb) const {
    Rgb xyz = multiply(toXyz, rgb);
    for (size_t c = 0; c < 3; ++c) xyz[c] /= white[c];
    return {116.0f * xyz[1] - 16.0f, 500.0f * (xyz[0] - xyz[1]), 200.0f * (xyz[1] - xyz[2])};
  }
  Rgb fromOpponent(const Rgb& o) const {
    const float y = (o[0] + 16.0f) / 116.0f;
    return multiply(toRgb, {(o[1] / 500.0f + y) * white[0], y * white[1], (y - o[2] / 200.0f) * white[2]});
  }

  /// CIELAB with the Hunt adjustment of section 4.1.2: colours of dark pixels look less colourful.
  Rgb toHuntLab(const Rgb& rgb) const {
    const Rgb xyz = multiply(toXyz, rgb);
    const auto f = [](float t) {
      constexpr float d = 6.0f / 29.0f;
      return t > d * d * d ? std::cbrt(t) : t / (3.0f * d * d) + 4.0f / 29.0f;
    };
    const float fx = f(xyz[0] / white[0]), fy = f(xyz[1] / white[1]), fz = f(xyz[2] / white[2]);
    const float l = 116.0f * fy - 16.0f;
    return {l, 0.01f * l * 500.0f * (fx - fy), 0.01f * l * 200.0f * (fy - fz)};
  }
};

/// HyAB distance (Abasi et al. 2020), compressed: section 4.1.3.
float colourDistance(const Rgb& a, const Rgb& b) {
  return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), kColourExponent);
}

float decodeSrgb(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// Narkowicz' fit of the ACES curve with its exposure of 0.6 taken in: HDR section 3.
struct Aces {
  static constexpr double a = 0.6 * 0.6 * 2.51, b = 0.6 * 0.03, c = 0.6 * 0.6 * 2.43, d = 0.6 * 0.59, e = 0.14;
  static float map(float x) {
    const double v = double(x);
    // Far out both polynomials overflow, and the quotient is their leading coefficients'.
    if (v > 1e100) return 1.0f;
    return float(std::clamp((a * v + b) * v / ((c * v + d) * v + e), 0.0, 1.0));
  }
  /// The x > 0 that is mapped to y.
  static double inverse(double y) {
    const double p = a - y * c, q = b - y * d, r = -y * e;
    return (-q + std::sqrt(q * q - 4.0 * p * r)) / (2.0 * p);
  }
};

/// What one picture brings into the comparison.
struct Prepared {
  std::vector<Rgb> lab;  // filtered by contrast sensitivity, Hunt-adjusted
  Features features;
};

Prepared prepare(const std::vector<Rgb>& linear, uint32_t width, uint32_t height, const ColourSpace& space,
                 const FlipKernels& kernels) {
  Plane planes[3] = {Plane(width, height), Plane(width, height), Plane(width, height)};
  Plane lightness(width, height);
  for (size_t i = 0; i < linear.size(); ++i) {
    const Rgb o = space.toOpponent(linear[i]);
    for (size_t c = 0; c < 3; ++c) planes[c].values[i] = o[c];
    lightness.values[i] = (o[0] + 16.0f) / 116.0f;
  }
  Prepared result;
  result.features = findFeatures(lightness, kernels);
  for (size_t c = 0; c < 3; ++c) planes[c] = applySensitivity(planes[c], kernels.sensitivity[c]);
  result.lab.resize(linear.size());
  for (size_t i = 0; i < linear.size(); ++i) {
    Rgb rgb = space.fromOpponent({planes[0].values[i], planes[1].values[i], planes[2].values[i]});
    for (float& v : rgb) v = std::clamp(v, 0.0f, 1.0f);
    result.lab[i] = space.toHuntLab(rgb);
  }
  return result;
}

/// Sections 4.1.3, 4.2 and 4.3, of linear pictures in [0,1].
std::vector<float> compare(const std::vector<Rgb>& test, const std::vector<Rgb>& reference, uint32_t width,
                           uint32_t height, const ColourSpace& space, const FlipKernels& kernels) {
  // The two pictures do not meet before both are filtered, so each has a thread.
  auto other = std::async(std::launch::async, [&] { return prepare(reference, width, height, space, kernels); });
  const Prepared a = prepare(test, width, height, space, kernels), b = other.get();

  const float largest = colourDistance(space.toHuntLab({0, 1, 0}), space.toHuntLab({0, 0, 1}));
  const float knee = kColourKnee * largest;
  std::vector<float> result(test.size());
  for (size_t i = 0; i < result.size(); ++i) {
    const float distance = colourDistance(a.lab[i], b.lab[i]);
    const float colour = distance < knee
                             ? kColourKneeValue / knee * distance
                             : kColourKneeValue + (distance - knee) / (largest - knee) * (1 - kColourKneeValue);
    const float feature = std::max(std::abs(a.features.edges.values[i] - b.features.edges.values[i]),
                                   std::abs(a.features.points.values[i] - b.features.points.values[i]));
    const float scaled = std::pow(std::clamp(feature / std::numbers::sqrt2_v<float>, 0.0f, 1.0f), kFeatureExponent);
    result[i] = std::clamp(std::pow(colour, 1.0f - scaled), 0.0f, 1.0f);
    if (colour == 0.0f) result[i] = 0.0f;  // pow(0, 0) is 1, and no colour difference is no difference
  }
  return result;
}

void require(const Picture& test, const Picture& reference, double pixelsPerDegree) {
  const bool whole =
      test.rgba.size() == 4 * size_t{test.width} * test.height && test.rgba.size() == reference.rgba.size();
  if (test.width != reference.width || test.height != reference.height || !whole || test.rgba.empty()) {
    throw InputError(fmt::format("FLIP needs two pictures of one size, not {}x{} and {}x{}", test.width, test.height,
                                 reference.width, reference.height));
  }
  if (!(pixelsPerDegree >= 1.0 && pixelsPerDegree <= 1000.0)) {
    throw InputError(fmt::format("{} pixels a degree is outside 1 to 1000", pixelsPerDegree));
  }
}

template <class Map>
std::vector<Rgb> mapped(const Picture& picture, const Map& map) {
  std::vector<Rgb> result(size_t{picture.width} * picture.height);
  for (size_t i = 0; i < result.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) result[i][c] = map(picture.rgba[4 * i + c]);
  }
  return result;
}

}  // namespace

double pixelsPerDegree(double distance, double screenWidth, double screenPixels) {
  return distance * screenPixels / screenWidth * std::numbers::pi / 180.0;
}

std::vector<float> ldrFlip(const Picture& test, const Picture& reference, double pixelsPerDegree) {
  require(test, reference, pixelsPerDegree);
  const auto linear = [](float v) { return decodeSrgb(std::clamp(v, 0.0f, 1.0f)); };
  return compare(mapped(test, linear), mapped(reference, linear), test.width, test.height, ColourSpace(),
                 makeFlipKernels(pixelsPerDegree));
}

FlipExposures flipExposures(const Picture& reference) {
  const ColourSpace space;
  std::vector<float> luminance;
  for (size_t i = 0; i < reference.rgba.size(); i += 4) {
    const float* p = &reference.rgba[i];
    luminance.push_back(multiply(space.toXyz, {std::max(p[0], 0.0f), std::max(p[1], 0.0f), std::max(p[2], 0.0f)})[1]);
  }
  if (luminance.empty()) return {};
  const float brightest = *std::max_element(luminance.begin(), luminance.end());
  if (!(brightest > 0.0f)) return {};
  const auto middle = luminance.begin() + static_cast<std::ptrdiff_t>((luminance.size() - 1) / 2);
  std::nth_element(luminance.begin(), middle, luminance.end());
  // Half of many pictures is black; a median of nothing would ask for infinite exposure.
  const float median = std::max(*middle, std::numeric_limits<float>::epsilon());
  const double shoulder = Aces::inverse(0.85);
  FlipExposures exposures;
  exposures.start = std::log2(shoulder / double(brightest));
  exposures.stop = std::max(std::log2(shoulder / double(median)), exposures.start);
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

std::vector<float> hdrFlip(const Picture& test, const Picture& reference, double pixelsPerDegree,
                           const std::stop_token& stop) {
  require(test, reference, pixelsPerDegree);
  const ColourSpace space;
  const FlipKernels kernels = makeFlipKernels(pixelsPerDegree);
  const FlipExposures exposures = flipExposures(reference);
  const double step = exposures.count > 1 ? (exposures.stop - exposures.start) / (exposures.count - 1) : 0.0;
  std::vector<float> largest(size_t{test.width} * test.height);
  const auto count = static_cast<size_t>(exposures.count), pixels = std::max<size_t>(1, largest.size());
  // Several exposures at a time, each of which takes about 160 bytes a pixel, in two gigabytes.
  const size_t atOnce = std::clamp<size_t>((size_t{2} << 30) / (160 * pixels), 1, 16);
  for (size_t first = 0; first < count; first += atOnce) {
    std::vector<std::vector<float>> maps(std::min(atOnce, count - first));
    parallelFor(maps.size(), [&](size_t k) {
      if (stop.stop_requested()) return;
      const double scale = std::exp2(exposures.start + step * static_cast<double>(first + k));
      const auto shown = [&](float v) { return Aces::map(float(std::min(scale * std::max(double(v), 0.0), 1e30))); };
      maps[k] = compare(mapped(test, shown), mapped(reference, shown), test.width, test.height, space, kernels);
    });
    if (stop.stop_requested()) return {};
    for (const std::vector<float>& map : maps)
      for (size_t p = 0; p < largest.size(); ++p) largest[p] = std::max(largest[p], map[p]);
  }
  return largest;
}

}  // namespace weir::image
