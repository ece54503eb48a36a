#include <weir/core/parallel.h>
#include <weir/scene/gather_lights.h>
#include <weir/scene/geometry_range.h>
#include <weir/scene/prepare_materials.h>
#include <weir/scene/prepared.h>
#include <weir/scene/spatial_sort.h>
#include <weir/scene/tangent_space.h>

#include <algorithm>
#include <array>
#include <unordered_map>

namespace weir::scene {
namespace {

/// The importer's -1 is the default material, which is packed last.
uint32_t packedIndex(const PreparedScene& prepared, const Primitive& primitive) {
  return primitive.material >= 0 ? static_cast<uint32_t>(primitive.material)
                                 : static_cast<uint32_t>(prepared.materials.size() - 1);
}

bool isInstanced(const Scene& scene, const Mesh& mesh, uint64_t uses, const PrepareLimits& limits) {
  uint64_t triangles = 0;
  for (const Primitive& primitive : mesh.primitives) {
    triangles += primitive.indices.size() / 3;
    if (primitive.material >= 0 && scene.materials[primitive.material].isEmissive()) return false;
  }
  return uses >= limits.mergeUses && uses * triangles > limits.mergeTriangles;
}

/// Where each vertex of a primitive reads a texture; empty: the primitive has no such coordinates.
std::vector<glm::vec2> coordinatesOf(const Primitive& primitive, const PreparedTexture& texture) {
  std::vector<glm::vec2> uvs = texture.uvSet == 1 ? primitive.uv1 : primitive.uv0;
  if (!texture.transform.isIdentity())
    for (glm::vec2& uv : uvs) uv = texture.transform(uv);
  return uvs;
}

/// Tangents of the primitives that lack them although their material has a normal map; once for all their instances.
class MissingTangents {
 public:
  MissingTangents(const Scene& scene, const PreparedScene& prepared, const std::vector<size_t>& uses) {
    std::vector<std::pair<const Primitive*, std::vector<glm::vec4>*>> work;
    for (size_t m = 0; m < scene.meshes.size(); ++m)
      for (const Primitive& primitive : scene.meshes[m].primitives) {
        const size_t count = primitive.positions.size();
        const bool given = primitive.normals.size() == count && primitive.tangents.size() == count;
        if (uses[m] > 0 && !given && prepared.materials[packedIndex(prepared, primitive)].normalTexture >= 0)
          work.emplace_back(&primitive, &tangents_[&primitive]);
      }
    parallelFor(work.size(), [&](size_t i) {
      const Primitive& p = *work[i].first;
      const PreparedTexture& map = prepared.textures[prepared.materials[packedIndex(prepared, p)].normalTexture];
      *work[i].second = cornerTangents(p.positions, p.normals, coordinatesOf(p, map), p.indices);
    });
  }
  /// Empty for any other primitive.
  std::span<const glm::vec4> of(const Primitive& primitive) const {
    const auto found = tangents_.find(&primitive);
    return found == tangents_.end() ? std::span<const glm::vec4>() : std::span<const glm::vec4>(found->second);
  }

 private:
  std::unordered_map<const Primitive*, std::vector<glm::vec4>> tangents_;
};

/// Geometry that goes into two ranges, by the sides of its materials.
class SidedRanges {
 public:
  SidedRanges(const PreparedScene& prepared, const MissingTangents& tangents)
      : materials_(prepared.materials),
        tangents_(tangents),
        ranges_{GeometryRange(prepared), GeometryRange(prepared)} {}
  void add(const Primitive& primitive, uint32_t material, const glm::dmat4& transform) {
    const size_t side = (materials_[material].flags & kMaterialDoubleSided) != 0 ? 1 : 0;
    ranges_[side].add(primitive, material, transform, tangents_.of(primitive));
  }
  /// Appends both ranges, empty or not; their numbers.
  std::array<uint32_t, 2> finish(PreparedScene& prepared) {
    std::array<uint32_t, 2> numbers{};
    for (size_t side = 0; side < 2; ++side) {
      numbers[side] = static_cast<uint32_t>(prepared.ranges.size());
      ranges_[side].finish(prepared);
      prepared.ranges.back().doubleSided = side == 1;
    }
    return numbers;
  }

 private:
  const std::vector<PackedMaterial>& materials_;
  const MissingTangents& tangents_;
  std::array<GeometryRange, 2> ranges_;
};

Bounds rangeBounds(const PreparedScene& prepared, const TriangleRange& range, const glm::dmat4& toWorld) {
  Bounds bounds;
  for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t)
    for (uint32_t v : prepared.triangles[t].v)
      bounds.add(glm::vec3(toWorld * glm::dvec4(glm::dvec3(prepared.positions[v]), 1.0)));
  return bounds;
}

void placeInstances(const std::vector<PreparedInstance>& unsorted, PreparedScene& prepared) {
  std::vector<SortItem> items;
  for (const PreparedInstance& instance : unsorted) {
    const Bounds bounds = rangeBounds(prepared, prepared.ranges[instance.range], glm::dmat4(instance.toWorld));
    if (bounds.empty) continue;
    items.push_back({bounds.low, bounds.high, static_cast<uint32_t>(&instance - unsorted.data())});
    prepared.bounds.add(bounds.low);
    prepared.bounds.add(bounds.high);
  }
  spatialSort(items);
  for (const SortItem& item : items) prepared.instances.push_back(unsorted[item.index]);
}

}  // namespace

PreparedScene prepareScene(const Scene& scene, const PrepareLimits& limits) {
  PreparedScene prepared;
  prepareMaterials(scene, prepared);
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) prepared.traits.vertexColors |= !primitive.colors.empty();

  std::vector<size_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++uses[instance.mesh];
  std::vector<char> instanced(scene.meshes.size(), 0);
  for (size_t m = 0; m < scene.meshes.size(); ++m) instanced[m] = isInstanced(scene, scene.meshes[m], uses[m], limits);

  const MissingTangents tangents(scene, prepared, uses);
  SidedRanges merged(prepared, tangents);
  for (const Instance& instance : scene.instances)
    if (!instanced[instance.mesh])
      for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
        merged.add(primitive, packedIndex(prepared, primitive), glm::dmat4(instance.toWorld));
  for (uint32_t range : merged.finish(prepared)) {
    const Bounds bounds = rangeBounds(prepared, prepared.ranges[range], glm::dmat4(1.0));
    if (bounds.empty) continue;
    prepared.instances.push_back({range, glm::mat4(1.0f), false});
    prepared.bounds.add(bounds.low);
    prepared.bounds.add(bounds.high);
  }

  std::vector<std::array<uint32_t, 2>> rangesOf(scene.meshes.size(), {0, 0});
  std::vector<PreparedInstance> shared;
  for (const Instance& instance : scene.instances) {
    if (!instanced[instance.mesh]) continue;
    std::array<uint32_t, 2>& ranges = rangesOf[instance.mesh];
    if (ranges[0] == 0) {
      SidedRanges own(prepared, tangents);
      for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
        own.add(primitive, packedIndex(prepared, primitive), glm::dmat4(1.0));
      ranges = own.finish(prepared);
    }
    const bool mirrors = glm::determinant(glm::dmat3(glm::dmat4(instance.toWorld))) < 0.0;
    for (uint32_t range : ranges) shared.push_back({range, instance.toWorld, mirrors});
  }
  placeInstances(shared, prepared);

  gatherLights(scene, prepared);
  return prepared;
}

}  // namespace weir::scene
