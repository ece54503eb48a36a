// A closed form: a scene of which the radiance that a pixel's centre shows is known in double precision, written from
// the literature alone. Shared parts: planes that rays meet, Lambert's formula for polygons, clipping.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "support/restarts.h"
#include "support/small_scenes.h"

namespace weir::test::analytic {

inline constexpr double kPi = std::numbers::pi;
using Vec = glm::dvec3;
using Polygon = std::vector<Vec>;

struct Form {
  std::string name;
  scene::Scene scene;
  scene::Camera camera;
  /// Radiance (nit) towards the camera along a unit direction from its eye; none: not part of the region where the form
  /// holds.
  std::function<std::optional<Vec>(const Vec& direction)> expected;
  std::vector<Plan> plans;  ///< the estimators that are held to it, and how often each runs
};

/// A parallelogram that rays meet, as quad() makes them: origin, two sides.
struct Panel {
  Vec origin, u, v;
  Vec normal() const { return glm::normalize(glm::cross(u, v)); }
};

struct Meeting {
  size_t panel;
  Vec position;
  bool atEdge;  ///< so close to an edge that single precision may miss it, or nearly the same distance as another panel
};

/// The first panel along a ray: the plane's equation, then coordinates along its sides.
inline std::optional<Meeting> firstPanel(const std::vector<Panel>& panels, const Vec& eye, const Vec& direction) {
  std::optional<Meeting> first;
  double nearest = 1e300;
  bool edge = false;
  for (size_t i = 0; i < panels.size(); ++i) {
    const Panel& p = panels[i];
    const Vec n = glm::cross(p.u, p.v);
    const double t = glm::dot(p.origin - eye, n) / glm::dot(direction, n);
    if (!(t > 0)) continue;
    const Vec d = eye + t * direction - p.origin;
    const double nn = glm::dot(n, n), a = glm::dot(n, glm::cross(d, p.v)) / nn,
                 b = glm::dot(n, glm::cross(p.u, d)) / nn;
    const double margin = std::min(std::min(a, 1 - a), std::min(b, 1 - b));
    if (margin < -1e-3) continue;
    edge |= margin < 1e-3;
    if (margin < 0 || t >= nearest) continue;
    nearest = t;
    first = Meeting{i, eye + t * direction, false};
  }
  if (first) first->atEdge = edge;
  return first;
}

/// Irradiance from a uniform polygon of radiance 1 on a plane element, wholly above its horizon: Lambert 1760,
/// "Photometria"; Arvo 1995, "Analytic Methods for Simulated Light Transport", eq. 2.18: 1/2 Σ γ_i n·Γ_i, γ_i the angle
/// that edge i subtends and Γ_i the unit normal of its plane with the receiver. Negative when the corners run the other
/// way round.
inline double lambertPolygon(const Vec& at, const Vec& normal, const Polygon& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec a = corners[i] - at, b = corners[(i + 1) % corners.size()] - at, n = glm::cross(a, b);
    const double sine = glm::length(n);
    if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, n) / sine;
  }
  return sum / 2;
}

/// What of a polygon lies where (x - point)·inside >= 0 (Sutherland and Hodgman 1974).
inline Polygon clipped(const Polygon& corners, const Vec& point, const Vec& inside) {
  Polygon result;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec a = corners[i], b = corners[(i + 1) % corners.size()];
    const double da = glm::dot(a - point, inside), db = glm::dot(b - point, inside);
    if (da >= 0) result.push_back(a);
    if ((da >= 0) != (db >= 0)) result.push_back(a + (b - a) * (da / (da - db)));
  }
  return result;
}

/// What of a polygon is seen from `at` past a straight edge (a point on it and its direction), on the side of `open`.
inline Polygon seenPast(const Polygon& corners, const Vec& at, const Vec& edge, const Vec& along, const Vec& open) {
  Vec inside = glm::cross(along, edge - at);
  if (glm::dot(inside, open - at) < 0) inside = -inside;
  return clipped(corners, at, inside);
}

inline Vec bsdfCos(const Vec& diffuse, const Vec& f0, double roughness, const Vec& n, const Vec& view,
                   const Vec& light) {
  // glTF 2.0, appendix B.3: D of GGX, V with Smith's height-correlated G, F of Schlick; the layers mix by F.
  const double a2 = std::pow(roughness, 4), nl = glm::dot(n, light), nv = glm::dot(n, view);
  if (nl <= 0 || nv <= 0) return Vec(0);
  const Vec h = glm::normalize(light + view);
  const double nh = glm::dot(n, h), vh = glm::dot(view, h);
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double v = 0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
  const Vec f = f0 + (1.0 - f0) * std::pow(1 - vh, 5);
  return ((1.0 - f) * diffuse / kPi + f * d * v) * nl;
}

/// Lambert and nothing else: KHR_materials_specular with a weight of 0.
inline scene::Material lambert(const glm::vec3& albedo) {
  scene::Material m;
  m.baseColor = glm::vec4(albedo, 1);
  m.metallic = 0;
  m.specular = 0;
  return m;
}

inline scene::Material emitter(const glm::vec3& radiance) {
  scene::Material m = lambert(glm::vec3(0));
  m.emission = radiance;
  return m;
}

inline scene::Primitive quadOf(const Panel& p, int material) {
  return quad(glm::vec3(p.origin), glm::vec3(p.origin + p.u), glm::vec3(p.origin + p.u + p.v),
              glm::vec3(p.origin + p.v), material);
}

inline const glm::vec3 kAlbedo(0.8f, 0.5f, 0.3f);
inline const Panel kFloor{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}};  // faces up

/// What a floor of kAlbedo shows where nothing hides it from the camera: kAlbedo / π times the irradiance there.
inline std::function<std::optional<Vec>(const Vec&)> onFloor(const scene::Camera& camera,
                                                             std::function<std::optional<Vec>(const Vec&)> irradiance,
                                                             std::vector<Panel> inFront = {}) {
  inFront.insert(inFront.begin(), kFloor);
  return [=](const Vec& direction) -> std::optional<Vec> {
    const std::optional<Meeting> m = firstPanel(inFront, Vec(camera.eye), direction);
    if (!m || m->panel != 0 || m->atEdge) return std::nullopt;
    const std::optional<Vec> e = irradiance(m->position);
    if (!e) return std::nullopt;
    return Vec(kAlbedo) / kPi * *e;
  };
}

inline Builder floorScene(const scene::Material& material = lambert(kAlbedo)) {
  Builder b;
  b.add(quadOf(kFloor, b.material(material)));
  return b;
}

/// How often each estimator runs. Restarts are 24 everywhere: Student's bounds depend on them alone.
constexpr uint32_t kRestarts = 24;
Plan allLights(int samples, uint32_t frames, uint32_t side = 16);
Plan restir(uint32_t frames, uint32_t side = 16, std::vector<std::string> more = {});
/// maxBounces: of indirect light, beyond direct light.
Plan pathTracer(int maxBounces, uint32_t frames, uint32_t side = 16);

std::vector<Form (*)()> punctualForms();   ///< point, spot and directional lights
std::vector<Form (*)()> areaForms();       ///< emitting polygons
std::vector<Form (*)()> coverageForms();   ///< what blends and masks let through; environments
std::vector<Form (*)()> materialForms();   ///< GGX
std::vector<Form (*)()> transportForms();  ///< light that was scattered more than once

}  // namespace weir::test::analytic
