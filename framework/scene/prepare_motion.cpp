#include <weir/scene/prepare_motion.h>

#include <algorithm>
#include <array>

namespace weir::scene {
namespace {

/// Index of the value in the list, appended when it isn't there, and how many numbers lie before its own.
template <typename Size>
uint32_t blockOf(std::vector<int>& list, int value, Size&& size) {
  uint32_t before = 0;
  for (int known : list) {
    if (known == value) return before;
    before += static_cast<uint32_t>(size(known));
  }
  list.push_back(value);
  return before;
}

}  // namespace

MotionPlan::MotionPlan(const Scene& scene, const Clip* clip) : scene_(scene), rest_(restPose(scene)) {
  if (clip == nullptr) return;
  moving_ = movingNodes(scene, *clip);
  morphing_ = morphingNodes(scene, *clip);
  for (const Skin& skin : scene.skins)
    skinMoves_.push_back(std::ranges::any_of(skin.joints, [&](int joint) { return moving_[joint] != 0; }));
}

bool MotionPlan::isSkinned(const Instance& instance, const Primitive& primitive) const {
  return instance.skin >= 0 && primitive.influencesPerVertex > 0;
}

bool MotionPlan::mirrors(const Instance& instance) const {
  return glm::determinant(glm::dmat3(glm::dmat4(instance.toWorld))) < 0.0;
}

Motion MotionPlan::of(const Instance& instance, const Primitive& primitive) const {
  if (moving_.empty()) return Motion::Still;
  if (!primitive.targets.empty() && instance.node >= 0 && morphing_[instance.node]) return Motion::Deforms;
  if (isSkinned(instance, primitive)) return skinMoves_[instance.skin] ? Motion::Deforms : Motion::Still;
  return nodeMoves(instance.node) ? Motion::Rigid : Motion::Still;
}

Primitive MotionPlan::restShape(const Instance& instance, const Primitive& primitive, glm::dmat4& toWorld) const {
  static const std::vector<float> none;
  const std::vector<float>& weights = instance.node >= 0 ? rest_.weights[instance.node] : none;
  toWorld = glm::dmat4(instance.toWorld);
  if (!isSkinned(instance, primitive)) return deformed(primitive, weights, nullptr);
  const std::vector<glm::mat4> joints = jointMatrices(scene_.skins[instance.skin], rest_);
  toWorld = glm::dmat4(1.0);
  return deformed(primitive, weights, &joints, mirrors(instance));
}

Primitive MotionPlan::undeformed(const Instance& instance, const Primitive& primitive) const {
  Primitive copy = primitive;
  if (!isSkinned(instance, primitive) || !mirrors(instance)) return copy;
  for (size_t t = 0; t + 2 < copy.indices.size(); t += 3) std::swap(copy.indices[t + 1], copy.indices[t + 2]);
  for (glm::vec4& tangent : copy.tangents) tangent.w = -tangent.w;
  return copy;
}

void MotionPlan::addDeformation(const Instance& instance, const std::vector<const Primitive*>& primitives,
                                const std::vector<VertexSource>& sources, PreparedScene& prepared) const {
  TriangleRange& range = prepared.ranges.back();
  range.deformation = static_cast<int>(prepared.deformations.size());
  Deformation d;
  d.vertices = static_cast<uint32_t>(sources.size());
  d.firstVertex = static_cast<uint32_t>(prepared.positions.size()) - d.vertices;

  bool normals = false, tangents = false;
  for (const Primitive* p : primitives) {
    if (isSkinned(instance, *p)) d.influencesPerVertex = std::max(d.influencesPerVertex, p->influencesPerVertex);
    d.targets = std::max(d.targets, static_cast<uint32_t>(p->targets.size()));
    for (const MorphTarget& t : p->targets) {
      normals |= !t.normals.empty();
      tangents |= !t.tangents.empty();
    }
  }
  if (d.influencesPerVertex > 0) {
    d.mirrors = mirrors(instance);
    d.firstJoint =
        blockOf(prepared.posedSkins, instance.skin, [&](int skin) { return scene_.skins[skin].joints.size(); });
    d.joints = static_cast<uint32_t>(scene_.skins[instance.skin].joints.size());
    d.firstInfluence = static_cast<uint32_t>(prepared.influences.size());
    for (const VertexSource& s : sources) {
      const Primitive& p = *primitives[s.primitive];
      for (uint32_t k = 0; k < d.influencesPerVertex; ++k)
        prepared.influences.push_back(
            k < p.influencesPerVertex ? p.influences[size_t{s.vertex} * p.influencesPerVertex + k] : Influence{});
    }
  }
  if (d.targets > 0) {
    d.kinds = tangents ? 3 : normals ? 2 : 1;
    d.firstWeight =
        blockOf(prepared.posedNodes, instance.node, [&](int node) { return scene_.nodes[node].weights.size(); });
    d.firstDelta = static_cast<uint32_t>(prepared.morphDeltas.size());
    const MorphTarget none;
    for (uint32_t t = 0; t < d.targets; ++t) {
      for (const VertexSource& s : sources) {
        const Primitive& p = *primitives[s.primitive];
        const MorphTarget& target = t < p.targets.size() ? p.targets[t] : none;
        const std::array lists = {&target.positions, &target.normals, &target.tangents};
        for (uint32_t kind = 0; kind < d.kinds; ++kind)
          prepared.morphDeltas.push_back(lists[kind]->empty() ? glm::vec3(0.0f) : (*lists[kind])[s.vertex]);
      }
    }
  }
  d.firstFlat = static_cast<uint32_t>(prepared.flatTriangles.size());
  for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
    const auto& v = prepared.triangles[t].v;
    if (primitives[sources[v[0] - d.firstVertex].primitive]->normals.empty())
      prepared.flatTriangles.emplace_back(v[0], v[1], v[2]);
  }
  d.flats = static_cast<uint32_t>(prepared.flatTriangles.size()) - d.firstFlat;
  prepared.deformations.push_back(d);
}

}  // namespace weir::scene
