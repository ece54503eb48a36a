// Every mixture of ways to a light candidate has the same mean: lamps of all kinds, the sky, and what hides them.
#include <gtest/gtest.h>

#include "laboratory.h"
#include "setup.h"
#include "support/environment_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

/// A floor, half of it glossy, under lamps: textured, with holes, veiled by its own alpha, double-sided, turned by a
/// mirroring transform, close to the floor; and a pane that blends.
scene::Scene lamps(bool sky) {
  Builder b;
  const int chequers = b.texture(
      4, 4,
      [](uint32_t x, uint32_t y) {
        return (x + y) % 2 == 0 ? glm::u8vec4(255, 200, 120, 255) : glm::u8vec4(40, 60, 255, 0);
      },
      scene::Filter::Nearest);
  const auto lamp = [&](const glm::vec3& emission) {
    scene::Material m;
    m.emission = emission;
    m.baseColor = {0.2f, 0.2f, 0.2f, 1.0f};
    return m;
  };
  scene::Material rough, glossy, textured = lamp({6, 6, 6}), holes = lamp({8, 7, 5}), ghost = lamp({9, 4, 4}),
                                 both = lamp({2, 5, 3}), near = lamp({3, 3, 4}), pane;
  rough.metallic = 0.0f;
  glossy.baseColor = {0.9f, 0.8f, 0.7f, 1.0f};
  glossy.roughness = 0.3f;
  textured.emissiveTexture.texture = chequers;
  holes.baseColorTexture.texture = chequers;
  holes.alphaMode = scene::AlphaMode::Mask;
  ghost.alphaMode = scene::AlphaMode::Blend;
  ghost.baseColor.a = 0.4f;
  both.doubleSided = true;
  pane.baseColor = {1, 1, 1, 0.5f};
  pane.alphaMode = scene::AlphaMode::Blend;
  pane.doubleSided = true;
  pane.metallic = 0.0f;
  const int roughOne = b.material(rough), glossyOne = b.material(glossy);
  b.add(quad({-2, 0, 2}, {0, 0, 2}, {0, 0, -2}, {-2, 0, -2}, roughOne));
  b.add(quad({0, 0, 2}, {2, 0, 2}, {2, 0, -2}, {0, 0, -2}, glossyOne));
  // Facing down, in the order a, d, c, b as seen from above.
  const auto down = [](float x, float y, float z, float side, int material) {
    return quad({x, y, z}, {x + side, y, z}, {x + side, y, z + side}, {x, y, z + side}, material);
  };
  b.add(down(-1.6f, 1.2f, -1.6f, 0.8f, b.material(textured)));
  b.add(down(0.6f, 1.0f, -1.5f, 0.9f, b.material(holes)));
  b.add(down(-1.5f, 0.9f, 0.4f, 0.7f, b.material(ghost)));
  const int bothOne = b.material(both);
  b.add(quad({1.2f, 0.05f, 0.2f}, {1.8f, 0.05f, 0.5f}, {1.8f, 0.7f, 0.5f}, {1.2f, 0.7f, 0.2f}, bothOne));
  // x and z mirrored one by one: turned about, and turned over.
  glm::mat4 mirrored(1.0f);
  mirrored[0][0] = -1.0f;
  b.place(b.mesh({down(0.2f, 0.12f, 0.9f, 0.5f, b.material(near))}), mirrored);
  b.add(quad({-0.6f, 0.5f, -0.6f}, {0.8f, 0.5f, -0.6f}, {0.8f, 0.6f, -1.4f}, {-0.6f, 0.6f, -1.4f}, b.material(pane)));
  if (sky) {
    b.scene.environment = environmentOf(16, 8, [](uint32_t x, uint32_t y) {
      return x == 5 && y == 2 ? glm::vec3(40, 35, 30) : glm::vec3(0.2f, 0.3f, 0.5f);
    });
  }
  scene::PunctualLight point;
  point.position = {0.3f, 1.5f, 1.0f};
  point.intensity = {1, 1, 1};
  b.scene.lights.push_back(point);
  b.scene.cameras.push_back(lookAt({0, 2.6f, 3.4f}, {0, 0, -0.1f}, 55.0f));
  return b.scene;
}

/// Chance of a false alarm: 1e-3 for all tiles, and as much for all means.
void expectUnbiased(bool sky, const std::vector<std::vector<std::string>>& settings) {
  Laboratory laboratory(lamps(sky), 32, 8);
  laboratory.measureTruth("3", 48, 8);
  for (const std::vector<std::string>& setting : settings) {
    std::string name;
    Protocol p;
    p.set = {"gbuffer.jitter=true"};
    for (const std::string& s : setting) {
      name += s + " ";
      p.set.push_back("initial." + s);
    }
    SCOPED_TRACE(name);
    p.disable = {"temporal", "spatial"};
    p.restarts = 32;
    p.frames = 3;
    const image::TileTest t = laboratory.test(p, 1e-3 / static_cast<double>(settings.size()));
    std::printf("|t| %.2f of %.2f, bias %+.2f %% (%+.2f ... %+.2f): %s\n", t.worstT, t.bound, 100 * t.relativeBias,
                100 * t.intervalLow, 100 * t.intervalHigh, name.c_str());
    expectAgreement(t, 0.1);
  }
}

TEST(RestirMixtures, LampsOfAllKinds) {
  expectUnbiased(false, {{"candidates=8"},
                         {"candidates=8", "uniformShare=0", "lobeShare=0"},
                         {"candidates=8", "uniformShare=1", "lobeShare=0.8"},
                         {"candidates=4", "bsdfRays=1"},
                         {"candidates=1", "bsdfRays=4", "samples=2"},
                         {"candidates=4", "bsdfRays=2", "triangles=area", "lobeShare=0"},
                         {"candidates=4", "bsdfRays=2", "uniformShare=1", "visibility=false"}});
}
TEST(RestirMixtures, LampsUnderTheSky) {
  expectUnbiased(true, {{"candidates=8", "bsdfCandidates=0"},
                        {"candidates=6", "bsdfCandidates=2", "bsdfRays=2"},
                        {"candidates=6", "bsdfCandidates=0", "bsdfRays=2", "visibility=false"}});
}

// A glossy plane that reflects the emitter's middle into the eye: rays along the BSDF find what points on the emitter
// hardly do, and half of what they meet behind the veil. Chance of a false alarm: 1e-4 over the runs.
TEST(RestirMixtures, RaysFindReflections) {
  scene::Camera camera = frontCamera(5e-4);
  View view(32, 32, camera);
  const oracle::Vec toEmitter = glm::normalize(oracle::Vec(-1.0, 1.1, 2.1)), toEye(0, 0, 1);
  const Finish finish{{0.3, 0.3, 0.3}, {0.5, 0.6, 0.7}, 0.15};
  for (uint32_t i = 0; i < 32 * 32; ++i)
    view.setOnPlane(i % 32, i / 32, 0.0, glm::normalize(toEmitter + toEye), finish);
  for (const bool veil : {false, true}) {
    double errorWithout = 0.0;
    for (const char* rays : {"0", "3"}) {
      SCOPED_TRACE(testing::Message() << rays << " rays" << (veil ? ", veiled" : ""));
      PassTest t("restir_di.Initial");
      scene::Scene scene = smallScene({.points = false, .spot = false, .blocker = false});
      scene.materials[2].baseColor.a = 0.5f;
      if (veil) {
        // Halfway to the emitter.
        scene::Primitive sheet;
        sheet.positions = {{-2, 0, 1}, {0.5f, 0, 1}, {0.5f, 2, 1}, {-2, 2, 1}};
        sheet.indices = {0, 1, 2, 0, 2, 3};
        sheet.material = 2;
        scene.meshes.push_back({"", {sheet}});
        scene::Instance instance;
        instance.mesh = static_cast<int>(scene.meshes.size()) - 1;
        scene.instances.push_back(instance);
      }
      show(t, view, scene);
      t.param("candidates", "2").param("lobeShare", "0").param("bsdfRays", rays).seed(41);
      const oracle::World world(t.prepared());
      const double truth = world.directLight(view[16 * 32 + 16], true, 1500);
      Sample sample;
      for (int frame = 0; frame < 16; ++frame) {
        t.run();
        const auto out = t.output<passes::Reservoir>("reservoirs");
        for (size_t i = 0; i < out.size(); ++i) {
          sample.add(estimate(world, view[i], out[i], true) / truth);
          ASSERT_FALSE(isSeen(out[i]) && world.transmittance(view[i], lightOf(out[i]), out[i].place) < 1.0);
        }
      }
      EXPECT_TRUE(agrees(sample, 1.0, 1e-4, 4));
      if (errorWithout == 0.0)
        errorWithout = sample.standardError();
      else
        EXPECT_LT(sample.standardError(), 0.6 * errorWithout);
    }
  }
}

}  // namespace
}  // namespace weir::test
