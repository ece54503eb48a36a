#include <weir/scene/emission_map.h>
#include <weir/scene/gather_lights.h>

#include <cmath>
#include <memory>

namespace weir::scene {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Gathered {
  std::vector<GpuLight> lights;
  std::vector<double> power;  // weights of the alias table; watts up to a common factor
};

void keep(Gathered& out, const GpuLight& light, double power) {
  if (!(power > 0.0)) return;
  out.lights.push_back(light);
  out.power.push_back(power);
}

void gatherTriangles(const Scene& scene, const PreparedScene& prepared, Gathered& out) {
  std::vector<std::vector<uint32_t>> perMaterial(prepared.materials.size());
  // Emissive meshes are always merged: single-sided ones into range 0, double-sided ones into range 1.
  for (const TriangleRange& range : {prepared.ranges[0], prepared.ranges[1]}) {
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      const uint32_t material = prepared.triangles[t].material;
      if (prepared.materials[material].flags & kMaterialEmissive) perMaterial[material].push_back(t);
    }
  }
  // Material by material, so that one summed-area table lives at a time.
  for (size_t m = 0; m < perMaterial.size(); ++m) {
    if (perMaterial[m].empty()) continue;
    const PackedMaterial& material = prepared.materials[m];
    std::unique_ptr<EmissionMap> map;
    if (material.emissiveTexture >= 0) {
      const PreparedTexture& texture = prepared.textures[material.emissiveTexture];
      map = std::make_unique<EmissionMap>(scene.images[texture.image], texture.wrapS, texture.wrapT, material.emission);
    }
    const bool doubleSided = material.flags & kMaterialDoubleSided;
    for (uint32_t t : perMaterial[m]) {
      const auto& v = prepared.triangles[t].v;
      GpuLight light;
      light.kind = static_cast<uint32_t>(GpuLightKind::Triangle) | (doubleSided ? kLightDoubleSided : 0u) |
                   (map ? kLightTextured : 0u);
      light.position = prepared.positions[v[0]];
      light.a = prepared.positions[v[1]] - light.position;
      light.b = prepared.positions[v[2]] - light.position;
      light.triangle = t;
      // The area of the triangle that shaders rebuild from the rounded edges.
      const double area = 0.5 * glm::length(glm::cross(glm::dvec3(light.a), glm::dvec3(light.b)));
      light.area = static_cast<float>(area);
      light.radiance = material.emission;
      if (!(light.area > 0.0f) || !std::isfinite(light.area)) continue;
      const auto uv = [&](int k) { return glm::vec2(prepared.vertices[v[k]].u, prepared.vertices[v[k]].v); };
      const double mean = map ? map->mean(uv(0), uv(1), uv(2)) : luminance(material.emission);
      keep(out, light, kPi * area * mean * (doubleSided ? 2.0 : 1.0));
    }
  }
}

void gatherPunctual(const Scene& scene, const PreparedScene& prepared, Gathered& out) {
  const double radius = prepared.bounds.radius();
  for (const PunctualLight& from : scene.lights) {
    GpuLight light;
    light.radiance = from.intensity;
    light.position = from.position;
    double power = luminance(from.intensity);
    switch (from.kind) {
      case LightKind::Point:
        light.kind = static_cast<uint32_t>(GpuLightKind::Point);
        light.b.z = from.range;
        power *= 4.0 * kPi;
        break;
      case LightKind::Spot: {
        light.kind = static_cast<uint32_t>(GpuLightKind::Spot);
        light.a = from.direction;
        const double inner = std::cos(static_cast<double>(from.innerCone)),
                     outer = std::cos(static_cast<double>(from.outerCone));
        // The bound of 0.001 is KHR_lights_punctual's own.
        light.b = {static_cast<float>(1.0 / std::max(inner - outer, 0.001)), static_cast<float>(outer), from.range};
        // Over the solid angle, of the falloff t² with t linear in the cosine from 0 (outer) to 1 (inner).
        power *= 2.0 * kPi * ((1.0 - inner) + (inner - outer) / 3.0);
        break;
      }
      case LightKind::Directional:
        light.kind = static_cast<uint32_t>(GpuLightKind::Directional);
        light.position = glm::vec3(0.0f);
        light.a = from.direction;
        power *= kPi * radius * radius;
        break;
    }
    keep(out, light, power);
  }
}

}  // namespace

void gatherLights(const Scene& scene, PreparedScene& prepared) {
  Gathered gathered;
  gatherTriangles(scene, prepared, gathered);
  for (const GpuLight& light : gathered.lights) {
    prepared.traits.texturedLights |= (light.kind & kLightTextured) != 0;
  }
  prepared.triangleLights = static_cast<uint32_t>(gathered.lights.size());
  gatherPunctual(scene, prepared, gathered);
  prepared.aliasTable = buildAliasTable(gathered.power);
  // What the table of floats really does, not what was asked of it: estimators divide by this.
  const std::vector<double> probabilities = aliasProbabilities(prepared.aliasTable);
  for (size_t i = 0; i < probabilities.size(); ++i) gathered.lights[i].pdf = static_cast<float>(probabilities[i]);
  prepared.lights = std::move(gathered.lights);
}

}  // namespace weir::scene
