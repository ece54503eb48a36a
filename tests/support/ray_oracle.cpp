#include "support/ray_oracle.h"

#include <weir/scene/packing.h>

#include <algorithm>
#include <cmath>

namespace weir::test {
namespace {

double srgbToLinear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Index of a texel after the sampler's wrap mode.
int64_t wrapped(int64_t i, int64_t size, scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::ClampToEdge:
      return std::clamp<int64_t>(i, 0, size - 1);
    case scene::Wrap::MirroredRepeat: {
      const int64_t m = ((i % (2 * size)) + 2 * size) % (2 * size);
      return m < size ? m : 2 * size - 1 - m;
    }
    default:
      return ((i % size) + size) % size;
  }
}

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
    : scene_(scene), prepared_(prepared) {
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

glm::dvec2 RayOracle::uv(const OracleHit& hit) const {
  const auto& v = prepared_.triangles[hit.triangle].v;
  const double w[3] = {1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics.x, hit.barycentrics.y};
  glm::dvec2 result(0.0);
  for (int k = 0; k < 3; ++k) result += w[k] * glm::dvec2(prepared_.vertices[v[k]].u, prepared_.vertices[v[k]].v);
  return result;
}

glm::dvec4 RayOracle::texture(int32_t index, glm::dvec2 uv) const {
  const scene::PreparedTexture& t = prepared_.textures[index];
  const scene::Image& image = scene_.images[t.image];
  const auto texel = [&](int64_t x, int64_t y) {
    const auto at =
        static_cast<size_t>(wrapped(y, image.height, t.wrapT) * image.width + wrapped(x, image.width, t.wrapS));
    glm::dvec4 c;
    for (int k = 0; k < 4; ++k) c[k] = image.rgba[4 * at + static_cast<size_t>(k)] / 255.0;
    if (t.srgb) {
      for (int k = 0; k < 3; ++k) c[k] = srgbToLinear(c[k]);
    }
    return c;
  };
  const glm::dvec2 p = uv * glm::dvec2(image.width, image.height);
  if (t.magFilter == scene::Filter::Nearest) {
    return texel(static_cast<int64_t>(std::floor(p.x)), static_cast<int64_t>(std::floor(p.y)));
  }
  const glm::dvec2 base = glm::floor(p - 0.5), f = p - 0.5 - base;
  const auto x = static_cast<int64_t>(base.x), y = static_cast<int64_t>(base.y);
  return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), f.x), glm::mix(texel(x, y + 1), texel(x + 1, y + 1), f.x),
                  f.y);
}

double RayOracle::coverage(const OracleHit& hit) const {
  const scene::PackedMaterial& m = material(hit);
  double alpha = m.baseColor.a;
  if (m.baseColorTexture >= 0) alpha *= texture(m.baseColorTexture, uv(hit)).a;
  if ((m.flags & scene::kMaterialMask) != 0) return alpha >= m.alphaCutoff ? 1.0 : 0.0;
  return (m.flags & scene::kMaterialBlend) != 0 ? std::clamp(alpha, 0.0, 1.0) : 1.0;
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

  const glm::dvec2 place = uv(hit);
  // All in object space, where the file's tangent frame is right-handed up to its sign; only then to the world.
  glm::dvec3 bent = n = glm::normalize(n);
  if (m.normalTexture >= 0) {
    tangent = normaliseOr(tangent - n * glm::dot(n, tangent), glm::dvec3(0.0));
    glm::dvec3 mapped = glm::dvec3(texture(m.normalTexture, place)) * 2.0 - 1.0;
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

  glm::dvec4 base(m.baseColor);
  if (m.baseColorTexture >= 0) base *= texture(m.baseColorTexture, place);
  double metallic = m.metallic;
  s.roughness = m.roughness;
  if (m.metallicRoughnessTexture >= 0) {
    const glm::dvec4 mr = texture(m.metallicRoughnessTexture, place);
    s.roughness *= mr.g;
    metallic *= mr.b;
  }
  s.diffuse = glm::dvec3(base) * (1.0 - metallic);
  s.f0 = glm::mix(glm::dvec3(0.04), glm::dvec3(base), metallic);
  if (front || (m.flags & scene::kMaterialDoubleSided) != 0) {
    s.emission = glm::dvec3(m.emission);
    if (m.emissiveTexture >= 0) s.emission *= glm::dvec3(texture(m.emissiveTexture, place));
  }
  return s;
}

}  // namespace weir::test
