#include <weir/core/error.h>
#include <weir/scene/gather_lights.h>
#include <weir/scene/scene_state.h>

#include <algorithm>
#include <cmath>

namespace weir::scene {
namespace {

glm::vec3 transformed(const glm::mat4& m, const glm::vec3& p) {
  return glm::vec3(glm::dmat4(m) * glm::dvec4(glm::dvec3(p), 1.0));
}

/// Box around a box's corners under a transform: by convexity around everything in it.
void addBox(const Bounds& box, const glm::mat4& m, Bounds& to) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                      corner & 4 ? box.high.z : box.low.z);
    to.add(transformed(m, p));
  }
}

bool finite(const glm::mat4& m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  return true;
}

}  // namespace

StateMaker::StateMaker(const Scene& scene, const PreparedScene& prepared) : scene_(scene), prepared_(prepared) {
  for (const TriangleRange& range : prepared.ranges) {
    Shape shape;
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      const auto& v = prepared.triangles[t].v;
      for (int k = 0; k < 3; ++k) {
        shape.bounds.add(prepared.positions[v[k]]);
        shape.longestSide =
            std::max(shape.longestSide, glm::distance(prepared.positions[v[k]], prepared.positions[v[(k + 1) % 3]]));
      }
    }
    if (range.deformation >= 0) {
      const Deformation& d = prepared.deformations[range.deformation];
      for (uint32_t t = 0; t < d.targets; ++t) {
        float most = 0.0f;
        for (uint32_t v = 0; v < d.vertices; ++v)
          most = std::max(most, glm::length(prepared.morphDeltas[d.firstDelta + (t * d.vertices + v) * d.kinds]));
        shape.displacement.push_back(most);
      }
      if (d.influencesPerVertex > 0) shape.jointBounds.resize(d.joints);
      for (uint32_t i = 0; i < d.vertices * d.influencesPerVertex; ++i) {
        const Influence& influence = prepared.influences[d.firstInfluence + i];
        if (influence.weight > 0.0f)
          shape.jointBounds[influence.joint].add(prepared.positions[d.firstVertex + i / d.influencesPerVertex]);
      }
    }
    shapes_.push_back(std::move(shape));
  }
}

SceneState StateMaker::at(const Pose& pose, bool table) const {
  SceneState state;
  for (int skin : prepared_.posedSkins) {
    for (const glm::mat4& joint : jointMatrices(scene_.skins[skin], pose)) {
      if (!finite(joint)) throw RuntimeError(scene_.path + ": a joint's matrix is not finite");
      state.joints.push_back(joint);
    }
  }
  for (int node : prepared_.posedNodes)
    state.weights.insert(state.weights.end(), pose.weights[node].begin(), pose.weights[node].end());
  setInstances(pose, state);
  setLights(pose, table, state);
  setBounds(state);
  return state;
}

void StateMaker::setInstances(const Pose& pose, SceneState& state) const {
  for (const PreparedInstance& instance : prepared_.instances) {
    if (instance.node < 0) {
      state.toWorld.push_back(instance.toWorld);
      state.flipsWinding.push_back(instance.flipsWinding ? 1 : 0);
      continue;
    }
    const glm::dmat4& world = pose.world[instance.node];
    state.toWorld.emplace_back(world);
    if (!finite(state.toWorld.back())) throw RuntimeError(scene_.path + ": a node's transform is not finite");
    state.flipsWinding.push_back(glm::determinant(glm::dmat3(world)) < 0.0 ? 1 : 0);
  }
}

glm::vec3 StateMaker::vertex(uint32_t v, const TriangleRange& range, const SceneState& state) const {
  if (range.deformation < 0) return prepared_.positions[v];
  const Deformation& d = prepared_.deformations[range.deformation];
  const uint32_t local = v - d.firstVertex;
  glm::dvec3 p(prepared_.positions[v]);
  for (uint32_t t = 0; t < d.targets; ++t)
    p += static_cast<double>(state.weights[d.firstWeight + t]) *
         glm::dvec3(prepared_.morphDeltas[d.firstDelta + (t * d.vertices + local) * d.kinds]);
  if (d.influencesPerVertex == 0) return glm::vec3(p);
  glm::dvec4 sum(0.0);
  for (uint32_t k = 0; k < d.influencesPerVertex; ++k) {
    const Influence& influence = prepared_.influences[d.firstInfluence + local * d.influencesPerVertex + k];
    sum += static_cast<double>(influence.weight) *
           (glm::dmat4(state.joints[d.firstJoint + influence.joint]) * glm::dvec4(p, 1.0));
  }
  return glm::vec3(sum);
}

void StateMaker::setLights(const Pose& pose, bool table, SceneState& state) const {
  state.lights = prepared_.lights;
  const bool changes = prepared_.lightPowerChanges();
  // gatherLights() asks before there is a table at rest.
  const bool reweigh = changes || prepared_.aliasTable.empty();
  if (!reweigh)
    state.aliasTable = prepared_.aliasTable;
  else
    state.power = prepared_.lightPower;
  for (const MovingLight& moving : prepared_.movingLights) {
    GpuLight& light = state.lights[moving.light];
    if (moving.instance < 0) {
      setPunctual(light, posed(scene_.lights[moving.source], pose));
      continue;
    }
    const TriangleRange& range = prepared_.ranges[prepared_.instances[moving.instance].range];
    const glm::mat4& toWorld = state.toWorld[moving.instance];
    const auto& v = prepared_.triangles[light.triangle].v;
    // A mirroring transform turns the winding, and with it the side that emits.
    const bool turned = state.flipsWinding[moving.instance] != 0;
    light.kind = (light.kind & ~kLightTurned) | (turned ? kLightTurned : 0u);
    const auto corner = [&](int k) { return transformed(toWorld, vertex(v[k], range, state)); };
    setTriangle(light, corner(0), corner(turned ? 2 : 1), corner(turned ? 1 : 2));
    state.power[moving.light] = moving.radiosity * light.area;
  }
  if (reweigh && table && !state.power.empty()) state.aliasTable = buildLightTable(state.power, state.lights);
}

Bounds StateMaker::boundsOf(size_t number, const SceneState& state) const {
  const Shape& shape = shapes_[number];
  const TriangleRange& range = prepared_.ranges[number];
  if (range.deformation < 0 || shape.bounds.empty) return shape.bounds;
  const Deformation& d = prepared_.deformations[range.deformation];
  float by = 0.0f;
  for (uint32_t t = 0; t < d.targets; ++t) by += std::abs(state.weights[d.firstWeight + t]) * shape.displacement[t];
  const auto grown = [by](Bounds box) {
    box.low -= by;
    box.high += by;
    return box;
  };
  if (d.influencesPerVertex == 0) return grown(shape.bounds);
  // A skinned vertex is a convex mixture of where its joints take it.
  Bounds result;
  for (uint32_t j = 0; j < d.joints; ++j)
    if (!shape.jointBounds[j].empty) addBox(grown(shape.jointBounds[j]), state.joints[d.firstJoint + j], result);
  return result;
}

void StateMaker::setBounds(SceneState& state) const {
  for (size_t i = 0; i < prepared_.instances.size(); ++i) {
    const PreparedInstance& instance = prepared_.instances[i];
    const Bounds box = boundsOf(instance.range, state);
    if (box.empty) continue;
    addBox(box, state.toWorld[i], state.bounds);
    const bool deforms = prepared_.ranges[instance.range].deformation >= 0;
    float squares = 0.0f;  // of all columns: no direction is stretched further
    for (int c = 0; c < 3; ++c) squares += glm::dot(glm::vec3(state.toWorld[i][c]), glm::vec3(state.toWorld[i][c]));
    const float stretch = state.toWorld[i] == glm::mat4(1.0f) ? 1.0f : std::sqrt(squares);
    const float side = deforms ? 2.0f * box.radius() : shapes_[instance.range].longestSide;
    state.largestSide = std::max(state.largestSide, side * stretch);
  }
  for (const GpuLight& light : state.lights) {
    const uint32_t kind = light.kind & 0xffu;
    if (kind == static_cast<uint32_t>(GpuLightKind::Point) || kind == static_cast<uint32_t>(GpuLightKind::Spot))
      state.bounds.add(light.position);
  }
}

Bounds clipBounds(const Scene& scene, const PreparedScene& prepared, const Clip& clip) {
  constexpr int kMoments = 16;
  const StateMaker states(scene, prepared);
  Bounds result;
  for (int i = 0; i <= kMoments; ++i) {
    const Bounds at = states.at(evaluate(scene, clip, clip.duration * i / kMoments)).bounds;
    if (at.empty) continue;
    result.add(at.low);
    result.add(at.high);
  }
  return result;
}

}  // namespace weir::scene
