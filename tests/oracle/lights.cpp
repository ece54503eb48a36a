#include "lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir::oracle {
namespace {

glm::dvec3 areaVector(const Triangle& t) {  // length: twice the area
  return glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
}

glm::dvec3 onTriangle(const glm::dvec2& u) {  // uniform: Osada et al. 2002
  const double r = std::sqrt(u.x);
  return {1.0 - r, r * (1.0 - u.y), r * u.y};
}

}  // namespace

void generateLights(Model& model, uint32_t count, uint32_t seed) {
  for (Material& m : model.materials) m.emission = glm::dvec3(0);
  model.lights.clear();
  const auto x = [&](uint32_t i, uint32_t d) {
    return static_cast<double>(mixed(mixed(mixed(seed) ^ i) + d) >> 40) * 0x1p-24;
  };
  const glm::dvec3 size = model.high - model.low;
  double total = 0;
  for (uint32_t i = 0; i < count; ++i) {
    PunctualLight light;
    light.position = model.low + size * glm::dvec3(x(i, 0), x(i, 1), x(i, 2));
    light.intensity = {x(i, 3), x(i, 4), x(i, 5)};
    total += luminanceOf(light.intensity);
    model.lights.push_back(light);
  }
  const double radius = glm::length(size) / 2;
  for (PunctualLight& light : model.lights) light.intensity *= 10.0 * radius * radius / total;
}

Arrival arrivalFrom(const PunctualLight& light, const glm::dvec3& position) {
  Arrival a;
  if (light.kind == PunctualLight::Kind::Directional) {
    a.direction = -light.direction;
    a.irradiance = light.intensity;
    a.distance = std::numeric_limits<double>::infinity();
    return a;
  }
  const glm::dvec3 way = light.position - position;
  a.distance = glm::length(way);
  if (!(a.distance > 0)) return a;
  a.direction = way / a.distance;
  double share = 1.0 / (a.distance * a.distance);
  if (light.range > 0) share *= std::clamp(1.0 - std::pow(a.distance / light.range, 4.0), 0.0, 1.0);
  if (light.kind == PunctualLight::Kind::Spot) {
    const double inner = std::cos(light.innerCone), outer = std::cos(light.outerCone);
    const double t = (glm::dot(-a.direction, light.direction) - outer) / std::max(inner - outer, 0.001);
    share *= std::pow(std::clamp(t, 0.0, 1.0), 2.0);
  }
  a.irradiance = light.intensity * share;
  return a;
}

AreaLights::AreaLights(const Model& model) : model_(model), perArea_(model.triangles.size(), 0.0) {
  double total = 0;
  std::vector<double> powers;
  for (uint32_t i = 0; i < model.triangles.size(); ++i) {
    const Triangle& t = model.triangles[i];
    const Material& m = model.materials[static_cast<size_t>(t.material)];
    if (m.unlit || m.emission == glm::dvec3(0)) continue;
    // A textured one by its mean at some points. One that they miss is found by directions from the BSDF alone.
    Random random(i);
    const int points = m.emissionTexture ? 64 : 1;
    double mean = 0;
    for (int k = 0; k < points; ++k)
      mean += luminanceOf(emissionAt(model, i, onTriangle(random.next2()), true)) / points;
    const double area = glm::length(areaVector(t)) / 2;
    if (!(mean * area > 0)) continue;
    triangles_.push_back(i);
    powers.push_back(mean * area);
    total += powers.back();
  }
  double sum = 0;
  for (size_t k = 0; k < triangles_.size(); ++k) {
    sum += powers[k] / total;
    upTo_.push_back(sum);
    perArea_[triangles_[k]] = powers[k] / total / (glm::length(areaVector(model.triangles[triangles_[k]])) / 2);
  }
  if (!upTo_.empty()) upTo_.back() = 1.0;
}

AreaSample AreaLights::sample(const glm::dvec3& from, Random& random) const {
  const auto found = std::ranges::upper_bound(upTo_, random.next());
  AreaSample s;
  s.triangle = triangles_[static_cast<size_t>(found - upTo_.begin())];
  const Triangle& t = model_.triangles[s.triangle];
  const glm::dvec3 b = onTriangle(random.next2());
  s.position = t.position[0] * b.x + t.position[1] * b.y + t.position[2] * b.z;
  const glm::dvec3 way = s.position - from;
  s.distance = glm::length(way);
  if (!(s.distance > 0)) return s;
  s.direction = way / s.distance;
  const double cosine = -glm::dot(glm::normalize(areaVector(t)), s.direction);
  const bool shines = cosine > 0 || (cosine < 0 && model_.materials[static_cast<size_t>(t.material)].doubleSided);
  if (!shines) return s;
  s.radiance = emissionAt(model_, s.triangle, b, true);
  s.density = perArea_[s.triangle] * s.distance * s.distance / std::abs(cosine);
  return s;
}

double AreaLights::density(const Hit& hit, const glm::dvec3& from, const glm::dvec3& direction) const {
  const Triangle& t = model_.triangles[hit.triangle];
  const double cosine = std::abs(glm::dot(glm::normalize(areaVector(t)), direction));
  const glm::dvec3& b = hit.barycentrics;
  const glm::dvec3 at = t.position[0] * b.x + t.position[1] * b.y + t.position[2] * b.z;
  return cosine > 0 ? perArea_[hit.triangle] * glm::dot(at - from, at - from) / cosine : 0.0;
}

}  // namespace weir::oracle
