// reference.PathTracer without bounces, whose light samples and BSDF rays share their weights, against
// reference.AllLights, which goes through all lights one by one.
#include <weir/scene/import.h>

#include "passes_reference/path_picture.h"
#include "support/device.h"
#include "support/environment_oracle.h"

namespace weir::test {
namespace {

const scene::Camera kAbove = lookAt({0.3f, 2, 1.5f}, {0, 0.2f, 0}, 50);

glm::vec3 sky(uint32_t x, uint32_t y) {
  return {0.1f + 0.05f * static_cast<float>(y % 3), 0.2f, x == 3 && y == 2 ? 6.0f : 0.3f};
}

scene::Material blend(scene::Material m, float alpha) {
  m.alphaMode = scene::AlphaMode::Blend;
  m.baseColor.a = alpha;
  m.doubleSided = true;
  return m;
}

/// A ball on a floor, with a lamp over them.
Builder still(const scene::Material& floor, const scene::Material& ball, const scene::Material& lamp) {
  Builder b;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(floor)));
  b.add(sphere(16, 32, b.material(ball)), placed({0, 0.5f, 0}, 0.5f));
  b.add(quad({-0.6f, 1.6f, -0.5f}, {0.5f, 1.8f, -0.5f}, {0.5f, 1.8f, 0.5f}, {-0.6f, 1.6f, 0.5f}, b.material(lamp)));
  return b;
}

/// `detectable`: see expectSameMean().
void expectDirectLight(View view, double detectable = 0.25, const std::string& uniformShare = "0.1") {
  view.look();
  const Frames reference = framesOf(view, "reference.AllLights", {{"samples", "3"}}, 5);
  const Frames paths = pathFrames(view, {{"maxBounces", "0"}, {"samples", "8"}, {"uniformShare", uniformShare}}, 24);
  expectSameMean(paths, reference, detectable);
}

// Triangles, points, spots, the sun and the sky, through a veil, on rough and on glossy surfaces.
TEST(DirectLight, OfAllKindsTogether) {
  Builder b = still(lambert({0.8f, 0.6f, 0.4f}), metal({0.9f, 0.7f, 0.5f}, 0.45f), lambert(glm::vec3(0), {4, 3, 2}));
  b.add(quad({-0.9f, 0.9f, 0.9f}, {0.2f, 0.9f, 0.9f}, {0.2f, 0.9f, -0.9f}, {-0.9f, 0.9f, -0.9f},
             b.material(blend(lambert({0.5f, 0.5f, 0.5f}), 0.6f))));
  b.scene.lights.push_back({"", scene::LightKind::Point, {1, 0.5f, 0.5f}, {1.2f, 1.0f, 0.7f}});
  scene::PunctualLight spot{
      "", scene::LightKind::Spot, {0, 3, 1}, {-1, 1.5f, 0.5f}, glm::normalize(glm::vec3(0.6f, -1, 0))};
  spot.innerCone = 0.2f;
  spot.outerCone = 0.6f;
  b.scene.lights.push_back(spot);
  b.scene.lights.push_back(
      {"", scene::LightKind::Directional, {0.2f, 0.2f, 0.4f}, {}, glm::normalize(glm::vec3(0.3f, -1, -0.2f))});
  b.scene.environment = environmentOf(8, 4, sky);
  expectDirectLight(View{b.scene, kAbove});
}

// Lobes of every width, which light samples hardly find and BSDF rays hardly miss: a weight that is wrong shows.
TEST(DirectLight, InGlossyReflections) {
  for (const float roughness : {0.08f, 0.25f, 0.5f}) {
    SCOPED_TRACE(roughness);
    Builder b = still(metal({0.9f, 0.8f, 0.7f}, roughness), metal({0.5f, 0.7f, 0.9f}, roughness),
                      lambert(glm::vec3(0), {4, 3, 2}));
    b.scene.environment = environmentOf(8, 4, sky);
    expectDirectLight(View{b.scene, kAbove});
  }
}

// Light samples come to the sky, and to either lamp, once in a dozen: a weight that forgets how seldom a light is
// picked shows.
TEST(DirectLight, OfASkyAmongOtherLights) {
  Builder b = still(metal({0.9f, 0.8f, 0.7f}, 0.6f), metal({0.5f, 0.7f, 0.9f}, 0.4f), lambert(glm::vec3(0), {1, 1, 1}));
  b.scene.environment = environmentOf(8, 4, sky);
  for (int i = 0; i < 9; ++i)  // below the floor
    b.scene.lights.push_back({"", scene::LightKind::Point, {1, 1, 1}, {0.1f * static_cast<float>(i), -1, 0}});
  expectDirectLight(View{b.scene, kAbove}, 0.25, "1");
}

/// A lamp with a texture whose alpha is a coarse pattern.
scene::Material patterned(Builder& b, scene::AlphaMode mode) {
  scene::Material m = lambert(glm::vec3(0), {4, 3, 2});
  m.alphaMode = mode;
  m.doubleSided = true;
  m.baseColorTexture.texture =
      b.texture(4, 4, [](uint32_t x, uint32_t y) { return glm::u8vec4(255, 255, 255, x < 2 ? 0 : 64 * y + 40); });
  return m;
}

// Lamps that are partly there: as light samples have it and as rays meet it.
TEST(DirectLight, OfLampsWithAlpha) {
  for (const scene::AlphaMode mode : {scene::AlphaMode::Mask, scene::AlphaMode::Blend}) {
    SCOPED_TRACE(mode == scene::AlphaMode::Mask ? "mask" : "blend");
    Builder b = still(metal({0.9f, 0.8f, 0.7f}, 0.5f), lambert({0.5f, 0.7f, 0.9f}), {});
    b.scene.materials[2] = patterned(b, mode);
    expectDirectLight(View{b.scene, kAbove});
  }
}

// A lamp that a clip moves, once as it is and once mirrored: rays that meet it find the right light, and the right
// place on it.
TEST(DirectLight, OfLampsThatMove) {
  for (const bool mirrored : {false, true}) {
    SCOPED_TRACE(mirrored ? "mirrored" : "plain");
    View view{scene::importGltf(sourcePath("scenes/cornell-moving.glb")), {}};
    view.camera = view.scene.cameras.at(0);
    view.clip = "lamp";
    view.at = 0.7;
    Builder b;
    b.scene = view.scene;
    for (scene::Material& m : b.scene.materials) {
      if (!m.isEmissive()) continue;
      m.emissiveTexture.texture = b.texture(
          8, 8, [](uint32_t x, uint32_t y) { return glm::u8vec4(32 * x, 255 - 32 * y, x * y == 0 ? 255 : 0, 255); });
    }
    for (scene::Clip& clip : b.scene.clips)
      for (scene::Channel& channel : clip.channels)
        if (mirrored && clip.name == "lamp" && channel.path == scene::AnimatedPath::Scale)
          for (size_t i = 0; i < channel.values.size(); i += 3) channel.values[i] = -channel.values[i];
    view.scene = b.scene;
    expectDirectLight(view, 0.4);
  }
}

/// By reference.AllLights.
image::Picture allLights(const scene::Scene& scene) {
  View view{scene, kAbove};
  return collect(framesOf(view.look(), "reference.AllLights", {{"samples", "8"}}, 2)).mean();
}

Builder underLamp(const scene::Material& lamp) {
  Builder b;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(lambert(glm::vec3(0.8f)))));
  b.add(quad({-0.4f, 1, -0.3f}, {0.4f, 1, -0.3f}, {0.4f, 1, 0.3f}, {-0.4f, 1, 0.3f}, b.material(lamp)));
  return b;
}

double total(const image::Picture& p) {
  double sum = 0;
  for (size_t i = 0; i < p.rgba.size(); i += 4) sum += p.rgba[i];
  return sum;
}

// Alpha 0.25 all over: a quarter of the light, random numbers and all else being equal.
TEST(LampsWithAlpha, EmitAsMuchAsTheyCover) {
  const scene::Material plain = lambert(glm::vec3(0), {4, 3, 2});
  scene::Material veil = blend(plain, 0.25f);
  veil.doubleSided = false;
  const image::Picture full = allLights(underLamp(plain).scene), quarter = allLights(underLamp(veil).scene);
  EXPECT_GT(total(full), 20.0);
  for (size_t i = 0; i < full.rgba.size(); ++i)
    if (i % 4 != 3) EXPECT_NEAR(quarter.rgba[i], 0.25f * full.rgba[i], 1e-5f * full.rgba[i]) << i;
}

// The masked half of a lamp is as if it were not there: what is left is a lamp of half the width. Strata across the
// border leave a per cent or two a pixel, and their mean a tenth of that.
TEST(LampsWithAlpha, DoNotShineWhereTheyAreMaskedAway) {
  Builder masked = underLamp(lambert(glm::vec3(0), {4, 3, 2}));
  scene::Material& m = masked.scene.materials[1];
  m.alphaMode = scene::AlphaMode::Mask;
  m.baseColorTexture.texture = masked.texture(
      8, 8, [](uint32_t x, uint32_t) { return glm::u8vec4(255, 255, 255, x < 4 ? 0 : 255); }, scene::Filter::Nearest,
      scene::Wrap::ClampToEdge);
  Builder half;
  half.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, half.material(lambert(glm::vec3(0.8f)))));
  half.add(quad({0, 1, -0.3f}, {0.4f, 1, -0.3f}, {0.4f, 1, 0.3f}, {0, 1, 0.3f},
                half.material(lambert(glm::vec3(0), {4, 3, 2}))));
  const image::Picture a = allLights(masked.scene), b = allLights(half.scene);
  EXPECT_GT(total(b), 10.0);
  EXPECT_NEAR(total(a) / total(b), 1.0, 4e-3);
  size_t off = 0;
  for (size_t i = 0; i < a.rgba.size(); i += 4) off += std::abs(a.rgba[i] - b.rgba[i]) > 0.05f * b.rgba[i] ? 1 : 0;
  EXPECT_LE(off, a.rgba.size() / 4 / 50);
}

// Alpha of 0 and 255 shines just where an emissive texture of black and white does.
TEST(LampsWithAlpha, ShineThroughAlphaAsThroughEmission) {
  const auto lamp = [](bool byAlpha) {
    Builder b = underLamp(lambert(glm::vec3(0), {4, 3, 2}));
    scene::Material& m = b.scene.materials[1];
    const int texture = b.texture(
        8, 8,
        [&](uint32_t x, uint32_t y) {
          const bool on = (x / 2 + y / 2) % 2 == 0;
          return byAlpha ? glm::u8vec4(255, 255, 255, on ? 255 : 0) : on ? glm::u8vec4(255) : glm::u8vec4(0, 0, 0, 255);
        },
        scene::Filter::Nearest);
    if (byAlpha) {
      m.alphaMode = scene::AlphaMode::Blend;
      m.baseColorTexture.texture = texture;
    } else {
      m.emissiveTexture.texture = texture;
    }
    return allLights(b.scene);
  };
  const image::Picture alpha = lamp(true), emission = lamp(false);
  EXPECT_GT(total(emission), 10.0);
  for (size_t i = 0; i < alpha.rgba.size(); ++i)
    if (i % 4 != 3) EXPECT_NEAR(alpha.rgba[i], emission.rgba[i], 1e-5f * emission.rgba[i] + 1e-7f) << i;
}

}  // namespace
}  // namespace weir::test
