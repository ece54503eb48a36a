#include "support/ray_oracle.h"

#include <weir/scene/packing.h>

#include <algorithm>
#include <cmath>

namespace weir::test {
namespace {

glm::dvec3 normaliseOr(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : otherwise;
}

struct Basis {
  glm::dvec3 forward, right, up;  // right and up reach to the picture's border
};

Basis basisOf(const scene::Camera& camera, uint32_t width, uint32_t height) {
  const glm::dvec3 forward(camera.forward);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double t = std::tan(static_cast<double>(camera.verticalFov) / 2.0);
  return {forward, right * (t * width / height), up * t};
}

}  // namespace

glm::dvec3 oracleDirection(const scene::Camera& camera, glm::dvec2 point, uint32_t width, uint32_t height) {
  const Basis b = basisOf(camera, width, height);
  const double x = 2.0 * point.x / width - 1.0, y = 1.0 - 2.0 * point.y / height;
  return glm::normalize(b.forward + x * b.right + y * b.up);
}

glm::dvec3 oracleProject(const scene::Camera& camera, glm::dvec3 position, uint32_t width, uint32_t height) {
  const Basis b = basisOf(camera, width, height);
  const glm::dvec3 d = position - glm::dvec3(camera.eye);
  const double z = glm::dot(d, b.forward) / glm::dot(b.forward, b.forward);
  const double x = glm::dot(d, b.right) / glm::dot(b.right, b.right) / z;
  const double y = glm::dot(d, b.up) / glm::dot(b.up, b.up) / z;
  return {(x + 1.0) * 0.5 * width, (1.0 - y) * 0.5 * height, z};
}

RayOracle::RayOracle(const scene::Scene& scene, const scene::PreparedScene& prepared)
    : scene_(scene), prepared_(prepared), textures_(scene, prepared) {
  for (uint32_t i = 0; i < prepared.instances.size(); ++i) {
    const scene::PreparedInstance& instance = prepared.instances[i];
    const scene::TriangleRange& range = prepared.ranges[instance.range];
    const glm::dmat4 world(instance.toWorld);
    const bool flips = glm::determinant(glm::dmat3(world)) < 0.0;
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      glm::dvec3 p[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = world * glm::dvec4(glm::dvec3(prepared.positions[prepared.triangles[t].v[k]]), 1.0);
      }
      triangles_.push_back({p[0], p[1] - p[0], p[2] - p[0], t, i, flips});
    }
  }
}

std::vector<OracleHit> RayOracle::crossings(glm::dvec3 origin, glm::dvec3 direction, double tMax) const {
  std::vector<OracleHit> hits;
  for (const Triangle& t : triangles_) {
    const glm::dvec3 h = glm::cross(direction, t.e2);
    const double determinant = glm::dot(t.e1, h);
    if (determinant == 0.0) continue;
    const glm::dvec3 s = origin - t.p;
    const double u = glm::dot(s, h) / determinant;
    if (u < 0.0 || u > 1.0) continue;
    const glm::dvec3 q = glm::cross(s, t.e1);
    const double v = glm::dot(direction, q) / determinant;
    if (v < 0.0 || u + v > 1.0) continue;
    const double distance = glm::dot(t.e2, q) / determinant;
    if (!(distance > 0.0) || distance >= tMax) continue;
    // The determinant is -(e1 × e2) · direction: positive where the ray meets the counter-clockwise side.
    hits.push_back({distance, t.triangle, t.instance, {u, v}, (determinant > 0.0) != t.flips});
  }
  std::ranges::sort(hits, {}, &OracleHit::distance);
  return hits;
}

const scene::PackedMaterial& RayOracle::material(const OracleHit& hit) const {
  return prepared_.materials[prepared_.triangles[hit.triangle].material];
}

OracleHit RayOracle::closest(glm::dvec3 origin, glm::dvec3 direction, bool cameraSides) const {
  for (const OracleHit& hit : crossings(origin, direction)) {
    if (cameraSides && !hit.front && (material(hit).flags & scene::kMaterialDoubleSided) == 0) continue;
    if (coverage(hit) > 0.0) return hit;
  }
  return {};
}

double RayOracle::transmittance(glm::dvec3 origin, glm::dvec3 direction, double tMax) const {
  double through = 1.0;
  for (const OracleHit& hit : crossings(origin, direction, tMax)) through *= 1.0 - coverage(hit);
  return through;
}

void RayOracle::seeThrough(const scene::Camera& camera, uint32_t width, uint32_t height, LevelRule rule) {
  camera_ = camera;
  width_ = width;
  height_ = height;
  rule_ = rule;
}

std::array<glm::dvec3, 3> RayOracle::corners(const OracleHit& hit) const {
  const glm::dmat4 world(prepared_.instances[hit.instance].toWorld);
  std::array<glm::dvec3, 3> p;
  for (size_t k = 0; k < 3; ++k) {
    p[k] = world * glm::dvec4(glm::dvec3(prepared_.positions[prepared_.triangles[hit.triangle].v[k]]), 1.0);
  }
  return p;
}

glm::dvec2 RayOracle::uv(int32_t index, uint32_t triangle, glm::dvec2 barycentrics) const {
  const scene::PreparedTexture& t = prepared_.textures[index];
  const auto& v = prepared_.triangles[triangle].v;
  const double w[3] = {1.0 - barycentrics.x - barycentrics.y, barycentrics.x, barycentrics.y};
  glm::dvec2 result(0.0);
  for (int k = 0; k < 3; ++k) {
    const scene::PackedVertex& vertex = prepared_.vertices[v[k]];
    result += w[k] * (t.uvSet == 0 ? glm::dvec2(vertex.u, vertex.v) : glm::dvec2(prepared_.uvs1[v[k]]));
  }
  return glm::dmat2(t.transform.linear) * result + glm::dvec2(t.transform.offset);
}

double RayOracle::level(int32_t index, const OracleHit& hit, glm::dvec3 direction) const {
  if (rule_ == LevelRule::Zero) return 0.0;
  const glm::dvec3 eye(camera_.eye);
  const glm::dvec3 pixel = oracleProject(camera_, eye + direction, width_, height_);
  const auto [p0, p1, p2] = corners(hit);
  const glm::dvec3 normal = glm::cross(p1 - p0, p2 - p0);
  const glm::dvec2 size(textures_.size(index));
  const auto through = [&](double dx, double dy) {
    return oracleDirection(camera_, glm::dvec2(pixel) + glm::dvec2(dx, dy), width_, height_);
  };
  if (rule_ == LevelRule::Cone) {
    // The pixel's solid angle as two spherical triangles (Van Oosterom and Strackee 1983).
    const auto solidAngle = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
      return 2.0 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                              1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    };
    const glm::dvec3 a = through(-0.5, -0.5), b = through(0.5, -0.5), c = through(0.5, 0.5), d = through(-0.5, 0.5);
    const double spread = std::sqrt(solidAngle(a, b, c) + solidAngle(a, c, d));
    const glm::dvec2 corner = uv(index, hit.triangle, {0, 0});
    const glm::dvec2 e1 = (uv(index, hit.triangle, {1, 0}) - corner) * size;
    const glm::dvec2 e2 = (uv(index, hit.triangle, {0, 1}) - corner) * size;
    const double texels = std::abs(e1.x * e2.y - e1.y * e2.x), area = glm::length(normal);
    return 0.5 * std::log2(texels / area) +
           std::log2(spread * hit.distance / std::abs(glm::dot(normal, direction) / area));
  }
  const auto texelAt = [&](double dx, double dy) {
    const glm::dvec3 d = through(dx, dy), p = eye + d * (glm::dot(normal, p0 - eye) / glm::dot(normal, d)) - p0;
    const double twice = glm::dot(normal, normal);
    return uv(index, hit.triangle,
              {glm::dot(normal, glm::cross(p, p2 - p0)) / twice, glm::dot(normal, glm::cross(p1 - p0, p)) / twice}) *
           size;
  };
  constexpr double kStep = 1e-3;  // pixels
  const glm::dvec2 x = (texelAt(kStep, 0) - texelAt(-kStep, 0)) / (2 * kStep);
  const glm::dvec2 y = (texelAt(0, kStep) - texelAt(0, -kStep)) / (2 * kStep);
  const double tilt = std::abs(glm::dot(normal, direction)) / glm::length(normal);
  return 0.5 * std::log2(std::abs(x.x * y.y - x.y * y.x) / tilt);
}

glm::dvec4 RayOracle::look(int32_t index, const OracleHit& hit, double level) const {
  return textures_.sample(index, uv(index, hit.triangle, hit.barycentrics), level);
}

glm::dvec4 RayOracle::color(const OracleHit& hit) const {
  if (prepared_.colors.empty()) return glm::dvec4(1.0);
  const double w[3] = {1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics.x, hit.barycentrics.y};
  glm::dvec4 sum(0.0);
  for (int k = 0; k < 3; ++k) {
    const scene::PackedColor c = prepared_.colors[prepared_.triangles[hit.triangle].v[k]];
    const glm::dvec4 stored = glm::dvec4(c.rg & 0xffffu, c.rg >> 16, c.ba & 0xffffu, c.ba >> 16) / 65535.0;
    sum += w[k] * glm::dvec4(glm::dvec3(stored) * glm::dvec3(stored), stored.a);
  }
  return sum;
}

double RayOracle::coverage(const OracleHit& hit) const {
  const scene::PackedMaterial& m = material(hit);
  double alpha = m.baseColor.a * color(hit).a;
  if (m.baseColorTexture >= 0) alpha *= look(m.baseColorTexture, hit, 0.0).a;
  if ((m.flags & scene::kMaterialMask) != 0) return alpha >= m.alphaCutoff ? 1.0 : 0.0;
  return (m.flags & scene::kMaterialBlend) != 0 ? std::clamp(alpha, 0.0, 1.0) : 1.0;
}

void RayOracle::reflect(const OracleHit& hit, glm::dvec3 direction, glm::dvec3 base, OracleSurface& s) const {
  const scene::PackedMaterial& m = material(hit);
  const auto seen = [&](int32_t texture) {
    return texture < 0 ? glm::dvec4(1.0) : look(texture, hit, level(texture, hit, direction));
  };
  if ((m.flags & scene::kMaterialUnlit) != 0) {
    s.diffuse = s.f0 = glm::dvec3(0.0);
    s.f90 = 0.0;
    s.roughness = 1.0;
    s.emission = base;
    return;
  }
  const scene::PackedSpecular specular = prepared_.speculars.empty()
                                             ? scene::PackedSpecular{}
                                             : prepared_.speculars[prepared_.triangles[hit.triangle].material];
  const glm::dvec4 tint = seen(specular.colorTexture);
  if ((m.flags & scene::kMaterialSpecularGlossiness) != 0) {
    s.f0 = glm::dvec3(specular.f0) * glm::dvec3(tint);
    s.diffuse = base * (1.0 - std::max({s.f0.x, s.f0.y, s.f0.z}));
    s.roughness = 1.0 - m.roughness * tint.a;
    return;
  }
  const glm::dvec4 mr = seen(m.metallicRoughnessTexture);
  const double metallic = m.metallic * mr.b, weight = specular.weight * seen(specular.weightTexture).a;
  s.roughness = m.roughness * mr.g;
  const glm::dvec3 dielectric = glm::min(glm::dvec3(specular.f0) * glm::dvec3(tint), 1.0) * weight;
  s.diffuse = base * (1.0 - metallic);
  s.f0 = glm::mix(dielectric, base, metallic);
  s.f90 = weight * (1.0 - metallic) + metallic;
}

OracleSurface RayOracle::surface(const OracleHit& hit, glm::dvec3 direction) const {
  const scene::PackedMaterial& m = material(hit);
  const glm::dmat4 world(prepared_.instances[hit.instance].toWorld);
  const glm::dmat3 linear(world);
  const bool mirrors = glm::determinant(linear) < 0.0;
  const auto& index = prepared_.triangles[hit.triangle].v;
  const double w[3] = {1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics.x, hit.barycentrics.y};
  OracleSurface s;
  glm::dvec3 corner[3], n(0.0), tangent(0.0);
  double bitangentSign = 1.0;
  for (int k = 0; k < 3; ++k) {
    corner[k] = world * glm::dvec4(glm::dvec3(prepared_.positions[index[k]]), 1.0);
    s.position += w[k] * corner[k];
    const scene::PackedVertex& vertex = prepared_.vertices[index[k]];
    n += w[k] * glm::dvec3(scene::unpackNormal(vertex.normal));
    const glm::vec4 t = scene::unpackTangent(vertex.tangent);
    tangent += w[k] * glm::dvec3(t);
    bitangentSign = t.w;
  }
  s.geometricNormal = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
  if (mirrors) s.geometricNormal = -s.geometricNormal;
  const bool front = glm::dot(s.geometricNormal, direction) < 0.0;

  const auto seen = [&](int32_t texture) { return look(texture, hit, level(texture, hit, direction)); };
  // All in object space, where the file's tangent frame is right-handed up to its sign; only then to the world.
  glm::dvec3 bent = n = glm::normalize(n);
  if (m.normalTexture >= 0) {
    tangent = normaliseOr(tangent - n * glm::dot(n, tangent), glm::dvec3(0.0));
    glm::dvec3 mapped = glm::dvec3(seen(m.normalTexture)) * 2.0 - 1.0;
    mapped.x *= m.normalScale;
    mapped.y *= m.normalScale;
    bent = tangent * mapped.x + glm::cross(n, tangent) * bitangentSign * mapped.y + n * mapped.z;
  }
  s.normal = glm::normalize(glm::transpose(glm::inverse(linear)) * bent);
  if (!front) {
    s.geometricNormal = -s.geometricNormal;
    s.normal = -s.normal;
  }
  const double facing = glm::dot(s.normal, direction);
  if (facing > 0.0) s.normal = glm::normalize(s.normal - 2.0 * facing * direction);

  if (front || (m.flags & scene::kMaterialDoubleSided) != 0) {
    s.emission = glm::dvec3(m.emission);
    if (m.emissiveTexture >= 0) s.emission *= glm::dvec3(seen(m.emissiveTexture));
  }
  glm::dvec3 base = glm::dvec3(m.baseColor) * glm::dvec3(color(hit));
  if (m.baseColorTexture >= 0) base *= glm::dvec3(seen(m.baseColorTexture));
  reflect(hit, direction, base, s);
  return s;
}

}  // namespace weir::test
