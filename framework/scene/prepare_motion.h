// What a clip moves, found while a scene is prepared. Internal to scene/prepare.
#pragma once

#include <weir/scene/geometry_range.h>
#include <weir/scene/pose.h>
#include <weir/scene/prepared.h>

#include <vector>

namespace weir::scene {

/// How an instance's primitive is drawn.
enum class Motion : uint8_t {
  Still,    ///< merged into the world
  Rigid,    ///< an instance under a node that moves
  Deforms,  ///< vertices of its own, written anew every frame
};

class MotionPlan {
 public:
  MotionPlan(const Scene& scene, const Clip* clip);

  Motion of(const Instance& instance, const Primitive& primitive) const;
  bool nodeMoves(int node) const { return node >= 0 && !moving_.empty() && moving_[node]; }
  /// A copy of the primitive in its shape at rest, by skin and morph weights, and the transform that takes it from
  /// there into the world.
  Primitive restShape(const Instance& instance, const Primitive& primitive, glm::dmat4& toWorld) const;
  /// A copy to be deformed: as it is stored, but turned over where the skin's node mirrors.
  Primitive undeformed(const Instance& instance, const Primitive& primitive) const;

  /// Says how the vertices of the scene's last range move. `primitives` are those that it was made of, `sources` one
  /// entry a vertex.
  void addDeformation(const Instance& instance, const std::vector<const Primitive*>& primitives,
                      const std::vector<VertexSource>& sources, PreparedScene& prepared) const;

 private:
  bool isSkinned(const Instance& instance, const Primitive& primitive) const;
  bool mirrors(const Instance& instance) const;

  const Scene& scene_;
  Pose rest_;
  std::vector<char> moving_, morphing_;  // by node; empty without a clip
  std::vector<char> skinMoves_;
};

}  // namespace weir::scene
