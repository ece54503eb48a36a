#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace weir::test::oracle {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Half a bit below the layout's floor for a mirror: α is never smaller than 1/2048.
constexpr double kSmallestAlpha = 1.0 / 2048.0;

/// Smith's Λ for GGX (Heitz 2014, equation 72) from the cosine.
double smithLambda(double cosine, double alpha) {
  const double tangent2 = (1.0 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
}

double snorm(uint32_t bits) {
  return std::max(static_cast<int16_t>(bits & 0xffffu) / 32767.0, -1.0);
}

}  // namespace

double luminance(const Vec& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

Vec normalOf(uint32_t bits) {
  Vec n(snorm(bits), snorm(bits >> 16), 0.0);
  n.z = 1.0 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0.0) {
    const double x = n.x;
    n.x = (1.0 - std::abs(n.y)) * (x < 0.0 ? -1.0 : 1.0);
    n.y = (1.0 - std::abs(x)) * (n.y < 0.0 ? -1.0 : 1.0);
  }
  return glm::normalize(n);
}

Vec albedoOf(uint32_t bits) {
  const Vec s((bits & 2047u) / 2047.0, (bits >> 11 & 2047u) / 2047.0, (bits >> 22) / 1023.0);
  return s * s;
}

uint32_t albedoBits(const Vec& albedo) {
  const Vec s = glm::sqrt(albedo);
  return static_cast<uint32_t>(std::lround(s.x * 2047.0)) | static_cast<uint32_t>(std::lround(s.y * 2047.0)) << 11 |
         static_cast<uint32_t>(std::lround(s.z * 1023.0)) << 22;
}

Vec direction(const scene::Camera& camera, double x, double y, uint32_t width, uint32_t height) {
  const double up = std::tan(0.5 * static_cast<double>(camera.verticalFov));
  const double right = up * width / height;
  const Vec forward(camera.forward), upwards(camera.up);
  const Vec sideways = glm::cross(forward, upwards);
  return glm::normalize(forward + (2.0 * x / width - 1.0) * right * sideways + (1.0 - 2.0 * y / height) * up * upwards);
}

Surface unpack(const passes::PackedSurface& packed, uint32_t x, uint32_t y, const scene::Camera& camera, uint32_t width,
               uint32_t height) {
  const double jitterX = ((packed.roughnessJitter & 255u) + 0.5) / 255.0;
  const double jitterY = ((packed.roughnessJitter >> 8 & 255u) + 0.5) / 255.0;
  const Vec ray = direction(camera, x + jitterX, y + jitterY, width, height);
  Surface s;
  s.distance = packed.distance;
  s.position = Vec(camera.eye) + s.distance * ray;
  s.view = -ray;
  s.geometric = normalOf(packed.geometricNormal);
  s.normal = normalOf(packed.shadingNormal);
  s.diffuse = albedoOf(packed.diffuse);
  s.f0 = albedoOf(packed.specular);
  s.roughness = (packed.roughnessJitter >> 16) / 65535.0;
  return s;
}

Vec bsdfCos(const Surface& s, const Vec& l) {
  const double nl = glm::dot(s.normal, l), nv = glm::dot(s.normal, s.view);
  if (nl <= 0.0 || glm::dot(s.geometric, l) <= 0.0) return Vec(0.0);
  const Vec h = glm::normalize(l + s.view);
  const Vec fresnel = s.f0 + (1.0 - s.f0) * std::pow(1.0 - std::abs(glm::dot(s.view, h)), 5.0);
  const Vec diffuse = (1.0 - fresnel) * s.diffuse / kPi;
  if (nv <= 0.0) return diffuse * nl;
  const double alpha = std::max(s.roughness * s.roughness, kSmallestAlpha);
  const double nh = glm::dot(s.normal, h);
  const double d = nh * nh * (alpha * alpha - 1.0) + 1.0;
  const double distribution = alpha * alpha / (kPi * d * d);
  const double shadowing = 1.0 / (1.0 + smithLambda(nl, alpha) + smithLambda(nv, alpha));
  return (diffuse + fresnel * (distribution * shadowing / (4.0 * nl * nv))) * nl;
}

glm::dvec2 barycentrics(double u, double v) {
  if (u + v > 1.0) return {1.0 - v, 1.0 - u};
  return {u, v};
}

glm::dvec2 barycentrics(uint32_t place) {
  return barycentrics(((place & 0xffffu) + 0.5) / 65536.0, ((place >> 16) + 0.5) / 65536.0);
}

World::World(const scene::PreparedScene& prepared) : lights_(prepared.lights) {
  for (const scene::PackedTriangle& t : prepared.triangles) {
    triangles_.push_back(
        {Vec(prepared.positions[t.v[0]]), Vec(prepared.positions[t.v[1]]), Vec(prepared.positions[t.v[2]])});
    const scene::PackedMaterial& m = prepared.materials[t.material];
    through_.push_back((m.flags & scene::kMaterialBlend) != 0 ? 1.0 - static_cast<double>(m.baseColor.a) : 0.0);
  }
}

bool World::isTriangle(uint32_t light) const {
  return (lights_[light].kind & 0xffu) == static_cast<uint32_t>(scene::GpuLightKind::Triangle);
}

double World::area(uint32_t light) const {
  if (!isTriangle(light)) return 1.0;
  return 0.5 * glm::length(glm::cross(Vec(lights_[light].a), Vec(lights_[light].b)));
}

Arriving World::arriving(uint32_t index, const glm::dvec2& b, const Vec& position) const {
  const scene::GpuLight& light = lights_[index];
  const Vec radiance(light.radiance), a(light.a), second(light.b);
  const auto kind = static_cast<scene::GpuLightKind>(light.kind & 0xffu);
  if (kind == scene::GpuLightKind::Directional) return {-a, radiance, position - a * 1e4};
  Vec target(light.position);
  if (kind == scene::GpuLightKind::Triangle) target += b.x * a + b.y * second;
  const Vec d = target - position;
  const double distance2 = glm::dot(d, d);
  const Vec towards = d / std::sqrt(distance2);
  double factor = 1.0 / distance2;
  if (kind == scene::GpuLightKind::Triangle) {
    double cosine = -glm::dot(glm::normalize(glm::cross(a, second)), towards);
    if ((light.kind & scene::kLightDoubleSided) != 0) cosine = std::abs(cosine);
    factor *= std::max(cosine, 0.0);
  } else {
    // KHR_lights_punctual: "range" and "inner and outer cone angles".
    if (second.z > 0.0) factor *= std::max(std::min(1.0 - std::pow(std::sqrt(distance2) / second.z, 4.0), 1.0), 0.0);
    if (kind == scene::GpuLightKind::Spot) {
      const double t = std::clamp((glm::dot(a, -towards) - second.y) * second.x, 0.0, 1.0);
      factor *= t * t;
    }
  }
  return {towards, radiance * factor, target};
}

Vec World::contribution(const Surface& surface, uint32_t light, uint32_t place) const {
  const Arriving arrives = arriving(light, barycentrics(place), surface.position);
  return bsdfCos(surface, arrives.direction) * arrives.radiance;
}

double World::target(const Surface& surface, uint32_t light, uint32_t place) const {
  return luminance(contribution(surface, light, place));
}

double World::transmittance(const Vec& from, const Vec& to) const {
  const Vec d = to - from;
  double through = 1.0;
  for (size_t i = 0; i < triangles_.size(); ++i) {
    const auto& t = triangles_[i];
    // Möller and Trumbore 1997.
    const Vec e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(d, e2);
    const double determinant = glm::dot(e1, p);
    if (determinant == 0.0) continue;
    const Vec s = from - t[0], q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(d, q) / determinant;
    const double along = glm::dot(e2, q) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along > 1e-5 && along < 1.0 - 1e-5) through *= through_[i];
  }
  return through;
}

double World::transmittance(const Surface& surface, uint32_t light, uint32_t place) const {
  return transmittance(surface.position, arriving(light, barycentrics(place), surface.position).target);
}

bool World::sees(const Surface& surface, uint32_t light, uint32_t place) const {
  return visible(surface.position, arriving(light, barycentrics(place), surface.position).target);
}

double World::directLight(const Surface& surface, bool shadows, int strata) const {
  double sum = 0.0;
  for (uint32_t i = 0; i < lights_.size(); ++i) {
    const int n = isTriangle(i) ? strata : 1;
    double light = 0.0;
    for (int j = 0; j < n * n; ++j) {
      const Arriving a = arriving(i, barycentrics((j % n + 0.5) / n, (j / n + 0.5) / n), surface.position);
      const double f = luminance(bsdfCos(surface, a.direction) * a.radiance);
      if (f > 0.0) light += shadows ? f * transmittance(surface.position, a.target) : f;
    }
    sum += light * area(i) / (n * n);
  }
  return sum;
}

passes::Reservoir World::sample(const Surface& surface, Random& random, int candidates, bool visibility,
                                double confidence) const {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  passes::Reservoir r{0, 0, 0.0f, static_cast<float>(confidence)};
  double sum = 0.0, chosen = 0.0;
  for (int i = 0; i < candidates; ++i) {
    const auto light = static_cast<uint32_t>(random() % lights_.size());
    const auto place = static_cast<uint32_t>(random());
    const double p = target(surface, light, place);
    const double weight = p * area(light) * static_cast<double>(lights_.size()) / candidates;
    sum += weight;
    if (weight > 0.0 && uniform(random) * sum < weight) {
      r.light = light;
      r.place = place;
      chosen = p;
    }
  }
  if (!(sum > 0.0) || (visibility && !sees(surface, r.light, r.place))) return {0, 0, 0.0f, r.confidence};
  r.weight = static_cast<float>(sum / chosen);
  return r;
}

const char* nameOf(Mis mis) {
  switch (mis) {
    case Mis::Biased:
      return "biased";
    case Mis::Z:
      return "z";
    case Mis::Balance:
      return "balance";
    case Mis::Pairwise:
      return "pairwise";
  }
  return "";
}

double misWeight(const std::vector<MergeInput>& inputs, size_t i, Mis mis) {
  const std::vector<double>& p = inputs[i].targets;
  const auto confidence = [&](size_t j) { return inputs[j].confidence; };
  const auto contains = [&](size_t j) {
    return p[j] > 0.0 && p[j] >= (confidence(0) > 0.0 ? kZThreshold * p[0] : 0.0);
  };
  double total = 0.0, containing = 0.0, balance = 0.0;
  for (size_t j = 0; j < inputs.size(); ++j) {
    total += confidence(j);
    if (contains(j)) containing += confidence(j);
    balance += confidence(j) * p[j];
  }
  const double own = confidence(0), others = total - own;
  switch (mis) {
    case Mis::Biased:
      return confidence(i) / total;
    case Mis::Z:
      return contains(i) ? confidence(i) / containing : 0.0;
    case Mis::Balance:
      return confidence(i) * p[i] / balance;
    case Mis::Pairwise:
      break;
  }
  if (i > 0) return confidence(i) / total * others * p[i] / (own * p[0] + others * p[i]);
  double m = own / total;
  for (size_t j = 1; j < inputs.size(); ++j) m += confidence(j) / total * own * p[0] / (own * p[0] + others * p[j]);
  return m;
}

Merged merge(const std::vector<MergeInput>& inputs, Mis mis) {
  Merged result;
  for (const MergeInput& i : inputs) result.confidence += i.confidence;
  std::vector<double> part;  // of the sum that goes into W
  for (size_t i = 0; i < inputs.size(); ++i) {
    const bool is = inputs[i].weight > 0.0 && inputs[i].targets[0] > 0.0;
    const double m = is ? misWeight(inputs, i, mis) : 0.0;
    const double chosenBy = mis == Mis::Z ? inputs[i].confidence : m;
    part.push_back(mis == Mis::Z ? m / inputs[i].confidence : 1.0);
    result.probability.push_back(is ? chosenBy * inputs[i].targets[0] * inputs[i].weight : 0.0);
    result.sum += result.probability.back();
  }
  for (size_t i = 0; i < inputs.size(); ++i) {
    result.weight.push_back(result.probability[i] > 0.0 ? part[i] * result.sum / inputs[i].targets[0] : 0.0);
    result.probability[i] = result.sum > 0.0 ? result.probability[i] / result.sum : 0.0;
  }
  return result;
}

}  // namespace weir::test::oracle
