// What the bugs are looked for in. Each is small, lit so that its noise is low, and has what the bugs beside it need to
// show: depth steps and occluders for reuse between pixels, motion for reuse between frames, gloss and a sky for the
// mixtures of candidates.
#include <cmath>

#include "laboratory.h"
#include "support/device.h"
#include "support/environment_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

scene::Material coloured(const glm::vec3& color, float metallic = 0.0f, float roughness = 1.0f) {
  scene::Material m;
  m.baseColor = glm::vec4(color, 1.0f);
  m.metallic = metallic;
  m.roughness = roughness;
  return m;
}

scene::Material lamp(const glm::vec3& emission, bool doubleSided = false) {
  scene::Material m = coloured(glm::vec3(0.0f));
  m.emission = emission;
  m.doubleSided = doubleSided;
  return m;
}

render::Stage staged(scene::Scene scene, const scene::Camera& camera) {
  render::Stage s;
  s.scene = std::move(scene);
  s.prepared = scene::prepareScene(s.scene);
  s.camera = camera;
  return s;
}

void addBlock(Builder& b, const glm::vec3& low, const glm::vec3& high, int material) {
  const glm::vec3 l = low, h = high;
  b.add(quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, material));
  b.add(quad({h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z}, material));
  b.add(quad({h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, material));
  b.add(quad({l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}, material));
  b.add(quad({l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, material));
}

/// A corner of a room with a thin fin and a block before it: depth steps, right angles, shadows that end on flat
/// ground, a wall that shines. A wide lamp above, a small one low beside the block, a point light.
Builder room() {
  Builder b;
  const int grey = b.material(coloured({0.6f, 0.6f, 0.6f})), red = b.material(coloured({0.7f, 0.15f, 0.1f}));
  const int shiny = b.material(coloured({0.8f, 0.7f, 0.5f}, 1.0f, 0.4f));
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, grey));
  b.add(quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}, shiny));
  b.add(quad({-2, 0, 2}, {-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2}, red));
  addBlock(b, {0.2f, 0.0f, -1.2f}, {1.1f, 0.9f, -0.4f}, grey);
  addBlock(b, {-0.75f, 0.0f, -0.2f}, {-0.7f, 1.6f, 0.6f}, red);
  b.add(quad({-1.2f, 2.8f, -1.2f}, {-0.2f, 2.8f, -1.2f}, {-0.2f, 2.8f, -0.4f}, {-1.2f, 2.8f, -0.4f},
             b.material(lamp({9, 8, 6}))));
  b.add(quad({1.6f, 0.3f, -0.9f}, {1.6f, 0.3f, -0.6f}, {1.6f, 0.6f, -0.6f}, {1.6f, 0.6f, -0.9f},
             b.material(lamp({6, 10, 22}, true))));
  scene::PunctualLight point;
  point.intensity = {2.0f, 1.6f, 1.2f};
  point.position = {1.2f, 2.2f, 1.2f};
  b.scene.lights.push_back(point);
  return b;
}

const scene::Camera kIntoRoom = lookAt({0.6f, 1.5f, 3.2f}, {-0.1f, 0.75f, -0.6f}, 48);

render::Stage roomStage() {
  return staged(room().scene, kIntoRoom);
}

/// The same with floor and walls of half-smooth plastic and metal.
render::Stage shinyRoomStage() {
  Builder b = room();
  for (scene::Material& m : b.scene.materials)
    if (m.baseColor.r > 0.0f) m.roughness = 0.45f;
  b.scene.materials[0].metallic = 0.6f;
  return staged(b.scene, kIntoRoom);
}

/// The camera goes sideways, a pixel or more a frame.
scene::Camera sideways(uint32_t frame) {
  scene::Camera c = kIntoRoom;
  c.eye.x += 0.12f * static_cast<float>(frame);
  return c;
}

/// Rough and smooth metal under a quad lamp close by, for candidates along the lobe.
render::Stage glossStage() {
  Builder b;
  const int mirror = b.material(coloured({0.9f, 0.85f, 0.8f}, 1.0f, 0.2f));
  const int plastic = b.material(coloured({0.3f, 0.5f, 0.7f}, 0.0f, 0.3f));
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, plastic));
  b.add(quad({-2, 0, -1}, {2, 0, -1}, {2, 2.5f, -1}, {-2, 2.5f, -1}, mirror));
  b.add(quad({-0.6f, 1.4f, 0.2f}, {0.2f, 1.4f, 0.2f}, {0.2f, 1.1f, 0.9f}, {-0.6f, 1.1f, 0.9f},
             b.material(lamp({5, 5, 4}, true))));
  b.add(sphere(12, 18, plastic), glm::mat4(glm::vec4(0.4f, 0, 0, 0), glm::vec4(0, 0.4f, 0, 0), glm::vec4(0, 0, 0.4f, 0),
                                           glm::vec4(0.8f, 0.4f, -0.2f, 1)));
  return staged(b.scene, lookAt({0.2f, 1.3f, 3.4f}, {0, 0.8f, -0.4f}, 45));
}

/// Rough metal all around, under one lamp.
render::Stage roughStage() {
  Builder b;
  const int metal = b.material(coloured({0.9f, 0.8f, 0.7f}, 1.0f, 0.9f));
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, metal));
  b.add(quad({-2, 0, -1}, {2, 0, -1}, {2, 2.5f, -1}, {-2, 2.5f, -1}, metal));
  b.add(quad({-0.6f, 1.9f, 0.2f}, {0.2f, 1.9f, 0.2f}, {0.2f, 1.7f, 0.9f}, {-0.6f, 1.7f, 0.9f},
             b.material(lamp({5, 5, 4}, true))));
  return staged(b.scene, lookAt({0.2f, 1.3f, 3.4f}, {0, 0.8f, -0.4f}, 45));
}

/// A sky with a bright patch over a floor with a wall, some of it glossy.
render::Stage skyStage() {
  Builder b;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(coloured({0.5f, 0.5f, 0.5f}))));
  b.add(quad({-2, 0, -1}, {0.5f, 0, -1}, {0.5f, 1.5f, -1}, {-2, 1.5f, -1},
             b.material(coloured({0.8f, 0.6f, 0.3f}, 1.0f, 0.35f))));
  addBlock(b, {0.4f, 0.0f, -0.5f}, {0.9f, 0.8f, 0.2f}, b.material(coloured({0.2f, 0.6f, 0.3f})));
  b.scene.environment = environmentOf(
      16, 8,
      [](uint32_t x, uint32_t y) {
        if (x == 10 && y == 2) return glm::vec3(18, 16, 12);
        return y < 4 ? glm::vec3(0.5f, 0.7f, 1.0f) : glm::vec3(0.2f, 0.15f, 0.1f);
      },
      1.0f, 0.3f);
  return staged(b.scene, lookAt({0.5f, 1.4f, 3.2f}, {0, 0.5f, -0.3f}, 45));
}

/// The same with a lamp, so that the sky is not all that is picked.
render::Stage lampUnderSkyStage() {
  render::Stage s = skyStage();
  Builder b;
  b.scene = s.scene;
  b.add(quad({-1.2f, 1.8f, 0.6f}, {-0.6f, 1.8f, 0.6f}, {-0.6f, 1.6f, 1.0f}, {-1.2f, 1.6f, 1.0f},
             b.material(lamp({4, 4, 4}, true))));
  return staged(b.scene, s.camera);
}

/// Light through a pane that lets half of it through, and past one with holes.
render::Stage paneStage() {
  Builder b = room();
  scene::Material pane = coloured({0.9f, 0.9f, 0.9f});
  pane.alphaMode = scene::AlphaMode::Blend;
  pane.baseColor.a = 0.5f;
  pane.doubleSided = true;
  b.add(quad({-1.8f, 1.9f, 0.2f}, {0.4f, 1.9f, 0.2f}, {0.4f, 1.9f, -1.6f}, {-1.8f, 1.9f, -1.6f}, b.material(pane)));
  scene::Material leaf = coloured({0.3f, 0.6f, 0.2f});
  leaf.alphaMode = scene::AlphaMode::Mask;
  leaf.doubleSided = true;
  leaf.baseColorTexture.texture = b.texture(
      8, 8, [](uint32_t x, uint32_t y) { return glm::u8vec4(255, 255, 255, (x + y) % 2 == 0 ? 255 : 0); },
      scene::Filter::Nearest);
  b.add(quad({0.6f, 1.5f, 1.0f}, {1.6f, 1.5f, 1.0f}, {1.6f, 1.5f, 0.2f}, {0.6f, 1.5f, 0.2f}, b.material(leaf)));
  return staged(b.scene, kIntoRoom);
}

/// A spot and a windowed point light over the room's geometry, and many small ones of unlike power.
render::Stage pointsStage() {
  Builder b = room();
  for (scene::Material& m : b.scene.materials) m.emission = glm::vec3(0.0f);
  b.scene.lights.clear();
  scene::PunctualLight spot;
  spot.kind = scene::LightKind::Spot;
  spot.intensity = {14, 12, 10};
  spot.position = {1.5f, 2.8f, 1.5f};
  spot.direction = glm::normalize(glm::vec3(-1.2f, -2.0f, -1.5f));
  spot.innerCone = 0.15f;
  spot.outerCone = 0.55f;
  b.scene.lights.push_back(spot);
  for (uint32_t i = 0; i < 40; ++i) {
    scene::PunctualLight p;
    const auto u = [&](uint32_t d) { return static_cast<float>(uniformOf(977 * i + d)); };
    p.position = {3.4f * u(1) - 1.7f, 0.6f + 2.0f * u(2), 3.0f * u(3) - 1.5f};
    p.intensity = glm::vec3(u(4), u(5), u(6)) * (i % 8 == 0 ? 1.2f : 0.08f);
    if (i % 3 == 0) p.range = 2.5f;
    b.scene.lights.push_back(p);
  }
  return staged(b.scene, kIntoRoom);
}

/// A terrace with its front, small lights over the one and before the other, a lamp, and a sun, which has no place. The
/// camera sees the edge in a row of tiles: their first rows show the terrace, which the lights below don't reach. It
/// looks along the terrace, where many lights lie beyond what it sees.
render::Stage terraceStage() {
  Builder b;
  const int grey = b.material(coloured({0.6f, 0.6f, 0.6f}));
  b.add(quad({-2, 0, 0}, {2, 0, 0}, {2, 0, -4}, {-2, 0, -4}, grey));
  b.add(quad({-2, -2, 0}, {2, -2, 0}, {2, 0, 0}, {-2, 0, 0}, grey));
  b.add(quad({-0.9f, 1.3f, -0.8f}, {-0.9f, 1.3f, -1.2f}, {-0.5f, 1.3f, -1.2f}, {-0.5f, 1.3f, -0.8f},
             b.material(lamp({2, 2, 1.5f}, true))));
  for (uint32_t i = 0; i < 60; ++i) {
    scene::PunctualLight p;
    const auto u = [&](uint32_t d) { return static_cast<float>(uniformOf(977 * i + d)); };
    p.position = i % 2 == 0 ? glm::vec3(3 * u(1) - 1.5f, 0.3f + u(2), -3 * u(3))
                            : glm::vec3(3 * u(1) - 1.5f, -0.2f - u(2), 0.3f + u(3));
    p.intensity = glm::vec3(u(4), u(5), u(6)) * (i % 8 == 0 ? 0.3f : 0.05f);
    if (i % 3 == 0) p.range = 3.0f;
    b.scene.lights.push_back(p);
  }
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.direction = glm::normalize(glm::vec3(-0.5f, -1.0f, -0.7f));
  sun.intensity = {0.25f, 0.25f, 0.2f};
  b.scene.lights.push_back(sun);
  return staged(b.scene, lookAt({0, 0.6f, 3}, {0, -0.0425f, 0}, 10));
}

render::Stage movingStage() {
  render::StageOptions options;
  options.scene = sourcePath("scenes/cornell-moving.glb");
  options.animate = true;
  options.clip = "everything";
  options.time = 0.3;
  options.timeStep = 0.08;
  return render::makeStage(options, 1.0f);
}

std::vector<std::string> reuse(const std::string& mis, bool rays, std::vector<std::string> more = {}) {
  const std::string on = rays ? "true" : "false";
  std::vector<std::string> set = {"temporal.mis=" + mis,           "spatial.mis=" + mis,
                                  "temporal.visibilityRays=" + on, "spatial.visibilityRays=" + on,
                                  "temporal.confidenceCap=4",      "initial.candidates=8"};
  if (!rays) set.emplace_back("initial.visibility=false");
  set.insert(set.end(), more.begin(), more.end());
  return set;
}

constexpr const char* kGraph = "graphs/restir_di.json";

/// Reuse in space and time over the room, with neighbours of every kind.
Situation roomSituation(const std::string& name, const std::string& about, std::vector<std::string> set) {
  set.insert(set.end(), {"spatial.radius=8", "spatial.normalThreshold=180", "spatial.depthThreshold=10"});
  return {name, about, roomStage, kGraph, std::move(set)};
}

Situation initialSituation(const std::string& name, const std::string& about, render::Stage (*stage)(),
                           std::vector<std::string> set) {
  return {name, about, stage, kGraph, std::move(set), {"temporal", "spatial"}};
}

/// A lamp that moves, a blocker that turns, a skin, a morph.
Situation movingSituation(const std::string& name, const std::string& mis) {
  // Pixels by themselves: shared picks make the means of so small tiles vary more, and one of the bugs here is faint.
  return {name,
          "lamp, blocker and skin move; " + mis,
          movingStage,
          kGraph,
          reuse(mis, true, {"temporal.confidenceCap=20", "initial.tiles=off"}),
          {"spatial"}};
}

/// The path tracer against itself without the bug: what is right there is shown elsewhere, by closed forms and by
/// another renderer.
Situation pathSituation(const std::string& name, const std::string& about, render::Stage (*stage)()) {
  const std::vector<std::string> set = {"path.maxBounces=4", "path.rouletteStart=1", "path.samples=4"};
  Situation s{name, about, stage, "graphs/reference.json", set};
  s.frames = 1;
  s.reference = s.graph;
  s.referenceSet = set;
  s.referenceRestarts = 256;
  return s;
}

std::vector<Situation> makeSituations() {
  std::vector<Situation> s;
  s.push_back(roomSituation("room-pairwise", "reuse in space and time with rays, pairwise", reuse("pairwise", true)));
  s.push_back(roomSituation("room-balance", "the same, balance heuristic", reuse("balance", true)));
  s.push_back(roomSituation("room-z", "the same, 1/Z, two iterations",
                            reuse("z", true, {"spatial.iterations=2", "spatial.neighbours=2"})));
  s.push_back(roomSituation("room-z-untested", "1/Z, fresh samples without a shadow ray",
                            reuse("z", true, {"initial.visibility=false"})));
  s.push_back(roomSituation("room-unshadowed", "reuse that looks away from shadows, balance heuristic",
                            reuse("balance", false)));
  s.push_back(roomSituation("room-temporal", "reuse in time alone, pairwise", reuse("pairwise", true)));
  s.back().disable = {"spatial"};
  s.back().frames = 6;
  s.push_back(roomSituation("room-gloss", "much of the room shines, balance heuristic", reuse("balance", true)));
  s.back().stage = shinyRoomStage;
  s.push_back(roomSituation("shiny-pairwise", "the same, pairwise", reuse("pairwise", true)));
  s.back().stage = shinyRoomStage;
  s.push_back(roomSituation("sliding", "a camera that moves sideways", reuse("pairwise", true)));
  s.back().camera = sideways;
  s.push_back(movingSituation("moving", "pairwise"));
  s.push_back(movingSituation("moving-z", "z"));
  s.push_back(initialSituation("room-initial", "candidates alone", roomStage, {"initial.candidates=16"}));
  s.push_back(initialSituation("room-area", "candidates alone, points on triangles by area", roomStage,
                               {"initial.candidates=16", "initial.triangles=area"}));
  s.push_back(initialSituation("room-many", "many candidates", roomStage, {"initial.candidates=96"}));
  s.push_back(initialSituation("rays", "rays along the BSDF among the candidates", glossStage,
                               {"initial.candidates=8", "initial.bsdfRays=2"}));
  s.push_back(initialSituation("rough", "candidates on rough metal", roughStage, {"initial.candidates=16"}));
  s.push_back(
      initialSituation("gloss", "candidates on glossy surfaces near a lamp", glossStage, {"initial.candidates=16"}));
  s.push_back(initialSituation("sky", "candidates from all around", skyStage,
                               {"initial.candidates=8", "initial.bsdfCandidates=4"}));
  s.push_back(roomSituation("pane", "shadows of what lets light through", reuse("pairwise", true)));
  s.back().stage = paneStage;
  s.push_back(initialSituation("points", "spot, window, unlike powers", pointsStage,
                               {"initial.candidates=16", "initial.uniformShare=0.3"}));
  s.push_back(initialSituation("tiles", "the same lights from tiles", pointsStage,
                               {"initial.candidates=6", "initial.tiles=on", "initial.uniformShare=0.3"}));
  s.push_back(initialSituation("place", "many lights from tiles, by place", terraceStage,
                               {"initial.candidates=6", "initial.tiles=on", "initial.picks=place"}));
  s.push_back(pathSituation("paths", "four bounces through the room", roomStage));
  s.push_back(pathSituation("sky-paths", "four bounces under a sky with a lamp", lampUnderSkyStage));
  return s;
}

}  // namespace

const std::vector<Situation>& situations() {
  static const std::vector<Situation> all = makeSituations();
  return all;
}

}  // namespace weir::test
