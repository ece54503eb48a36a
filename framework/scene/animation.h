// How a scene moves, as plain data: the node hierarchy, animation clips and skins as glTF stores them. What they amount
// to at a moment is scene/pose.h's concern.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

namespace weir::scene {

/// A node of the hierarchy; the index into Scene::nodes is glTF's own. Its transform relative to its parent is T · R ·
/// S, or `matrix` where the file gives one (such nodes can't be animated).
struct Node {
  std::string name;
  int parent = -1;
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< unit length; w first
  glm::dvec3 scale{1.0};
  std::optional<glm::dmat4> matrix;
  std::vector<float> weights;  ///< of its mesh's morph targets at rest: the node's own, else the mesh's
};

enum class Interpolation : uint8_t { Step, Linear, CubicSpline };
enum class AnimatedPath : uint8_t { Translation, Rotation, Scale, Weights };

/// One property of one node over time.
struct Channel {
  int node = -1;
  AnimatedPath path = AnimatedPath::Translation;
  Interpolation interpolation = Interpolation::Linear;
  std::vector<float> times;  ///< seconds, strictly increasing, at least one
  /// `width` numbers a key; three times as many with CubicSpline: in-tangent, value, out-tangent. Quaternions are x y z
  /// w.
  std::vector<float> values;
  uint32_t width = 3;
};

struct Clip {
  std::string name;  ///< "clip N" where the file gives none
  std::vector<Channel> channels;
  double duration = 0.0;  ///< time of the last key, seconds
};

/// A skin deforms a mesh by its joints: a vertex lies where the weighted sum of joint · inverseBind takes it.
struct Skin {
  std::string name;
  std::vector<int> joints;             ///< nodes
  std::vector<glm::mat4> inverseBind;  ///< beside joints
};

/// What a vertex hangs on: an index into its skin's joints, and a share. A vertex's shares sum up to 1.
struct Influence {
  uint32_t joint = 0;
  float weight = 0.0f;
};
static_assert(sizeof(Influence) == 8);

/// Displacements of a primitive's vertices, added in proportion to the target's weight. Empty: none.
struct MorphTarget {
  std::vector<glm::vec3> positions, normals, tangents;
};

}  // namespace weir::scene
