// Emitting polygons over a Lambert floor: Lambert's formula.
#include "analytic/forms.h"

namespace weir::test::analytic {
namespace {

const glm::vec3 kRadiance(4, 3, 2);
const Vec kUp(0, 1, 0);
const scene::Camera kLow = lookAt({0.2f, 0.7f, 2.0f}, {0, 0, 0}, 34);

/// Faces down, at height 1.
Panel lamp(double halfX, double halfZ) {
  const auto x = static_cast<float>(halfX), z = static_cast<float>(halfZ);
  return {{-x, 1, -z}, {2.0 * x, 0, 0}, {0, 0, 2.0 * z}};
}

Polygon corners(const Panel& p) {
  return {p.origin, p.origin + p.u, p.origin + p.u + p.v, p.origin + p.v};
}

/// Irradiance of corners that run clockwise as seen from below or from above: either way positive.
double irradiance(const Vec& at, const Polygon& polygon) {
  return polygon.size() < 3 ? 0.0 : std::abs(lambertPolygon(at, kUp, polygon));
}

Form quadLight() {
  Builder b = floorScene();
  const Panel light = lamp(0.4, 0.3);
  b.add(quadOf(light, b.material(emitter(kRadiance))));
  return {"quad",
          b.scene,
          kLow,
          onFloor(kLow, [=](const Vec& p) { return Vec(kRadiance) * irradiance(p, corners(light)); }, {light}),
          {allLights(3, 2), restir(16), pathTracer(0, 240)}};
}

// A wall above hides what lies beyond its edge x = 0.1: the plane through the receiver and that edge cuts the polygon.
Form halfOccluded() {
  Builder b = floorScene();
  const Panel light = lamp(0.4, 0.3), blocker{{-4, 0.5, -3}, {Vec(glm::vec3(4.1f, 0, 0))}, {0, 0, 6}};
  b.add(quadOf(light, b.material(emitter(kRadiance))));
  scene::Material black = lambert(glm::vec3(0));
  black.doubleSided = true;
  b.add(quadOf(blocker, b.material(black)));
  const Vec edge = blocker.origin + blocker.u;
  const scene::Camera camera = lookAt({0.3f, 0.4f, 1.1f}, {0.15f, 0, 0}, 24);
  return {
      "half-occluded quad",
      b.scene,
      camera,
      onFloor(
          camera,
          [=](const Vec& p) {
            return Vec(kRadiance) * irradiance(p, seenPast(corners(light), p, edge, {0, 0, 1}, edge + Vec(1, 0, 0)));
          },
          {light, blocker}),
      {allLights(10, 2)}};
}

// A lamp as wide as a square, close over the floor under its first corner: what stands for its points is evenly spread
// there, too. The far corners add next to nothing.
Form cornerOfLargeLight() {
  Builder b = floorScene();
  const Polygon corners = {Vec(0, 0.25, 0), Vec(128, 0.25, 0), Vec(0, 0.25, 128)};
  scene::Primitive p;
  for (const Vec& corner : corners) {
    p.positions.emplace_back(corner);
    p.normals.emplace_back(0, -1, 0);
    p.uv0.emplace_back(0, 0);
  }
  p.indices = {0, 1, 2};
  p.material = b.material(emitter(kRadiance));
  b.add(p);
  const scene::Camera camera = lookAt({-0.4f, 0.25f, -0.4f}, {0, 0, 0}, 24);
  return {"corner of a large triangle",
          b.scene,
          camera,
          onFloor(camera, [=](const Vec& at) { return Vec(kRadiance) * irradiance(at, corners); }),
          {restir(96), pathTracer(0, 480)}};
}

Polygon disc(double radius, double height, int n) {
  Polygon result;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n;
    result.emplace_back(glm::vec3(Vec(radius * std::cos(angle), height, radius * std::sin(angle))));
  }
  return result;
}

// Seen from its axis, where π L r²/(r² + h²) is the limit of ever more corners (checked without a device), and around
// it.
Form coaxialDisc() {
  Builder b = floorScene();
  const Polygon rim = disc(0.5, 1, 24);
  scene::Primitive p;
  for (const Vec& corner : rim) {
    p.positions.emplace_back(corner);
    p.normals.emplace_back(0, -1, 0);
    p.uv0.emplace_back(0, 0);
  }
  for (uint32_t i = 1; i + 1 < rim.size(); ++i) p.indices.insert(p.indices.end(), {0, i, i + 1});
  p.material = b.material(emitter(kRadiance));
  b.add(p);
  const scene::Camera camera = lookAt({0.1f, 0.8f, 0.3f}, {0, 0, 0}, 30);
  return {"coaxial disc",
          b.scene,
          camera,
          onFloor(camera, [=](const Vec& at) { return Vec(kRadiance) * irradiance(at, rim); }),
          {allLights(1, 1), restir(40), pathTracer(0, 400)}};
}

// A convex polyhedron: each face that faces the receiver shows it all of itself, and no other does.
Form sphereLight() {
  Builder b = floorScene();
  scene::Primitive ball = sphere(5, 8, b.material(emitter(kRadiance)));
  for (glm::vec3& p : ball.positions) p = p * 0.4f + glm::vec3(0.1f, 1.2f, -0.1f);
  std::vector<Polygon> faces;
  for (size_t i = 0; i < ball.indices.size(); i += 3) {
    faces.push_back({Vec(ball.positions[ball.indices[i]]), Vec(ball.positions[ball.indices[i + 1]]),
                     Vec(ball.positions[ball.indices[i + 2]])});
  }
  b.add(ball);
  const scene::Camera camera = lookAt({0.3f, 0.7f, 1.3f}, {0, 0, 0}, 30);
  return {"tessellated sphere",
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) {
                    double sum = 0;
                    for (const Polygon& f : faces) {
                      if (glm::dot(glm::cross(f[1] - f[0], f[2] - f[0]), p - f[0]) > 0) sum += irradiance(p, f);
                    }
                    return Vec(kRadiance) * sum;
                  }),
          {allLights(1, 1)}};
}

// A lamp that stands on its edge lights the floor on both of its sides.
Form doubleSided() {
  Builder b = floorScene();
  const Panel light{{0, Vec(glm::vec3(0.3f)).x, -0.5}, {0, 0.5, 0}, {0, 0, 1}};
  scene::Material m = emitter(kRadiance);
  m.doubleSided = true;
  b.add(quadOf(light, b.material(m)));
  const scene::Camera camera = lookAt({0.1f, 2.2f, 0.2f}, {0, 0, 0}, 38);
  return {"double-sided emitter",
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) -> std::optional<Vec> {
                    if (std::abs(p.x) < 0.1) return std::nullopt;
                    return Vec(kRadiance) * irradiance(p, corners(light));
                  },
                  {light}),
          {allLights(3, 2), pathTracer(0, 500)}};
}

// Two texels, red and green on the left, green and blue on the right: 0 and 1 are what every device decodes exactly.
Form texturedEmitter() {
  Builder b = floorScene();
  const Panel light = lamp(0.4, 0.3);
  scene::Material m = emitter(kRadiance);
  m.emissiveTexture.texture = b.texture(
      2, 1, [](uint32_t x, uint32_t) { return x == 0 ? glm::u8vec4(255, 255, 0, 255) : glm::u8vec4(0, 255, 255, 255); },
      scene::Filter::Nearest, scene::Wrap::ClampToEdge);
  b.add(quadOf(light, b.material(m)));
  Panel left = light, right = light;
  left.u *= 0.5;
  right.u *= 0.5;
  right.origin += right.u;
  const scene::Camera camera = lookAt({0.1f, 0.7f, 1.2f}, {0, 0, 0}, 30);
  return {"textured emitter",
          b.scene,
          camera,
          onFloor(camera,
                  [=](const Vec& p) {
                    const double l = irradiance(p, corners(left)), r = irradiance(p, corners(right));
                    return Vec(kRadiance) * Vec(l, l + r, r);
                  },
                  {light}),
          {allLights(14, 2)}};
}

}  // namespace

std::vector<Form (*)()> areaForms() {
  return {quadLight, halfOccluded, cornerOfLargeLight, coaxialDisc, sphereLight, doubleSided, texturedEmitter};
}

}  // namespace weir::test::analytic
