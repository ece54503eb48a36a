#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/hdr.h>
#include <weir/scene/environment.h>
#include <weir/scene/lights.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <utility>

namespace weir::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

float usable(float value) {
  return std::isfinite(value) && value > 0.0f ? value : 0.0f;
}

/// Mean of three neighbours under linear interpolation over the middle one's texel: ∫ of the two tents.
double across(double before, double here, double after) {
  return (before + 6.0 * here + after) / 8.0;
}

/// Luminance of one row, in units of the texels, averaged over each texel's width.
std::vector<double> rowMeans(const Environment& e, uint32_t y) {
  std::vector<double> luminances(e.width), means(e.width);
  const uint16_t* row = e.texels.data() + size_t{4} * e.width * y;
  for (uint32_t x = 0; x < e.width; ++x) {
    const glm::vec3 c(glm::unpackHalf1x16(row[4 * x]), glm::unpackHalf1x16(row[4 * x + 1]),
                      glm::unpackHalf1x16(row[4 * x + 2]));
    luminances[x] = luminance(c);
  }
  for (uint32_t x = 0; x < e.width; ++x) {
    means[x] = across(luminances[x == 0 ? e.width - 1 : x - 1], luminances[x], luminances[(x + 1) % e.width]);
  }
  return means;
}

/// What of a texel of row y three rows' values are worth, steradian: ∫ of their tents times the sine over its
/// latitudes.
struct RowShares {
  double before = 0.0, here = 0.0, after = 0.0, solidAngle = 0.0;
};
RowShares rowShares(const Environment& e, uint32_t y) {
  const double step = kPi / e.height, width = 2.0 * kPi / e.width;
  RowShares s;
  // cos a - cos b by the product formula, which keeps its precision near the poles.
  s.solidAngle = 2.0 * width * std::sin(step * 0.5) * std::sin(step * (y + 0.5));
  // The neighbours' tents reach half a texel in; Gauss's three points there are exact to the ninth digit and beyond.
  const double root = std::sqrt(0.6);
  for (const auto& [place, weight] : {std::pair{-root, 5.0 / 18.0}, {0.0, 8.0 / 18.0}, {root, 5.0 / 18.0}}) {
    const double in = 0.25 * (1.0 + place), factor = weight * 0.5 * (0.5 - in) * step * width;
    s.before += factor * std::sin(step * (y + in));
    s.after += factor * std::sin(step * (y + 1.0 - in));
  }
  s.here = s.solidAngle - s.before - s.after;
  return s;
}

}  // namespace

Environment makeEnvironment(const image::Picture& picture, float scale, float rotation) {
  Environment e;
  e.width = picture.width;
  e.height = picture.height;
  e.rotation = rotation;
  float largest = 0.0f;
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    bool good = true;
    for (size_t c = 0; c < 3; ++c) {
      const float value = picture.rgba[i + c];
      good = good && std::isfinite(value) && value >= 0.0f;
      largest = std::max(largest, usable(value));
    }
    e.mended += good ? 0 : 1;
  }
  if (!(largest > 0.0f) || !(scale > 0.0f)) return e;
  const double top = static_cast<double>(largest) * scale;
  if (top > static_cast<double>(std::numeric_limits<float>::max())) {
    throw InputError(fmt::format("environment: its brightest texel, {} times {}, is beyond a float", largest, scale));
  }
  int exponent = 0;
  std::frexp(top, &exponent);
  e.unit = std::ldexp(1.0f, exponent - 15);
  if (!(e.unit > 0.0f)) return e;  // below the smallest float: black
  const double multiplier = std::ldexp(static_cast<double>(scale), 15 - exponent);
  e.texels.resize(picture.rgba.size());
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) {
      e.texels[i + c] = glm::packHalf1x16(static_cast<float>(usable(picture.rgba[i + c]) * multiplier));
    }
    e.texels[i + 3] = 0;
  }
  return e;
}

Environment readEnvironment(const std::string& path, float scale, float degrees) {
  if (!(scale >= 0.0f) || !std::isfinite(scale)) {
    throw InputError(fmt::format("--environment-scale {}: must be a finite number, 0 or more", scale));
  }
  if (!std::isfinite(degrees)) throw InputError("--environment-rotation: must be a finite number of degrees");
  if (image::fileKind(path) == image::FileKind::Png) {
    throw InputError(
        fmt::format("--environment {}: a PNG holds display values; expected radiance, .exr or .hdr", path));
  }
  Environment e = makeEnvironment(image::readPicture(path), scale,
                                  static_cast<float>(std::remainder(degrees, 360.0) * kPi / 180.0));
  e.path = path;
  return e;
}

EnvironmentTable tabulate(const Environment& e, uint64_t mostCells) {
  EnvironmentTable t;
  if (!e.shines()) return t;
  const auto blocks = [&](uint32_t size) { return (size + t.block - 1) / t.block; };
  while (uint64_t{blocks(e.width)} * blocks(e.height) > mostCells || blocks(std::max(e.width, e.height)) > 65536) {
    t.block *= 2;
  }
  t.columns = blocks(e.width);
  t.rows = blocks(e.height);

  std::vector<double> weights(size_t{t.columns} * t.rows, 0.0), solidAngles(weights.size(), 0.0);
  std::vector<double> before = rowMeans(e, 0), here = before, after;
  for (uint32_t y = 0; y < e.height; ++y) {
    after = y + 1 < e.height ? rowMeans(e, y + 1) : here;
    const RowShares share = rowShares(e, y);
    const size_t row = size_t{y / t.block} * t.columns;
    for (uint32_t x = 0; x < e.width; ++x) {
      weights[row + x / t.block] += before[x] * share.before + here[x] * share.here + after[x] * share.after;
      solidAngles[row + x / t.block] += share.solidAngle;
    }
    before = std::move(here);
    here = std::move(after);
  }
  for (double weight : weights) t.integral += weight * e.unit;

  const std::vector<AliasCell> alias = buildAliasTable(weights);
  const std::vector<double> probabilities = aliasProbabilities(alias);
  t.cells.resize(alias.size());
  for (size_t i = 0; i < alias.size(); ++i) {
    const double spread = probabilities[i] > 0.0 ? solidAngles[i] / probabilities[i] : 0.0;
    t.cells[i] = {alias[i].threshold, alias[i].alias, static_cast<float>(spread)};
  }
  return t;
}

}  // namespace weir::scene
