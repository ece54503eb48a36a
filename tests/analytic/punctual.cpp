// Point, spot and directional lights: nothing to integrate, so that one frame has next to no variance but that of
// choosing among lights.
#include "analytic/forms.h"

namespace weir::test::analytic {
namespace {

const glm::vec3 kIntensity(3, 2, 1);
const scene::Camera kAbove = lookAt({0.3f, 2, 1.5f}, {0, 0, 0}, 40);

/// Irradiance by the inverse square and the cosine law.
Vec pointOn(const Vec& at, const Vec& normal, const Vec& light, const Vec& intensity) {
  const Vec d = light - at;
  const double r = glm::length(d);
  return intensity * (std::max(0.0, glm::dot(normal, d)) / (r * r * r));
}

scene::PunctualLight pointLight(const glm::vec3& intensity, const glm::vec3& at) {
  return {"", scene::LightKind::Point, intensity, at};
}

Form point() {
  Builder b = floorScene();
  const glm::vec3 at(0.4f, 1.2f, -0.3f);
  b.scene.lights.push_back(pointLight(kIntensity, at));
  return {"point",
          b.scene,
          kAbove,
          onFloor(kAbove,
                  [=](const Vec& p) {
                    return pointOn(p, {0, 1, 0}, Vec(at), Vec(kIntensity));
                  }),
          {allLights(1, 2), restir(2), pathTracer(0, 2)}};
}

/// KHR_lights_punctual: t² with t linear in the cosine between the cones.
Form spot(const char* name, bool falloff) {
  Builder b = floorScene();
  scene::PunctualLight light = pointLight(kIntensity, {0, 1.5f, 0});
  light.kind = scene::LightKind::Spot;
  light.direction = glm::normalize(glm::vec3(0.1f, -1, 0.05f));
  light.innerCone = falloff ? 0.1f : 0.5f;
  light.outerCone = falloff ? 0.7f : 0.6f;
  b.scene.lights.push_back(light);
  const scene::Camera camera = lookAt({0.1f, 2.4f, 0.9f}, {0.1f, 0, 0.05f}, 30);
  return {name,
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) -> std::optional<Vec> {
                    const double cosine = glm::dot(glm::normalize(p - Vec(light.position)), Vec(light.direction));
                    const double inner = std::cos(double(light.innerCone)), outer = std::cos(double(light.outerCone));
                    const double t = std::min((cosine - outer) / (inner - outer), 1.0);
                    if (falloff ? t < 0.05 || t > 0.95 : t < 1) return std::nullopt;
                    return pointOn(p, {0, 1, 0}, Vec(light.position), Vec(kIntensity)) * (t * t);
                  }),
          {allLights(1, 2), restir(2), pathTracer(0, 2)}};
}
Form spotInside() {
  return spot("spot, inner cone", false);
}
Form spotFalloff() {
  return spot("spot, falloff", true);
}

// Six panels tilted from 0° to 80° against the light.
Form directional() {
  Builder b;
  const int material = b.material(lambert(kAlbedo));
  const glm::vec3 way = glm::normalize(glm::vec3(0.05f, -0.03f, -1));
  std::vector<Panel> panels;
  for (int i = 0; i < 6; ++i) {
    const double tilt = glm::radians(16.0 * i), x = -1.5 + i % 3 * 1.05, y = i / 3 * 1.05 - 1;
    // Rounded to what the scene holds.
    panels.push_back(
        {Vec(glm::vec3(Vec(x, y, 0))), Vec(glm::vec3(Vec(std::cos(tilt), 0, -std::sin(tilt)))), {0, 1, 0}});
    b.add(quadOf(panels.back(), material));
  }
  b.scene.lights.push_back({"", scene::LightKind::Directional, kIntensity, {}, way});
  const scene::Camera camera = lookAt({-1.2f, 0, 4}, {0, 0, 0}, 40);
  return {"directional, six tilts",
          b.scene,
          camera,
          [=](const Vec& direction) -> std::optional<Vec> {
            const std::optional<Meeting> m = firstPanel(panels, Vec(camera.eye), direction);
            if (!m || m->atEdge) return std::nullopt;
            const Vec n = panels[m->panel].normal();
            if (glm::dot(n, direction) > -0.01) return std::nullopt;
            return Vec(kAlbedo) / kPi * Vec(kIntensity) * glm::dot(n, -Vec(way));
          },
          {allLights(1, 2), restir(2), pathTracer(0, 2)}};
}

// A red light on one side, a blue and green one on the other: channels come from different lights.
Form colouredPair() {
  Builder b = floorScene();
  const glm::vec3 left(-0.8f, 0.9f, 0), right(0.9f, 1.1f, 0.1f), red(4, 0.1f, 0), cyan(0, 1.5f, 3);
  b.scene.lights.push_back(pointLight(red, left));
  b.scene.lights.push_back(pointLight(cyan, right));
  return {"coloured pair",
          b.scene,
          kAbove,
          onFloor(kAbove,
                  [=](const Vec& p) {
                    return pointOn(p, {0, 1, 0}, Vec(left), Vec(red)) + pointOn(p, {0, 1, 0}, Vec(right), Vec(cyan));
                  }),
          {allLights(1, 2)}};
}

// Light at 88.3° to 89.2° on a plane whose normal no packed format can say exactly.
Form grazing() {
  Builder b;
  const glm::dmat3 turn = glm::dmat3(glm::normalize(Vec(0.8, 0.31, -0.4)), Vec(0), Vec(0));
  const Vec x = turn[0], n = glm::normalize(glm::cross(Vec(0.2, -0.3, 1), x)), z = glm::cross(x, n);
  const auto exact = [](const Vec& v) { return Vec(glm::vec3(v)); };
  const Panel panel{exact(-x - z), exact(2.0 * z), exact(2.0 * x)};
  b.add(quadOf(panel, b.material(lambert(kAlbedo))));
  const Vec light = exact(20.0 * x + 0.4 * n), normal = panel.normal();
  b.scene.lights.push_back(pointLight(glm::vec3(4e4f, 3e4f, 2e4f), glm::vec3(light)));
  const scene::Camera camera = lookAt(glm::vec3(3.0 * n + 0.3 * x), {0, 0, 0}, 25);
  return {"grazing",
          b.scene,
          camera,
          [=](const Vec& direction) -> std::optional<Vec> {
            const std::optional<Meeting> m = firstPanel({panel}, Vec(camera.eye), direction);
            if (!m || m->atEdge) return std::nullopt;
            return Vec(kAlbedo) / kPi * pointOn(m->position, normal, light, Vec(4e4, 3e4, 2e4));
          },
          {allLights(1, 4, 32), restir(4, 32), pathTracer(0, 4, 32)}};
}

// 10 km away it is a directional light of I/d² lux.
Form farAway() {
  Builder b = floorScene();
  const glm::vec3 at(3e3f, 9e3f, -2e3f), intensity = kIntensity * 1e8f;
  b.scene.lights.push_back(pointLight(intensity, at));
  const Vec away(at);
  const double d2 = glm::dot(away, away);
  return {"far away",
          b.scene,
          kAbove,
          onFloor(kAbove,
                  [=](const Vec& p) -> std::optional<Vec> {
                    const Vec exact = pointOn(p, {0, 1, 0}, away, Vec(intensity));
                    const Vec limit = Vec(intensity) / d2 * (away.y / std::sqrt(d2));
                    // The limit itself is off by 1/d: 1e-4 here.
                    if (glm::length(exact - limit) > 5e-4 * glm::length(limit)) return Vec(NAN);
                    return exact;
                  }),
          {allLights(1, 2), restir(2), pathTracer(0, 2)}};
}

Form manyEqual() {
  Builder b = floorScene();
  std::vector<Vec> places;
  for (int i = 0; i < 256; ++i) {
    const glm::vec3 at(-1.875f + 0.25f * static_cast<float>(i % 16), 1 + 0.125f * static_cast<float>(i % 5),
                       -1.875f + 0.25f * static_cast<float>(i / 16));
    places.emplace_back(at);
    b.scene.lights.push_back(pointLight(glm::vec3(0.02f, 0.03f, 0.04f), at));
  }
  return {"256 equal lights",
          b.scene,
          kAbove,
          onFloor(kAbove,
                  [=](const Vec& p) {
                    Vec sum(0);
                    for (const Vec& at : places) {
                      sum += pointOn(p, {0, 1, 0}, at, Vec(0.02, 0.03, 0.04));
                    }
                    return sum;
                  }),
          {allLights(1, 1), restir(60, 16, {"initial.candidates=128"})}};
}

}  // namespace

std::vector<Form (*)()> punctualForms() {
  return {point, spotInside, spotFalloff, directional, colouredPair, grazing, farAway, manyEqual};
}

}  // namespace weir::test::analytic
