// An environment in double precision, written from scene/environment.h's text: directions, interpolation, places.
#pragma once

#include <weir/scene/environment.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/packing.hpp>
#include <numbers>
#include <vector>

namespace weir::test {

/// An environment by a function of its texels.
inline scene::Environment environmentOf(uint32_t width, uint32_t height,
                                        const std::function<glm::vec3(uint32_t, uint32_t)>& texel, float scale = 1.0f,
                                        float rotation = 0.0f) {
  image::Picture picture;
  picture.width = width;
  picture.height = height;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const glm::vec3 t = texel(x, y);
      picture.rgba.insert(picture.rgba.end(), {t.r, t.g, t.b, 1.0f});
    }
  }
  return scene::makeEnvironment(picture, scale, rotation);
}

class EnvironmentOracle {
 public:
  explicit EnvironmentOracle(const scene::Environment& environment) : e_(environment) {}

  glm::dvec3 direction(double u, double v) const {
    const double longitude = 2 * kPi * (u - 0.5) - e_.rotation, theta = kPi * v;
    return {std::sin(theta) * std::sin(longitude), std::cos(theta), -std::sin(theta) * std::cos(longitude)};
  }
  glm::dvec2 uv(const glm::dvec3& d) const {
    const double u = 0.5 + (std::atan2(d.x, -d.z) + e_.rotation) / (2 * kPi);
    return {u - std::floor(u), std::acos(std::clamp(d.y, -1.0, 1.0)) / kPi};
  }
  glm::dvec3 texel(int64_t x, int64_t y) const {
    x = (x % e_.width + e_.width) % e_.width;
    y = std::clamp<int64_t>(y, 0, e_.height - 1);
    const uint16_t* t = e_.texels.data() + 4 * (y * e_.width + x);
    return glm::dvec3(glm::unpackHalf1x16(t[0]), glm::unpackHalf1x16(t[1]), glm::unpackHalf1x16(t[2])) *
           static_cast<double>(e_.unit);
  }
  glm::dvec3 at(double u, double v) const {
    const double x = u * e_.width - 0.5, y = v * e_.height - 0.5;
    const auto x0 = static_cast<int64_t>(std::floor(x)), y0 = static_cast<int64_t>(std::floor(y));
    const double fx = x - double(x0), fy = y - double(y0);
    return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), fx),
                    glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), fx), fy);
  }
  glm::dvec3 radiance(const glm::dvec3& d) const {
    const glm::dvec2 p = uv(d);
    return at(p.x, p.y);
  }

  /// Where a place lies: its cell and its texture coordinates, uniform in the cosine within the cell.
  struct Place {
    uint32_t cell = 0;
    glm::dvec2 uv{0.0};
  };
  Place place(const scene::EnvironmentTable& t, uint32_t bits) const {
    const uint32_t code[2] = {bits & 0xffffu, bits >> 16}, steps[2] = {65536 / t.columns, 65536 / t.rows};
    const uint32_t column = code[0] / steps[0], row = code[1] / steps[1];
    const double px = (code[0] % steps[0] + 0.5) / steps[0], py = (code[1] % steps[1] + 0.5) / steps[1];
    const auto edge = [&](uint32_t i, uint32_t size) { return std::min(double(i) * t.block, double(size)) / size; };
    Place p;
    p.cell = row * t.columns + column;
    p.uv.x = glm::mix(edge(column, e_.width), edge(column + 1, e_.width), px);
    const double high = std::cos(kPi * edge(row, e_.height)), low = std::cos(kPi * edge(row + 1, e_.height));
    p.uv.y = std::acos(glm::mix(high, low, py)) / kPi;
    return p;
  }

  /// Midpoints of n² cells of every texel, with radiance times steradian: lights that make up the environment.
  struct Small {
    glm::dvec3 direction, lux;
  };
  std::vector<Small> divided(int n) const {
    std::vector<Small> all;
    const uint32_t rows = e_.height * n, columns = e_.width * n;
    for (uint32_t y = 0; y < rows; ++y) {
      const double solidAngle = 2 * kPi / columns * (std::cos(kPi * y / rows) - std::cos(kPi * (y + 1) / rows));
      for (uint32_t x = 0; x < columns; ++x) {
        const double u = (x + 0.5) / columns, v = (y + 0.5) / rows;
        const glm::dvec3 light = at(u, v);
        if (light != glm::dvec3(0)) all.push_back({direction(u, v), light * solidAngle});
      }
    }
    return all;
  }

 private:
  static constexpr double kPi = std::numbers::pi;
  const scene::Environment& e_;
};

}  // namespace weir::test
