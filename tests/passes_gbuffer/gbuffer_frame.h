// A G-buffer's outputs, unpacked, and compared with the oracle pixel by pixel.
#pragma once

#include <gtest/gtest.h>
#include <weir/scene/import.h>
#include <weir/scene/packing.h>

#include <cmath>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"
#include "support/ray_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {

struct GPixel {
  double distance = 0.0, roughness = 0.0, f90 = 1.0;
  glm::dvec3 geometricNormal{0.0}, normal{0.0}, diffuseRoot{0.0}, f0Root{0.0};  ///< roots: packing is even in them
  glm::uvec2 jitter{0};
  glm::dvec4 emission{0.0};
  glm::dvec2 motion{0.0};
};

struct GFrame {
  uint32_t width, height;
  std::vector<GPixel> pixels;
  const GPixel& at(uint32_t x, uint32_t y) const { return pixels[size_t{y} * width + x]; }
};

inline glm::dvec3 albedoRoot(uint32_t bits) {
  return {(bits & 2047u) / 2047.0, ((bits >> 11) & 2047u) / 2047.0, (bits >> 22) / 1023.0};
}

inline GFrame readFrame(PassTest& t, uint32_t width, uint32_t height) {
  const bool f90 = t.prepared().traits.f90;
  const auto surfaces = t.output<passes::PackedSurface>("surface");
  const auto emission = t.output<glm::vec4>("emission");
  const auto motion = t.output<glm::vec2>("motion");
  GFrame frame{width, height, {}};
  for (size_t i = 0; i < surfaces.size(); ++i) {
    const passes::PackedSurface& s = surfaces[i];
    GPixel p;
    p.distance = s.distance;
    p.geometricNormal = scene::unpackNormal(s.geometricNormal);
    p.normal = scene::unpackNormal(s.shadingNormal);
    p.diffuseRoot = albedoRoot(s.diffuse);
    p.f0Root = albedoRoot(s.specular);
    p.roughness = f90 ? (s.roughnessJitter >> 22) / 1023.0 : (s.roughnessJitter >> 16) / 65535.0;
    if (f90) p.f90 = (s.roughnessJitter >> 16 & 63u) / 63.0;
    p.jitter = {s.roughnessJitter & 255u, (s.roughnessJitter >> 8) & 255u};
    p.emission = emission[i];
    p.motion = motion[i];
    frame.pixels.push_back(p);
  }
  return frame;
}

inline glm::dvec2 jitterPlace(glm::uvec2 jitter) {
  return (glm::dvec2(jitter) + 0.5) / 255.0;
}

// What a device's sRGB decoding may be off by: in the root of a channel, and relative to it. Measured over all 256
// codes by Surface.SrgbDecoding, which holds the device to it. Mesa's software device decodes by a polynomial, codes
// below 15 by a line of slope 1/12.6 instead of 1/12.92.
constexpr double kSrgbRoot = 1.2e-3, kSrgbRelative = 0.0254;

struct Tolerance {
  double distance = 2e-5;  ///< relative
  double normal = 2e-4;    ///< radians; 1e-4 are packing's
  double root = 0.0;       ///< of albedo, beyond a step
  double roughness = 0.0;
  double emission = 1e-6;                         ///< relative, of each channel
  double emissionBlend = 1e-6;                    ///< nit, what a sampler's blending may add to that
  double roughnessStep = 1.0 / 65535, f90 = 0.0;  ///< with the trait f90: 1/1023 and 1/63
};

/// Empty when the pixel shows this hit; else what differs.
inline std::string difference(const GPixel& p, const RayOracle& oracle, const OracleHit& hit,
                              const glm::dvec3& direction, const Tolerance& tolerance) {
  if (!hit) return p.distance == 0.0 && p.emission == glm::dvec4(0.0) ? "" : "a surface where there is none";
  if (!(std::abs(p.distance - hit.distance) <= tolerance.distance * hit.distance)) {
    return "distance " + std::to_string(p.distance) + " instead of " + std::to_string(hit.distance);
  }
  const OracleSurface s = oracle.surface(hit, direction);
  if (glm::length(p.geometricNormal - s.geometricNormal) > tolerance.normal) return "geometric normal";
  if (glm::length(p.normal - s.normal) > tolerance.normal) return "shading normal";
  // Rounded up or down at random: within a step. What it does to the mean: tests/packing.
  const glm::dvec3 step(1.0 / 2047, 1.0 / 2047, 1.0 / 1023);
  const glm::dvec3 allowed = step + tolerance.root + 1e-6;
  if (!glm::all(glm::lessThanEqual(glm::abs(p.diffuseRoot - glm::sqrt(s.diffuse)), allowed))) return "diffuse";
  if (!glm::all(glm::lessThanEqual(glm::abs(p.f0Root - glm::sqrt(s.f0)), allowed))) return "f0";
  if (!(std::abs(p.roughness - s.roughness) <= tolerance.roughnessStep + 1e-6 + tolerance.roughness)) {
    return "roughness " + std::to_string(p.roughness) + " instead of " + std::to_string(s.roughness);
  }
  if (!(std::abs(p.f90 - s.f90) <= tolerance.f90 + 1e-6)) return "f90";
  const glm::dvec3 off = glm::abs(glm::dvec3(p.emission) - s.emission);
  if (!glm::all(glm::lessThanEqual(off, tolerance.emission * s.emission + tolerance.emissionBlend))) return "emission";
  if (p.emission.a != 1.0) return "emission's alpha";
  return "";
}

/// Every pixel shows what its ray meets. Where it doesn't, it must show what a ray a thousandth of a pixel beside it
/// meets (an edge runs through the pixel's centre), and such pixels must be few.
inline void expectOracle(const GFrame& frame, const RayOracle& oracle, const scene::Camera& camera,
                         const Tolerance& tolerance = {}, double edges = 0.01) {
  // Misses keep no place in their pixel; it is the same for all pixels of a frame.
  glm::uvec2 jitter(127);
  for (const GPixel& p : frame.pixels) {
    if (p.distance > 0) jitter = p.jitter;
  }
  size_t onEdge = 0, wrong = 0;
  for (uint32_t y = 0; y < frame.height; ++y) {
    for (uint32_t x = 0; x < frame.width; ++x) {
      const GPixel& p = frame.at(x, y);
      const auto shows = [&](glm::dvec2 shift, const Tolerance& allowed) {
        const glm::dvec2 point = glm::dvec2(x, y) + jitterPlace(jitter) + shift;
        const glm::dvec3 d = oracleDirection(camera, point, frame.width, frame.height);
        return difference(p, oracle, oracle.closest(camera.eye, d, true), d, allowed);
      };
      const std::string said = shows({0, 0}, tolerance);
      if (said.empty()) continue;
      ++onEdge;
      bool beside = false;
      Tolerance loose = tolerance;  // distances change along the shift
      loose.distance = 1e-3;
      for (const glm::dvec2 shift : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        beside |= shows(shift * 1e-3, loose).empty();
      }
      if (!beside && ++wrong <= 5) ADD_FAILURE() << "pixel " << x << ", " << y << ": " << said;
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_LE(static_cast<double>(onEdge), edges * static_cast<double>(frame.pixels.size()) + 1) << "pixels on edges";
}

inline scene::Scene own(const std::string& name) {
  return scene::importGltf(sourcePath("scenes/" + name));
}

}  // namespace weir::test
