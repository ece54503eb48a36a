// Pictures of passes on one view's surfaces, frame by frame, and whether their means agree. Every frame is drawn with
// random numbers of its own, so that frames are independent estimates: the restarts of image/statistics.h.
#pragma once

#include <gtest/gtest.h>
#include <weir/image/statistics.h>

#include <cmath>
#include <map>
#include <optional>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"
#include "support/small_scenes.h"

namespace weir::test {

using Params = std::map<std::string, std::string>;
using Frames = std::vector<image::Picture>;

/// What a camera sees of a scene, at a moment of a clip where one moves it.
struct View {
  scene::Scene scene;
  scene::Camera camera;
  uint32_t side = 16;
  std::string clip = {};
  double at = 0.0;
  std::vector<passes::PackedSurface> surface = {};
  std::vector<glm::vec4> emission = {};

  void set(PassTest& t) const {
    t.size(side, side).scene(scene).camera(camera);
    if (!clip.empty()) t.clip(clip).at(at);
  }
  View& look() {
    PassTest eye("gbuffer.RayTraced");
    set(eye);
    eye.run();
    surface = eye.output<passes::PackedSurface>("surface");
    emission = eye.output<glm::vec4>("emission");
    return *this;
  }
};

/// Frames of a pass. Whatever isn't a finite, non-negative number fails.
inline Frames framesOf(const View& view, const std::string& type, const Params& params, uint32_t count,
                       std::optional<trace::Backend> backend = {}) {
  PassTest t(type);
  view.set(t);
  if (backend) t.backend(*backend);
  for (const auto& [name, value] : params) t.param(name, value);
  t.input("surface", view.surface).input("emission", view.emission).seed(11);
  Frames frames;
  size_t odd = 0;
  for (uint32_t f = 0; f < count; ++f) {
    t.run();
    image::Picture p;
    p.width = p.height = view.side;
    for (const glm::vec4& c : t.output<glm::vec4>("color")) {
      for (int k = 0; k < 3; ++k) odd += std::isfinite(c[k]) && c[k] >= 0.0f ? 0 : 1;
      p.rgba.insert(p.rgba.end(), {c.r, c.g, c.b, c.a});
    }
    frames.push_back(std::move(p));
  }
  EXPECT_EQ(odd, 0u) << type << ": colours that aren't finite or are negative";
  return frames;
}

inline Frames pathFrames(const View& view, const Params& params, uint32_t count,
                         std::optional<trace::Backend> backend = {}) {
  return framesOf(view, "reference.PathTracer", params, count, backend);
}

inline image::RestartAccumulator collect(const Frames& frames, uint32_t tileSide = 8) {
  image::RestartAccumulator sum(tileSide);
  for (const image::Picture& p : frames) sum.add(p);
  return sum;
}

/// Tiles of 8² pixels, three colours each, by Student's t with a Šidák bound over all of them: a false alarm of 1 in
/// 1000 a comparison of two pictures (and none at all in what has been run once: seeds are fixed). `detectable` bounds
/// what a tile's bias may be and go unnoticed, relative: a test that could not see it would be none.
inline void expectSameMean(const Frames& measured, const image::Picture& reference,
                           const image::Picture* referenceError, double detectable) {
  const image::TileTest test =
      image::tileTest(collect(measured).tiles(), reference, referenceError, {.alpha = 1e-3, .eachColour = true});
  EXPECT_TRUE(test.passed) << "|t| " << test.worstT << " in tile " << test.worst << ", bound " << test.bound
                           << "; mean " << test.tiles[test.worst].mean << ", reference "
                           << test.tiles[test.worst].reference << ", whole picture off by " << 100 * test.relativeBias
                           << " %";
  EXPECT_LT(test.detectable, detectable) << "too noisy to say anything";
}

inline void expectSameMean(const Frames& a, const Frames& b, double detectable) {
  const image::RestartAccumulator reference = collect(b);
  const image::Picture error = reference.standardError();
  expectSameMean(a, reference.mean(), &error, detectable);
}

/// Neither Fresnel's term nor any lobe: what reflects is Lambert's.
inline scene::Material lambert(const glm::vec3& color, const glm::vec3& emission = glm::vec3(0)) {
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = 0;
  m.specular = 0;
  m.emission = emission;
  return m;
}

inline scene::Material metal(const glm::vec3& color, float roughness) {
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = 1;
  m.roughness = roughness;
  return m;
}

/// A closed box around the origin, seen from within.
inline void addRoom(Builder& b, int material, float half = 1.0f) {
  const glm::vec3 l(-half), h(half);
  b.add(quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {l.x, l.y, l.z}, material));
  b.add(quad({l.x, h.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, material));
  b.add(quad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, material));
  b.add(quad({h.x, l.y, h.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {h.x, h.y, h.z}, material));
  b.add(quad({l.x, l.y, h.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {l.x, h.y, h.z}, material));
  b.add(quad({h.x, l.y, l.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, material));
}

inline glm::mat4 placed(const glm::vec3& at, float size) {
  glm::mat4 m(size);
  m[3] = glm::vec4(at, 1);
  return m;
}

}  // namespace weir::test
