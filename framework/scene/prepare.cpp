#include <weir/core/parallel.h>
#include <weir/scene/gather_lights.h>
#include <weir/scene/geometry_range.h>
#include <weir/scene/prepare_materials.h>
#include <weir/scene/prepare_motion.h>
#include <weir/scene/prepared.h>
#include <weir/scene/spatial_sort.h>
#include <weir/scene/tangent_space.h>

#include <algorithm>
#include <array>
#include <map>
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

/// Tangents of a primitive that lacks them although its material has a normal map; else empty.
std::vector<glm::vec4> tangentsOf(const PreparedScene& prepared, const Primitive& p) {
  const size_t count = p.positions.size();
  const bool given = p.normals.size() == count && p.tangents.size() == count;
  const int32_t map = prepared.materials[packedIndex(prepared, p)].normalTexture;
  if (given || map < 0) return {};
  return cornerTangents(p.positions, p.normals, coordinatesOf(p, prepared.textures[map]), p.indices);
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
    parallelFor(work.size(), [&](size_t i) { *work[i].second = tangentsOf(prepared, *work[i].first); });
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
    add(primitive, material, transform, tangents_.of(primitive));
  }
  void add(const Primitive& primitive, uint32_t material, const glm::dmat4& transform,
           std::span<const glm::vec4> tangents) {
    ranges_[side(material)].add(primitive, material, transform, tangents);
  }
  size_t side(uint32_t material) const { return (materials_[material].flags & kMaterialDoubleSided) != 0 ? 1 : 0; }
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

/// An instance and its bounds in the world, at rest.
struct Placed {
  PreparedInstance instance;
  Bounds bounds;
};

void placeInstances(const std::vector<Placed>& unsorted, PreparedScene& prepared) {
  std::vector<SortItem> items;
  for (const Placed& placed : unsorted) {
    if (placed.bounds.empty) continue;
    items.push_back({placed.bounds.low, placed.bounds.high, static_cast<uint32_t>(&placed - unsorted.data())});
    prepared.bounds.add(placed.bounds.low);
    prepared.bounds.add(placed.bounds.high);
  }
  spatialSort(items);
  for (const SortItem& item : items) prepared.instances.push_back(unsorted[item.index].instance);
}

std::vector<size_t> usesOfMeshes(const Scene& scene) {
  std::vector<size_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++uses[instance.mesh];
  return uses;
}

/// Arranges the geometry: what is merged, what is shared, what moves.
class Arrangement {
 public:
  Arrangement(const Scene& scene, const Clip* clip, const PrepareLimits& limits, PreparedScene& prepared)
      : scene_(scene),
        plan_(scene, clip),
        prepared_(prepared),
        uses_(usesOfMeshes(scene)),
        tangents_(scene, prepared, uses_),
        merged_(prepared, tangents_) {
    for (size_t m = 0; m < scene.meshes.size(); ++m)
      shared_.push_back(isInstanced(scene, scene.meshes[m], uses_[m], limits) ? 1 : 0);
  }

  void run() {
    for (const Instance& instance : scene_.instances) {
      if (shared_[instance.mesh] && isPlain(instance, Motion::Still)) continue;
      for (const Primitive& primitive : primitivesOf(instance)) {
        if (plan_.of(instance, primitive) == Motion::Still) addTo(merged_, instance, primitive, true);
      }
    }
    for (uint32_t range : merged_.finish(prepared_)) {
      const Bounds bounds = rangeBounds(prepared_, prepared_.ranges[range], glm::dmat4(1.0));
      if (bounds.empty) continue;
      prepared_.instances.push_back({range, glm::mat4(1.0f), false});
      prepared_.bounds.add(bounds.low);
      prepared_.bounds.add(bounds.high);
    }
    for (const Instance& instance : scene_.instances) {
      if (isPlain(instance, Motion::Still)) {
        if (shared_[instance.mesh]) placeShared(instance);
      } else if (isPlain(instance, Motion::Rigid) && !isEmissive(instance)) {
        placeShared(instance);
      } else {
        placeRigid(instance);
        placeDeforming(instance, true);
        placeDeforming(instance, false);
      }
    }
    placeInstances(unsorted_, prepared_);
    const auto moves = [&](const PreparedInstance& i) { return prepared_.moves(i); };
    prepared_.traits.animated = std::ranges::any_of(prepared_.instances, moves);
    prepared_.traits.deforms = !prepared_.deformations.empty();
  }

 private:
  const std::vector<Primitive>& primitivesOf(const Instance& instance) const {
    return scene_.meshes[instance.mesh].primitives;
  }
  bool isEmissive(const Instance& instance) const {
    return std::ranges::any_of(primitivesOf(instance), [&](const Primitive& p) {
      return (prepared_.materials[packedIndex(prepared_, p)].flags & kMaterialEmissive) != 0;
    });
  }
  /// Whether all of an instance's primitives move that way and keep the shape in which they are stored.
  bool isPlain(const Instance& instance, Motion motion) const {
    return std::ranges::all_of(primitivesOf(instance), [&](const Primitive& p) {
      return plan_.of(instance, p) == motion && !deforms(scene_, instance, p);
    });
  }

  void addTo(SidedRanges& ranges, const Instance& instance, const Primitive& primitive, bool inWorld) {
    const uint32_t material = packedIndex(prepared_, primitive);
    if (!deforms(scene_, instance, primitive)) {
      ranges.add(primitive, material, inWorld ? glm::dmat4(instance.toWorld) : glm::dmat4(1.0));
      return;
    }
    glm::dmat4 toWorld;
    const Primitive shape = plan_.restShape(instance, primitive, toWorld);
    ranges.add(shape, material, inWorld ? toWorld : glm::dmat4(1.0), tangentsOf(prepared_, shape));
  }

  void place(uint32_t range, const Instance& instance) {
    const glm::dmat4 toWorld(instance.toWorld);
    const bool mirrors = glm::determinant(glm::dmat3(toWorld)) < 0.0;
    unsorted_.push_back({{range, instance.toWorld, mirrors, plan_.nodeMoves(instance.node) ? instance.node : -1},
                         rangeBounds(prepared_, prepared_.ranges[range], toWorld)});
  }

  /// An instance of ranges that all of its mesh's uses share.
  void placeShared(const Instance& instance) {
    const auto [entry, fresh] = rangesOf_.try_emplace(instance.mesh);
    if (fresh) {
      SidedRanges own(prepared_, tangents_);
      for (const Primitive& primitive : primitivesOf(instance)) addTo(own, instance, primitive, false);
      entry->second = own.finish(prepared_);
    }
    for (uint32_t range : entry->second) place(range, instance);
  }

  /// Primitives that move with their node, with triangles that no other instance shares.
  void placeRigid(const Instance& instance) {
    SidedRanges own(prepared_, tangents_);
    bool any = false;
    for (const Primitive& primitive : primitivesOf(instance)) {
      if (plan_.of(instance, primitive) != Motion::Rigid) continue;
      addTo(own, instance, primitive, false);
      any = true;
    }
    if (!any) return;
    for (uint32_t range : own.finish(prepared_)) place(range, instance);
  }

  /// Primitives whose vertices move: skinned ones end up in the world, the others follow their node.
  void placeDeforming(const Instance& instance, bool skinned) {
    for (size_t side = 0; side < 2; ++side) {
      GeometryRange range(prepared_, true);
      std::vector<const Primitive*> primitives;
      Bounds bounds;
      for (const Primitive& primitive : primitivesOf(instance)) {
        const uint32_t material = packedIndex(prepared_, primitive);
        const bool hasSkin = instance.skin >= 0 && primitive.influencesPerVertex > 0;
        if (plan_.of(instance, primitive) != Motion::Deforms || hasSkin != skinned || merged_.side(material) != side)
          continue;
        const Primitive stored = plan_.undeformed(instance, primitive);
        range.add(stored, material, glm::dmat4(1.0), tangentsOf(prepared_, stored));
        primitives.push_back(&primitive);
        glm::dmat4 toWorld;
        for (const glm::vec3& p : plan_.restShape(instance, primitive, toWorld).positions)
          bounds.add(glm::vec3(toWorld * glm::dvec4(glm::dvec3(p), 1.0)));
      }
      if (primitives.empty()) continue;
      std::vector<VertexSource> sources;
      range.finish(prepared_, &sources);
      prepared_.ranges.back().doubleSided = side == 1;
      plan_.addDeformation(instance, primitives, sources, prepared_);
      const auto number = static_cast<uint32_t>(prepared_.ranges.size() - 1);
      place(number, instance);
      if (skinned) unsorted_.back().instance = {number, glm::mat4(1.0f), false, -1};
      unsorted_.back().bounds = bounds;
    }
  }

  const Scene& scene_;
  MotionPlan plan_;
  PreparedScene& prepared_;
  std::vector<size_t> uses_;  // by mesh
  MissingTangents tangents_;
  SidedRanges merged_;
  std::vector<char> shared_;  // by mesh
  std::map<int, std::array<uint32_t, 2>> rangesOf_;
  std::vector<Placed> unsorted_;
};

}  // namespace

PreparedScene prepareScene(const Scene& scene, const PrepareLimits& limits, const Clip* clip) {
  PreparedScene prepared;
  prepareMaterials(scene, prepared);
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) prepared.traits.vertexColors |= !primitive.colors.empty();
  Arrangement(scene, clip, limits, prepared).run();
  gatherLights(scene, prepared, clip);
  return prepared;
}

}  // namespace weir::scene
