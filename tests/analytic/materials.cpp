// GGX in closed form: what a light without extent shows of it, and the limit of a mirror.
#include "analytic/forms.h"

namespace weir::test::analytic {
namespace {

const scene::Camera kSlanted = lookAt({0.3f, 1.2f, 1.7f}, {0, 0, 0}, 40);

scene::Material finish(const glm::vec3& color, float metallic, float roughness) {
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  return m;
}

std::function<std::optional<Vec>(const Vec&)> shown(const scene::Camera& camera,
                                                    std::function<Vec(const Vec& position, const Vec& view)> radiance) {
  return [=](const Vec& direction) -> std::optional<Vec> {
    const std::optional<Meeting> m = firstPanel({kFloor}, Vec(camera.eye), direction);
    if (!m || m->atEdge) return std::nullopt;
    return radiance(m->position, -direction);
  };
}

Form metal() {
  const glm::vec3 color(0.9f, 0.6f, 0.3f), at(-0.3f, 0.9f, -1.1f), intensity(3, 2, 1);
  Builder b = floorScene(finish(color, 1, 0.35f));
  b.scene.lights.push_back({"", scene::LightKind::Point, intensity, at});
  return {"rough metal",
          b.scene,
          kSlanted,
          shown(kSlanted,
                [=](const Vec& p, const Vec& view) {
                  const Vec d = Vec(at) - p;
                  return bsdfCos(Vec(0), Vec(color), 0.35f, {0, 1, 0}, view, glm::normalize(d)) * Vec(intensity) /
                         glm::dot(d, d);
                }),
          {allLights(1, 4), restir(4), pathTracer(0, 4)}};
}

Form dielectric() {
  const glm::vec3 color(0.8f, 0.5f, 0.3f), way = glm::normalize(glm::vec3(0.2f, -0.6f, 1)), lux(3, 2, 1);
  Builder b = floorScene(finish(color, 0, 0.3f));
  b.scene.lights.push_back({"", scene::LightKind::Directional, lux, {}, way});
  return {"glossy dielectric",
          b.scene,
          kSlanted,
          shown(kSlanted,
                [=](const Vec&, const Vec& view) {
                  return bsdfCos(Vec(color), Vec(0.04), 0.3f, {0, 1, 0}, view, -Vec(way)) * Vec(lux);
                }),
          {allLights(1, 4), restir(4), pathTracer(0, 4)}};
}

// α is at its least, 1/2048: a lobe within whose reach the light is uniform shows F L. Outside 20 α lies 1/400 of GGX's
// lobe, outside of 0.2 rad (where the light ends) less than (α / 0.1)² = 3e-5, and Smith's terms take about as little.
Form mirror() {
  const glm::vec3 color(0.9f, 0.6f, 0.3f), radiance(4, 3, 2);
  Builder b = floorScene(finish(color, 1, 0));
  b.add(quad({-3, 2, -4}, {3, 2, -4}, {3, 2, 2}, {-3, 2, 2}, b.material(emitter(radiance))));
  const scene::Camera camera = lookAt({0, 1.2f, 1.2f}, {0, 0, 0}, 20);
  return {"mirror",
          b.scene,
          camera,
          shown(camera,
                [=](const Vec&, const Vec& view) {
                  const Vec f0(color);
                  return (f0 + (1.0 - f0) * std::pow(1 - view.y, 5)) * Vec(radiance);
                }),
          {allLights(2, 6), pathTracer(0, 8)}};
}

}  // namespace

std::vector<Form (*)()> materialForms() {
  return {metal, dielectric, mirror};
}

}  // namespace weir::test::analytic
