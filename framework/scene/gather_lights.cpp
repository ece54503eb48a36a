#include <weir/core/error.h>
#include <weir/scene/emission_map.h>
#include <weir/scene/gather_lights.h>
#include <weir/scene/pose.h>
#include <weir/scene/scene_state.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace weir::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Gathered {
  std::vector<GpuLight> lights;
  std::vector<double> power;  // weights of the alias table; watts up to a common factor
  std::vector<MovingLight> moving;
};

void keep(Gathered& out, const GpuLight& light, double power) {
  if (!(power > 0.0)) return;
  out.lights.push_back(light);
  out.power.push_back(power);
}

/// An emissive triangle, and the instance that moves it (-1: none).
struct Emitter {
  uint32_t triangle;
  int instance;
};

std::vector<std::vector<Emitter>> emittersByMaterial(const PreparedScene& prepared) {
  std::vector<std::vector<Emitter>> result(prepared.materials.size());
  const auto gather = [&](const TriangleRange& range, int instance) {
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      const uint32_t material = prepared.triangles[t].material;
      if (prepared.materials[material].flags & kMaterialEmissive) result[material].push_back({t, instance});
    }
  };
  // Emissive meshes are merged (single-sided ones into range 0, double-sided ones into range 1), or they move and no
  // other instance shares their triangles.
  gather(prepared.ranges[0], -1);
  gather(prepared.ranges[1], -1);
  for (size_t i = 0; i < prepared.instances.size(); ++i)
    if (prepared.moves(prepared.instances[i]))
      gather(prepared.ranges[prepared.instances[i].range], static_cast<int>(i));
  return result;
}

/// How much of an emitter is there.
struct Coverage {
  float everywhere = 1.0f;  ///< one number for all of the triangle, unless it varies
  double mean = 1.0;        ///< an estimate, but 0 only if no place is covered
  bool varies = false;
};

/// Coverage of one material's triangles; as triangleCoverage() in shaders/common/scene.glsl.
class MaterialCoverage {
 public:
  MaterialCoverage(const Scene& scene, const PreparedScene& prepared, const PackedMaterial& material)
      : prepared_(prepared), material_(material), alpha_((material.flags & (kMaterialMask | kMaterialBlend)) != 0) {
    if (!alpha_ || material.baseColorTexture < 0) return;
    texture_ = prepared.textures[material.baseColorTexture];
    map_.emplace(scene.images[texture_.image], texture_.wrapS, texture_.wrapT, material.baseColor.a,
                 masked() ? std::optional(material.alphaCutoff) : std::nullopt);
  }

  Coverage of(const PackedTriangle& triangle) const {
    if (!alpha_) return {};
    std::array<float, 3> corner{1.0f, 1.0f, 1.0f};
    if (!prepared_.colors.empty())
      for (int k = 0; k < 3; ++k) corner[k] = static_cast<float>(prepared_.colors[triangle.v[k]].ba >> 16) / 65535.0f;
    if (!map_ && corner[0] == corner[1] && corner[0] == corner[2]) {
      const float all = covered(material_.baseColor.a * corner[0]);
      return {all, all, false};
    }
    // A mask's map can't know of the vertices' alpha, which lets it cover less, but never more.
    Coverage c{1.0f, 1.0, true};
    if (map_) {
      const auto uv = [&](int k) { return prepared_.textureUv(texture_, triangle.v[k]); };
      c.mean = map_->mean(uv(0), uv(1), uv(2));
    }
    if (map_ && masked()) return c;
    double corners = 0.0;
    for (const float a : corner) corners += map_ ? a : covered(material_.baseColor.a * a);
    c.mean *= corners / 3.0;
    return c;
  }

 private:
  bool masked() const { return (material_.flags & kMaterialMask) != 0; }
  float covered(float alpha) const {
    if (masked()) return alpha >= material_.alphaCutoff ? 1.0f : 0.0f;
    return std::clamp(alpha, 0.0f, 1.0f);
  }

  const PreparedScene& prepared_;
  const PackedMaterial& material_;
  bool alpha_;
  PreparedTexture texture_;
  std::optional<CoverageMap> map_;
};

void gatherTriangles(const Scene& scene, const PreparedScene& prepared, Gathered& out) {
  const std::vector<std::vector<Emitter>> perMaterial = emittersByMaterial(prepared);
  // Material by material, so that one summed-area table lives at a time.
  for (size_t m = 0; m < perMaterial.size(); ++m) {
    if (perMaterial[m].empty()) continue;
    const PackedMaterial& material = prepared.materials[m];
    std::unique_ptr<EmissionMap> map;
    PreparedTexture texture;
    if (material.emissiveTexture >= 0) {
      texture = prepared.textures[material.emissiveTexture];
      map = std::make_unique<EmissionMap>(scene.images[texture.image], texture.wrapS, texture.wrapT, material.emission);
    }
    const MaterialCoverage coverage(scene, prepared, material);
    const bool doubleSided = material.flags & kMaterialDoubleSided;
    for (const auto& [t, instance] : perMaterial[m]) {
      const auto& v = prepared.triangles[t].v;
      const Coverage covered = coverage.of(prepared.triangles[t]);
      GpuLight light;
      light.kind = static_cast<uint32_t>(GpuLightKind::Triangle) | (doubleSided ? kLightDoubleSided : 0u) |
                   (map ? kLightTextured : 0u) | (covered.varies ? kLightAlpha : 0u);
      light.triangle = t;
      light.radiance = material.emission * covered.everywhere;
      const bool hasArea =
          setTriangle(light, prepared.positions[v[0]], prepared.positions[v[1]], prepared.positions[v[2]]);
      const auto uv = [&](int k) { return prepared.textureUv(texture, v[k]); };
      const double mean =
          (map ? map->mean(uv(0), uv(1), uv(2)) : static_cast<double>(luminance(material.emission))) * covered.mean;
      const double radiosity = kPi * mean * (doubleSided ? 2.0 : 1.0);
      if (instance >= 0 && mean > 0.0) {
        out.moving.push_back({static_cast<uint32_t>(out.lights.size()), instance, -1, radiosity});
        out.lights.push_back(light);
        out.power.push_back(0.0);  // where it is at rest is known once all are there
      } else if (hasArea) {
        keep(out, light, radiosity * light.area);
      }
    }
  }
}

/// Kind, radiance and shape; returns the power. `radius` of the scene.
double setEmission(GpuLight& light, const PunctualLight& from, double radius) {
  light.radiance = from.intensity;
  const double power = luminance(from.intensity);
  switch (from.kind) {
    case LightKind::Point:
      light.kind = static_cast<uint32_t>(GpuLightKind::Point);
      light.b.z = from.range;
      return power * 4.0 * kPi;
    case LightKind::Spot: {
      light.kind = static_cast<uint32_t>(GpuLightKind::Spot);
      const double inner = std::cos(static_cast<double>(from.innerCone)),
                   outer = std::cos(static_cast<double>(from.outerCone));
      // The bound of 0.001 is KHR_lights_punctual's own.
      light.b = {static_cast<float>(1.0 / std::max(inner - outer, 0.001)), static_cast<float>(outer), from.range};
      // Over the solid angle, of the falloff t² with t linear in the cosine from 0 (outer) to 1 (inner).
      return power * 2.0 * kPi * ((1.0 - inner) + (inner - outer) / 3.0);
    }
    default:
      light.kind = static_cast<uint32_t>(GpuLightKind::Directional);
      return power * kPi * radius * radius;
  }
}

void gatherPunctual(const Scene& scene, const PreparedScene& prepared, const std::vector<char>& moving, Gathered& out) {
  out.lights.reserve(out.lights.size() + scene.lights.size() + 1);  // and an environment
  out.power.reserve(out.lights.capacity());
  for (const PunctualLight& from : scene.lights) {
    GpuLight light;
    const double power = setEmission(light, from, prepared.bounds.radius());
    setPunctual(light, from);
    if (power > 0.0 && from.node >= 0 && !moving.empty() && moving[from.node])
      out.moving.push_back(
          {static_cast<uint32_t>(out.lights.size()), -1, static_cast<int>(&from - scene.lights.data()), 0.0});
    keep(out, light, power);
  }
}

void gatherEnvironment(const PreparedScene& prepared, Gathered& out) {
  const double radius = prepared.bounds.radius();
  GpuLight light;
  light.kind = static_cast<uint32_t>(GpuLightKind::Environment);
  // Each direction is a directional light of radiance times steradian lux.
  keep(out, light, kPi * radius * radius * prepared.environment.integral);
}

void tabulateTriangles(PreparedScene& prepared) {
  uint32_t first = kNoLight, last = 0;
  for (uint32_t i = 0; i < prepared.triangleLights; ++i) {
    first = std::min(first, prepared.lights[i].triangle);
    last = std::max(last, prepared.lights[i].triangle);
  }
  if (prepared.triangleLights == 0) return;
  prepared.firstLitTriangle = first;
  prepared.lightOfTriangle.assign(size_t{last} - first + 1, kNoLight);
  for (uint32_t i = 0; i < prepared.triangleLights; ++i)
    prepared.lightOfTriangle[prepared.lights[i].triangle - first] = i;
}

}  // namespace

bool setTriangle(GpuLight& light, const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2) {
  light.position = p0;
  light.a = p1 - p0;
  light.b = p2 - p0;
  // The area of the triangle that shaders rebuild from the rounded edges.
  light.area = static_cast<float>(0.5 * glm::length(glm::cross(glm::dvec3(light.a), glm::dvec3(light.b))));
  if (light.area > 0.0f && std::isfinite(light.area)) return true;
  light.area = 0.0f;
  return false;
}

void setPunctual(GpuLight& light, const PunctualLight& from) {
  if (from.kind != LightKind::Directional) light.position = from.position;
  if (from.kind != LightKind::Point) light.a = from.direction;
}

std::vector<AliasCell> buildLightTable(const std::vector<double>& power, std::vector<GpuLight>& lights) {
  std::vector<AliasCell> table = buildAliasTable(power);
  if (table.empty() && !power.empty()) table = buildAliasTable(std::vector<double>(power.size(), 1.0));
  // What the table of floats really does, not what was asked of it: estimators divide by this.
  const std::vector<double> probabilities = aliasProbabilities(table);
  for (size_t i = 0; i < probabilities.size(); ++i) lights[i].pdf = static_cast<float>(probabilities[i]);
  return table;
}

void gatherLights(const Scene& scene, PreparedScene& prepared, const Clip* clip) {
  Gathered gathered;
  gatherTriangles(scene, prepared, gathered);
  for (const GpuLight& light : gathered.lights) {
    prepared.traits.texturedLights |= (light.kind & kLightTextured) != 0;
    prepared.traits.alphaLights |= (light.kind & kLightAlpha) != 0;
  }
  prepared.traits.triangleLights = !gathered.lights.empty();
  prepared.triangleLights = static_cast<uint32_t>(gathered.lights.size());
  const auto shaped = [](const GpuLight& light) {
    return light.kind != static_cast<uint32_t>(GpuLightKind::Point) || light.b.z > 0.0f;
  };
  gatherPunctual(scene, prepared, clip != nullptr ? movingNodes(scene, *clip) : std::vector<char>(), gathered);
  prepared.traits.shapedLights =
      std::any_of(gathered.lights.begin() + prepared.triangleLights, gathered.lights.end(), shaped);
  prepared.environment = tabulate(scene.environment);
  prepared.traits.environment = scene.environment.shines();
  gatherEnvironment(prepared, gathered);
  prepared.lights = std::move(gathered.lights);
  tabulateTriangles(prepared);
  if (gathered.moving.empty()) {
    prepared.aliasTable = buildLightTable(gathered.power, prepared.lights);
    return;
  }
  prepared.traits.animated = true;
  prepared.movingLights = std::move(gathered.moving);
  prepared.lightPower = std::move(gathered.power);
  SceneState rest = StateMaker(scene, prepared).at(restPose(scene));
  prepared.lights = std::move(rest.lights);
  prepared.aliasTable = std::move(rest.aliasTable);
}

void setLight(Scene& scene, PreparedScene& prepared, size_t index, const PunctualLight& to) {
  PunctualLight& from = scene.lights.at(index);
  const double radius = prepared.bounds.radius();
  GpuLight before, after;
  const double powerBefore = setEmission(before, from, radius), power = setEmission(after, to, radius);
  if (!(powerBefore > 0.0))
    throw InputError("light '" + from.name + "' was dark when the scene was loaded: it is in no table");
  if (!(power > 0.0) || !std::isfinite(power)) throw InputError("light '" + from.name + "' must emit something");
  if (after.kind != before.kind || (after.b.z > 0.0f && !prepared.traits.shapedLights))
    throw InputError("light '" + from.name + "' keeps its kind, and a range if it had one");
  // Dark lights are in no table, so an index there counts the others.
  size_t at = prepared.triangleLights;
  for (size_t i = 0; i < index; ++i) {
    GpuLight other;
    at += setEmission(other, scene.lights[i], radius) > 0.0 ? 1 : 0;
  }
  setPunctual(after, to);
  // What was asked of the table is known by what it gives; only ratios matter.
  std::vector<double> weights;
  weights.reserve(prepared.lights.size());
  for (const GpuLight& light : prepared.lights) weights.push_back(light.pdf);
  weights[at] *= power / powerBefore;
  if (!prepared.lightPower.empty()) prepared.lightPower[at] *= power / powerBefore;
  prepared.lights[at] = after;
  prepared.aliasTable = buildLightTable(weights, prepared.lights);
  from = to;
}

}  // namespace weir::scene
