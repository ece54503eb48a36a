// What of a prepared scene a clip changes, for one moment: instances' transforms, joints, morph weights, lights. Plain
// data; execute/scene_motion.h brings it to the device.
#pragma once

#include <weir/scene/pose.h>
#include <weir/scene/prepared.h>

#include <vector>

namespace weir::scene {

struct SceneState {
  std::vector<glm::mat4> toWorld;     ///< beside PreparedScene::instances
  std::vector<char> flipsWinding;     ///< likewise
  std::vector<glm::mat4> joints;      ///< of PreparedScene::posedSkins, one skin after another; into the world
  std::vector<float> weights;         ///< of PreparedScene::posedNodes, one node after another
  std::vector<GpuLight> lights;       ///< beside PreparedScene::lights
  std::vector<AliasCell> aliasTable;  ///< likewise; unless left out, see StateMaker::at
  std::vector<double> power;          ///< weights of the table, where they change: PreparedScene::lightPowerChanges
  Bounds bounds;                      ///< contain all geometry, in the world; loose around what deforms
  float largestSide = 0.0f;           ///< no side of any triangle is longer, metres
};

/// Makes states of one scene. The references must outlive it. Throws RuntimeError when a transform is not finite.
class StateMaker {
 public:
  StateMaker(const Scene& scene, const PreparedScene& prepared);
  /// Without `table`, powers that change are not tabulated, and the lights keep the probabilities that they have at
  /// rest: for execute/scene_motion.h, which has the device build the table.
  SceneState at(const Pose& pose, bool table = true) const;

 private:
  /// Boxes of a range as it is stored, its longest side, and the longest displacement that its targets can add.
  struct Shape {
    Bounds bounds;
    std::vector<Bounds> jointBounds;  // of the vertices that hang on each joint
    float longestSide = 0.0f;
    std::vector<float> displacement;  // by target
  };
  /// Bounds in the space that the instance's transform takes into the world.
  Bounds boundsOf(size_t range, const SceneState& state) const;
  glm::vec3 vertex(uint32_t v, const TriangleRange& range, const SceneState& state) const;
  void setInstances(const Pose& pose, SceneState& state) const;
  void setLights(const Pose& pose, bool table, SceneState& state) const;
  void setBounds(SceneState& state) const;

  const Scene& scene_;
  const PreparedScene& prepared_;
  std::vector<Shape> shapes_;  // by range
};

/// Around everything at any of some moments of the clip, for a camera to frame.
Bounds clipBounds(const Scene& scene, const PreparedScene& prepared, const Clip& clip);

}  // namespace weir::scene
