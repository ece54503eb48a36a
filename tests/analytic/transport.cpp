// Light that is scattered more than once: enclosures in which every surface has the same radiosity, and other geometric
// series.
#include "analytic/forms.h"
#include "support/environment_oracle.h"

namespace weir::test::analytic {
namespace {

/// Every wall emits Le and reflects ρ: whatever the shape, the radiance is Le (1 + ρ + ρ² + …) everywhere in it.
Vec series(const Vec& emitted, const Vec& albedo, int terms) {
  Vec sum(0), term = emitted;
  for (int i = 0; i < terms; ++i) {
    sum += term;
    term *= albedo;
  }
  return sum;
}

scene::Material glowing(const glm::vec3& albedo, const glm::vec3& radiance) {
  scene::Material m = lambert(albedo);
  m.emission = radiance;
  return m;
}

// Closed: ρ^65 is nothing, so that it is Le / (1 - ρ).
Form closedSphere() {
  const glm::vec3 albedo(0.5f, 0.5f, 0.5f), radiance(0.5f, 1, 2);
  Builder b;
  scene::Primitive ball = sphere(6, 9, b.material(glowing(albedo, radiance)));
  for (size_t i = 0; i < ball.indices.size(); i += 3) std::swap(ball.indices[i + 1], ball.indices[i + 2]);
  ball.normals.clear();  // flat, and turned inwards with the triangles
  scene::Primitive flat;
  flat.material = ball.material;
  for (size_t i = 0; i < ball.indices.size(); i += 3) {
    const glm::vec3 p0 = ball.positions[ball.indices[i]], p1 = ball.positions[ball.indices[i + 1]],
                    p2 = ball.positions[ball.indices[i + 2]];
    for (const glm::vec3& p : {p0, p1, p2}) {
      flat.indices.push_back(static_cast<uint32_t>(flat.positions.size()));
      flat.positions.push_back(p);
      flat.normals.push_back(glm::normalize(glm::cross(p1 - p0, p2 - p0)));
      flat.uv0.emplace_back(0, 0);
    }
  }
  b.add(flat);
  const scene::Camera camera = lookAt({0.1f, 0.2f, 0.3f}, {-0.6f, -0.1f, -1}, 70);
  return {"closed sphere",
          b.scene,
          camera,
          [=](const Vec&) { return Vec(radiance) / (1.0 - Vec(albedo)); },
          {pathTracer(64, 100)}};
}

scene::Scene glowingBox(const glm::vec3& albedo, const glm::vec3& radiance) {
  Builder b;
  const int m = b.material(glowing(albedo, radiance));
  b.add(quad({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}, m));
  b.add(quad({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}, m));
  b.add(quad({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, m));
  b.add(quad({1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, m));
  b.add(quad({-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, m));
  b.add(quad({1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}, m));
  return b.scene;
}

const scene::Camera kInBox = lookAt({0.3f, 0.2f, 0.5f}, {-0.7f, -0.3f, -1}, 60);

// Emission, direct light and two bounces more: four terms.
Form finiteBounces() {
  const glm::vec3 albedo(0.8f, 0.5f, 0.2f), radiance(1, 2, 3);
  return {"box, two bounces",
          glowingBox(albedo, radiance),
          kInBox,
          [=](const Vec&) { return series(Vec(radiance), Vec(albedo), 4); },
          {pathTracer(2, 100)}};
}

Form colouredBox() {
  const glm::vec3 albedo(0.7f, 0.4f, 0.1f), radiance(1, 2, 3);
  return {"coloured box",
          glowingBox(albedo, radiance),
          kInBox,
          [=](const Vec&) { return Vec(radiance) / (1.0 - Vec(albedo)); },
          {pathTracer(64, 150)}};
}

// A plate that glows and one that doesn't, a metre apart and 2 km wide: what leaves between their rims is below
// 1e-6 a bounce. B1 = Le + ρ1 B2, B2 = ρ2 B1.
Form parallelPlates() {
  Builder b;
  const glm::vec3 radiance(1, 2, 3), lower(0.5f, 0.6f, 0.3f), upper(0.7f, 0.2f, 0.4f);
  const float w = 1000;
  b.add(quad({-w, 0, w}, {w, 0, w}, {w, 0, -w}, {-w, 0, -w}, b.material(glowing(lower, radiance))));
  b.add(quad({-w, 1, -w}, {w, 1, -w}, {w, 1, w}, {-w, 1, w}, b.material(lambert(upper))));
  const scene::Camera camera = lookAt({0, 0.5f, 0}, {1, 0.48f, 0.2f}, 80);
  const Vec first = Vec(radiance) / (1.0 - Vec(lower) * Vec(upper));
  return {"parallel plates",
          b.scene,
          camera,
          [=](const Vec& d) -> std::optional<Vec> {
            if (std::abs(d.y) < 0.05) return std::nullopt;
            return d.y < 0 ? first : Vec(upper) * first;
          },
          {pathTracer(64, 150)}};
}

// White surfaces that aren't convex, under a white sky: whatever path light takes, it comes from the sky. A corner of
// three squares; what is left after 1024 bounces is nothing.
Form furnace() {
  Builder b;
  scene::Material white = lambert(glm::vec3(1));
  white.doubleSided = true;
  const int m = b.material(white);
  b.add(quad({0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}, m));
  b.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, m));
  b.add(quad({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, m));
  b.scene.environment = environmentOf(16, 8, [](uint32_t, uint32_t) { return glm::vec3(1, 2, 0.5f); });
  const scene::Camera camera = lookAt({1.5f, 1.3f, 1.4f}, {0.3f, 0.3f, 0.3f}, 35);
  return {"white furnace", b.scene, camera, [](const Vec&) { return Vec(1, 2, 0.5); }, {pathTracer(1024, 40)}};
}

// The sun on a square; what that scatters lights a ceiling, by Lambert's formula. The ceiling sees no sun itself (the
// light meets it from behind), and its shadow falls beside the square.
Form oneBounce() {
  Builder b;
  const glm::vec3 albedo(0.6f, 0.4f, 0.2f), lux(5, 6, 7), way = glm::normalize(glm::vec3(-1, -1, 0));
  const Panel square{{-0.5, 0, 0.5}, {1, 0, 0}, {0, 0, -1}}, ceiling{{-0.5, 1.5, -0.5}, {1, 0, 0}, {0, 0, 1}};
  b.add(quadOf(square, b.material(lambert(albedo))));
  b.add(quadOf(ceiling, b.material(lambert(kAlbedo))));
  b.scene.lights.push_back({"", scene::LightKind::Directional, lux, {}, way});
  const scene::Camera camera = lookAt({0.6f, 0.4f, 0.9f}, {0, 1.5f, 0}, 30);
  const Vec radiosity = Vec(lux) * -double(way.y) * Vec(albedo) / kPi;
  const Polygon corners{square.origin, square.origin + square.u, square.origin + square.u + square.v,
                        square.origin + square.v};
  return {"one bounce",
          b.scene,
          camera,
          [=](const Vec& direction) -> std::optional<Vec> {
            const std::optional<Meeting> m = firstPanel({ceiling, square}, Vec(camera.eye), direction);
            if (!m || m->panel != 0 || m->atEdge) return std::nullopt;
            return Vec(kAlbedo) / kPi * radiosity * std::abs(lambertPolygon(m->position, {0, -1, 0}, corners));
          },
          {pathTracer(1, 200, 32)}};
}

}  // namespace

std::vector<Form (*)()> transportForms() {
  return {closedSphere, finiteBounces, colouredBox, parallelPlates, furnace, oneBounce};
}

}  // namespace weir::test::analytic
