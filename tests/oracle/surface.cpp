#include "surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weir::oracle {
namespace {

constexpr double kPi = std::numbers::pi;
/// Weir's convention, not a law: no α below this, so that D stays finite for delta lights (docs/materials.md).
constexpr double kSmallestAlpha = 1.0 / 2048.0;

template <typename T>
T at(const std::array<T, 3>& corners, const glm::dvec3& b) {
  return corners[0] * b.x + corners[1] * b.y + corners[2] * b.z;
}

/// Textures at a point of a triangle, with the level that a cone asks for.
class Lookup {
 public:
  Lookup(const Triangle& t, const glm::dvec3& b) : triangle_(t), b_(b) {}
  /// λ = ½ log2(w h · uv area / area) + log2(γ t / |n·d|) (Akenine-Möller et al. 2021; docs/gltf.md).
  void widen(const Cone& cone, double distance, const glm::dvec3& cross, const glm::dvec3& direction) {
    wide_ = true;
    area_ = glm::length(cross);
    spread_ = std::log2(cone.angle * distance * area_ / std::abs(glm::dot(cross, direction)));
  }
  glm::dvec4 operator()(const Slot& slot) const {
    const std::array<glm::dvec2, 3>& uv = triangle_.uv[static_cast<size_t>(slot.set)];
    const glm::dvec2 place = at(uv, b_) * slot.scale + slot.offset;
    double level = 0;
    if (wide_) {
      const glm::dvec2 e1 = (uv[1] - uv[0]) * slot.scale, e2 = (uv[2] - uv[0]) * slot.scale;
      const double area = std::abs(e1.x * e2.y - e1.y * e2.x);
      if (area > 0) level = 0.5 * std::log2(slot.texture->texels() * area / area_) + spread_;
    }
    return slot.texture->at(place, level);
  }

 private:
  const Triangle& triangle_;
  glm::dvec3 b_;
  bool wide_ = false;
  double area_ = 0, spread_ = 0;
};

/// Whichever model, as diffuse colour, F0, F90 and roughness.
void reflect(const Material& m, const glm::dvec3& base, const Lookup& look, Surface& s) {
  double roughness = m.roughness;
  if (m.unlit) {
    s.diffuse = s.f0 = glm::dvec3(0);
    s.f90 = 0;
  } else if (m.glossy) {
    // KHR_materials_pbrSpecularGlossiness: c_diff = diffuse (1 - max(specular)), F0 = specular, α = (1 - glossiness)².
    s.f0 = m.specular;
    double glossiness = m.roughness;
    if (m.roughnessTexture) {
      const glm::dvec4 t = look(m.roughnessTexture);
      s.f0 *= glm::dvec3(t);
      glossiness *= t.a;
    }
    s.diffuse = base * (1.0 - std::max({s.f0.r, s.f0.g, s.f0.b}));
    roughness = 1.0 - glossiness;
  } else {
    double metallic = m.metallic;
    if (m.roughnessTexture) {
      const glm::dvec4 t = look(m.roughnessTexture);
      roughness *= t.g;
      metallic *= t.b;
    }
    double weight = m.specularWeight;
    glm::dvec3 colour = m.specular;
    if (m.specularTexture) weight *= look(m.specularTexture).a;
    if (m.specularColorTexture) colour *= glm::dvec3(look(m.specularColorTexture));
    const glm::dvec3 dielectric = glm::min(m.dielectricF0 * colour, glm::dvec3(1)) * weight;
    s.diffuse = base * (1.0 - metallic);
    s.f0 = glm::mix(dielectric, base, metallic);
    s.f90 = glm::mix(weight, 1.0, metallic);
  }
  s.alpha = std::max(roughness * roughness, kSmallestAlpha);
}

struct Basis {
  glm::dvec3 x, y, z;
  explicit Basis(const glm::dvec3& n) : z(n) {
    x = glm::normalize(glm::cross(std::abs(n.x) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), n));
    y = glm::cross(n, x);
  }
  glm::dvec3 toWorld(const glm::dvec3& v) const { return x * v.x + y * v.y + z * v.z; }
  glm::dvec3 toLocal(const glm::dvec3& v) const { return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)}; }
};

double distribution(double nh, double alpha) {
  // Trowbridge-Reitz; 1 - nh² is lost near the peak only below α = 1e-7.
  const double a2 = alpha * alpha, d = nh * nh * (a2 - 1.0) + 1.0;
  return nh > 0 ? a2 / (kPi * d * d) : 0.0;
}

/// Smith's Λ of GGX.
double lambda(double cosine, double alpha) {
  const double c2 = cosine * cosine;
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * std::max(0.0, 1.0 - c2) / c2) - 1.0);
}

glm::dvec3 fresnel(const Surface& s, double vh) {
  return s.f0 + (s.f90 - s.f0) * std::pow(std::clamp(1.0 - vh, 0.0, 1.0), 5.0);
}

/// Chance to sample the specular lobe. Where a half of the BSDF is black, the other has all.
double specularChance(const Surface& s) {
  const double specular = luminanceOf(fresnel(s, std::max(glm::dot(s.normal, s.view), 0.0)));
  const double diffuse = luminanceOf(s.diffuse);
  if (diffuse <= 0) return 1.0;
  return specular <= 0 ? 0.0 : std::clamp(specular / (specular + diffuse), 0.1, 0.9);
}

}  // namespace

double coverageAt(const Model& model, uint32_t triangle, const glm::dvec3& b) {
  const Triangle& t = model.triangles[triangle];
  const Material& m = model.materials[static_cast<size_t>(t.material)];
  if (m.alpha == Alpha::Opaque) return 1.0;
  double alpha = m.baseColor.a * at(t.color, b).a;
  if (m.baseTexture) alpha *= Lookup(t, b)(m.baseTexture).a;
  if (m.alpha == Alpha::Mask) return alpha >= m.cutoff ? 1.0 : 0.0;
  return std::clamp(alpha, 0.0, 1.0);
}

glm::dvec3 emissionAt(const Model& model, uint32_t triangle, const glm::dvec3& b, bool timesCoverage) {
  const Triangle& t = model.triangles[triangle];
  const Material& m = model.materials[static_cast<size_t>(t.material)];
  if (m.unlit || m.emission == glm::dvec3(0)) return glm::dvec3(0);
  glm::dvec3 e = m.emission;
  if (m.emissionTexture) e *= glm::dvec3(Lookup(t, b)(m.emissionTexture));
  return timesCoverage ? e * coverageAt(model, triangle, b) : e;
}

Surface surfaceAt(const Model& model, const Hit& hit, const glm::dvec3& direction, const std::optional<Cone>& cone) {
  const Triangle& t = model.triangles[hit.triangle];
  const Material& m = model.materials[static_cast<size_t>(t.material)];
  const glm::dvec3 b = hit.barycentrics;
  const glm::dvec3 cross = glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
  const bool front = glm::dot(cross, direction) < 0;
  const double side = front ? 1.0 : -1.0;
  Surface s;
  s.triangle = hit.triangle;
  s.position = at(t.position, b);
  s.geometric = glm::normalize(cross) * side;
  s.view = -direction;

  Lookup look(t, b);
  if (cone) look.widen(*cone, hit.distance, cross, direction);
  glm::dvec3 n = at(t.normal, b);
  n = glm::length(n) > 0 ? glm::normalize(n) : glm::normalize(cross);
  if (m.normalTexture) {
    const glm::dvec3 along(at(t.tangent, b));
    const glm::dvec3 flat = along - n * glm::dot(n, along);
    if (glm::length(flat) > 0) {
      const glm::dvec3 tangent = glm::normalize(flat), bitangent = glm::cross(n, tangent) * t.tangent[0].w;
      const glm::dvec3 map = glm::dvec3(look(m.normalTexture)) * 2.0 - 1.0;
      const glm::dvec3 bent = (tangent * map.x + bitangent * map.y) * m.normalScale + n * map.z;
      if (glm::length(bent) > 0) n = glm::normalize(bent);
    }
  }
  n *= side;
  // Kept from facing away from the viewer: mirrored at the plane across the view (a convention of Weir's).
  const double facing = glm::dot(n, s.view);
  s.normal = facing < 0 ? glm::normalize(n - 2.0 * facing * s.view) : n;

  glm::dvec3 base = glm::dvec3(m.baseColor) * glm::dvec3(at(t.color, b));
  if (m.baseTexture) base *= glm::dvec3(look(m.baseTexture));
  reflect(m, base, look, s);
  s.unlit = m.unlit;
  if (m.unlit) {
    s.emission = base;
  } else if (front || m.doubleSided) {
    s.emission = m.emission;
    if (m.emissionTexture) s.emission *= glm::dvec3(look(m.emissionTexture));
  }
  return s;
}

glm::dvec3 bsdfCos(const Surface& s, const glm::dvec3& l) {
  const double nl = glm::dot(s.normal, l), nv = glm::dot(s.normal, s.view);
  if (nl <= 0 || nv <= 0 || glm::dot(s.geometric, l) <= 0) return glm::dvec3(0);
  const glm::dvec3 h = glm::normalize(l + s.view);
  const glm::dvec3 f = fresnel(s, glm::dot(s.view, h));
  const double shadowing = 1.0 / (1.0 + lambda(nl, s.alpha) + lambda(nv, s.alpha));
  const double specular = distribution(glm::dot(s.normal, h), s.alpha) * shadowing / (4.0 * nl * nv);
  return ((1.0 - f) * s.diffuse / kPi + f * specular) * nl;
}

glm::dvec3 sampleBsdf(const Surface& s, const glm::dvec3& u) {
  const Basis basis(s.normal);
  const double turn = 2.0 * kPi * u.y;
  if (u.x >= specularChance(s)) {
    const double r = std::sqrt(u.z);
    return basis.toWorld({r * std::cos(turn), r * std::sin(turn), std::sqrt(1.0 - u.z)});
  }
  const glm::dvec3 v = basis.toLocal(s.view);
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(s.alpha * v.x, s.alpha * v.y, v.z));
  const double z = (1.0 - u.z) * (1.0 + stretched.z) - stretched.z, r = std::sqrt(std::clamp(1.0 - z * z, 0.0, 1.0));
  const glm::dvec3 c = glm::dvec3(r * std::cos(turn), r * std::sin(turn), z) + stretched;
  const glm::dvec3 h = basis.toWorld(glm::normalize(glm::dvec3(s.alpha * c.x, s.alpha * c.y, c.z)));
  return 2.0 * glm::dot(s.view, h) * h - s.view;
}

double densityOfBsdf(const Surface& s, const glm::dvec3& l) {
  const double nl = glm::dot(s.normal, l), nv = glm::dot(s.normal, s.view), chance = specularChance(s);
  const double diffuse = nl > 0 ? nl / kPi : 0.0;
  const glm::dvec3 sum = l + s.view;
  if (nv <= 0 || !(glm::length(sum) > 0)) return (1.0 - chance) * diffuse;
  const glm::dvec3 h = glm::normalize(sum);
  // Visible normals: G1(v) D(h) max(v·h, 0) / nv, times the Jacobian 1 / (4 v·h) of the reflection.
  const double visible = distribution(glm::dot(s.normal, h), s.alpha) / (1.0 + lambda(nv, s.alpha)) / (4.0 * nv);
  return (1.0 - chance) * diffuse + chance * visible;
}

}  // namespace weir::oracle
