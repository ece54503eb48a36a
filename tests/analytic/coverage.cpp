// What is between the light and the surface: panes that let a part through, masks with holes, walls before a sky.
#include "analytic/forms.h"
#include "support/environment_oracle.h"

namespace weir::test::analytic {
namespace {

const glm::vec3 kIntensity(3, 2, 1);
const Vec kUp(0, 1, 0);

int pane(Builder& b, float alpha) {
  scene::Material m = lambert(glm::vec3(0.5f));
  m.alphaMode = scene::AlphaMode::Blend;
  m.baseColor.a = alpha;
  m.doubleSided = true;
  return b.material(m);
}

// Shadow rays take Π (1 - α). The panes lie above the camera; its rays see none of them.
Form panes(const char* name, const std::vector<float>& alphas) {
  Builder b = floorScene();
  const glm::vec3 at(0.2f, 1.5f, 0);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, at});
  double through = 1;
  for (size_t i = 0; i < alphas.size(); ++i) {
    const float y = 1.1f + 0.1f * static_cast<float>(i);
    b.add(quad({-1.9f, y, -1.9f}, {1.9f, y, -1.9f}, {1.9f, y, 1.9f}, {-1.9f, y, 1.9f}, pane(b, alphas[i])));
    through *= 1 - double(alphas[i]);
  }
  const scene::Camera camera = lookAt({0.3f, 0.9f, 1.3f}, {0, 0, 0}, 40);
  return {name,
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) {
                    const Vec d = Vec(at) - p;
                    return Vec(kIntensity) * (through * d.y / std::pow(glm::length(d), 3));
                  }),
          // restir_di draws no coins for shadow rays either: a reservoir carries the transmittance.
          {allLights(1, 2), restir(2), pathTracer(0, 2)}};
}
Form onePane() {
  return panes("one pane", {0.25f});
}
Form twoPanes() {
  return panes("two panes", {0.3f, 0.5f});
}

// A grating of eight bars and eight slits of equal width before a quad light. Each slit shows what of the light lies
// between the planes through the receiver and its two edges.
Form grating() {
  Builder b = floorScene();
  const Panel light{{-0.4f, 1, -0.3f}, {2 * double(0.4f), 0, 0}, {0, 0, 2 * double(0.3f)}};
  const glm::vec3 radiance(4, 3, 2);
  b.add(quadOf(light, b.material(emitter(radiance))));
  scene::Material mask = lambert(glm::vec3(0));
  mask.alphaMode = scene::AlphaMode::Mask;
  mask.doubleSided = true;
  mask.baseColorTexture.texture = b.texture(
      16, 1, [](uint32_t x, uint32_t) { return glm::u8vec4(255, 255, 255, x % 2 == 0 ? 255 : 0); },
      scene::Filter::Nearest, scene::Wrap::ClampToEdge);
  const Panel grid{{-2, 0.75, 2}, {4, 0, 0}, {0, 0, -4}};
  b.add(quadOf(grid, b.material(mask)));
  const scene::Camera camera = lookAt({0.1f, 0.6f, 0.9f}, {0, 0, 0}, 28);
  const Polygon corners{light.origin, light.origin + light.u, light.origin + light.u + light.v, light.origin + light.v};
  return {"mask grating",
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) {
                    double sum = 0;
                    for (int slit = 0; slit < 8; ++slit) {
                      const Vec low(-2 + 0.25 * (2 * slit + 1), 0.75, 0), high = low + Vec(0.25, 0, 0);
                      Polygon seen = seenPast(corners, p, low, {0, 0, 1}, high);
                      if (seen.size() >= 3) seen = seenPast(seen, p, high, {0, 0, 1}, low);
                      if (seen.size() >= 3) sum += std::abs(lambertPolygon(p, kUp, seen));
                    }
                    return Vec(radiance) * sum;
                  }),
          {allLights(10, 3), pathTracer(0, 500, 32)}};
}

const glm::vec3 kSky(0.7f, 1.1f, 2.3f);
/// As it is stored: half floats.
Vec skyOf(const scene::Environment& e) {
  return EnvironmentOracle(e).texel(0, 0);
}

// π L, and less what a black wall's polygon hides.
Form sky(const char* name, bool walled) {
  Builder b = floorScene();
  const Panel wall{{-1, 0.1f, -0.8f}, {2, 0, 0}, {0, 1.5, 0}};
  if (walled) {
    scene::Material black = lambert(glm::vec3(0));
    black.doubleSided = true;
    b.add(quadOf(wall, b.material(black)));
  }
  b.scene.environment = environmentOf(16, 8, [](uint32_t, uint32_t) { return kSky; });
  const Vec radiance = skyOf(b.scene.environment);
  const scene::Camera camera = lookAt({0.1f, 1.2f, 1.1f}, {0, 0, -0.2f}, 34);
  const Polygon corners{wall.origin, wall.origin + wall.u, wall.origin + wall.u + wall.v, wall.origin + wall.v};
  std::vector<Panel> inFront;
  if (walled) inFront = {wall};
  return {
      name,
      b.scene,
      camera,
      onFloor(
          camera,
          [=](const Vec& p) { return radiance * (kPi - (walled ? std::abs(lambertPolygon(p, kUp, corners)) : 0.0)); },
          inFront),
      {allLights(walled ? 10 : 6, walled ? 4 : 2), pathTracer(0, walled ? 300 : 60)}};
}
Form openSky() {
  return sky("constant sky", false);
}
Form halfSky() {
  return sky("sky and a wall", true);
}

}  // namespace

std::vector<Form (*)()> coverageForms() {
  return {onePane, twoPanes, grating, openSky, halfSky};
}

}  // namespace weir::test::analytic
