// A scene as a clip has it at a moment, with nothing left to move: skins, morph targets and nodes worked in on the CPU.
// What a moving scene on the device is compared with.
#pragma once

#include <weir/scene/pose.h>

#include <glm/glm.hpp>
#include <optional>

namespace weir::test {

inline scene::Scene posedScene(const scene::Scene& scene, const std::string& clip, double seconds) {
  const scene::Pose pose = scene::evaluate(scene, scene::chooseClip(scene, clip), seconds);
  scene::Scene still = scene;
  still.meshes.clear();
  still.nodes.clear();
  still.skins.clear();
  still.clips.clear();
  for (scene::Instance& instance : still.instances) {
    const std::vector<float> weights = instance.node >= 0 ? pose.weights[instance.node] : std::vector<float>();
    scene::Mesh mesh;
    for (const scene::Primitive& primitive : scene.meshes[instance.mesh].primitives) {
      const bool skinned = instance.skin >= 0 && primitive.influencesPerVertex > 0;
      std::vector<glm::mat4> joints;
      if (skinned) joints = scene::jointMatrices(scene.skins[instance.skin], pose);
      mesh.primitives.push_back(scene::deformed(primitive, weights, skinned ? &joints : nullptr));
    }
    if (instance.node >= 0) instance.toWorld = glm::mat4(pose.world[instance.node]);
    if (instance.skin >= 0) instance.toWorld = glm::mat4(1.0f);
    instance.mesh = static_cast<int>(still.meshes.size());
    instance.node = instance.skin = -1;
    still.meshes.push_back(std::move(mesh));
  }
  for (scene::PunctualLight& light : still.lights) {
    light = scene::posed(light, pose);
    light.node = -1;
  }
  for (scene::Camera& camera : still.cameras) {
    camera = scene::posed(camera, pose);
    camera.node = -1;
  }
  return still;
}

/// A point of a posed scene by what it is made of, so that it can be found in another pose of the same scene.
struct MaterialPoint {
  size_t instance = 0, primitive = 0, triangle = 0;
  glm::dvec3 barycentrics{0.0};
  double distance = 0.0;
};

inline glm::dvec3 cornerOf(const scene::Scene& posed, const MaterialPoint& p, size_t corner) {
  const scene::Instance& instance = posed.instances[p.instance];
  const scene::Primitive& primitive = posed.meshes[instance.mesh].primitives[p.primitive];
  return glm::dvec3(glm::dmat4(instance.toWorld) *
                    glm::dvec4(glm::dvec3(primitive.positions[primitive.indices[3 * p.triangle + corner]]), 1.0));
}

inline glm::dvec3 positionOf(const scene::Scene& posed, const MaterialPoint& p) {
  return p.barycentrics.x * cornerOf(posed, p, 0) + p.barycentrics.y * cornerOf(posed, p, 1) +
         p.barycentrics.z * cornerOf(posed, p, 2);
}

/// The point of the scene nearest to a distance along a ray (Möller and Trumbore 1997), within `tolerance` of it.
inline std::optional<MaterialPoint> pointAlong(const scene::Scene& posed, const glm::dvec3& origin,
                                               const glm::dvec3& direction, double distance, double tolerance) {
  std::optional<MaterialPoint> best;
  for (size_t i = 0; i < posed.instances.size(); ++i) {
    const scene::Mesh& mesh = posed.meshes[posed.instances[i].mesh];
    for (size_t k = 0; k < mesh.primitives.size(); ++k) {
      for (size_t t = 0; t < mesh.primitives[k].indices.size() / 3; ++t) {
        MaterialPoint p{i, k, t, {}, 0.0};
        const glm::dvec3 a = cornerOf(posed, p, 0), e1 = cornerOf(posed, p, 1) - a, e2 = cornerOf(posed, p, 2) - a;
        const glm::dvec3 h = glm::cross(direction, e2);
        const double determinant = glm::dot(e1, h);
        if (determinant == 0.0) continue;
        const glm::dvec3 s = origin - a, q = glm::cross(s, e1);
        const double u = glm::dot(s, h) / determinant, v = glm::dot(direction, q) / determinant;
        if (u < -1e-6 || v < -1e-6 || u + v > 1 + 1e-6) continue;
        p.distance = glm::dot(e2, q) / determinant;
        p.barycentrics = {1 - u - v, u, v};
        const double off = std::abs(p.distance - distance);
        if (off <= tolerance && (!best || off < std::abs(best->distance - distance))) best = p;
      }
    }
  }
  return best;
}

}  // namespace weir::test
