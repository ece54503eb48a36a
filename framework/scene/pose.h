// Where a scene's nodes, skins and morph targets are at a moment. CPU only, in double precision.
// Source: glTF 2.0, sections 3.7.3 (skins), 3.11 (animations) and appendix C (interpolation).
#pragma once

#include <weir/scene/scene.h>

#include <string>
#include <vector>

namespace weir::scene {

struct Pose {
  std::vector<glm::dmat4> world;            ///< of each node
  std::vector<std::vector<float>> weights;  ///< of each node's morph targets
};

/// As the nodes' own transforms and weights say.
Pose restPose(const Scene& scene);

/// At a time of a clip, in seconds; before its first and after its last key a channel keeps that key's value.
Pose evaluate(const Scene& scene, const Clip& clip, double seconds);

/// A channel's `width` numbers at a time. Rotations come out as unit quaternions (x y z w): LINEAR goes the shorter way
/// round (slerp), CUBICSPLINE is normalised.
std::vector<double> sample(const Channel& channel, double seconds);

/// World matrix of each joint times its inverse bind matrix: takes a vertex as stored into the world.
std::vector<glm::mat4> jointMatrices(const Skin& skin, const Pose& pose);

/// Nodes that the clip moves, themselves or by an ancestor.
std::vector<char> movingNodes(const Scene& scene, const Clip& clip);
/// Nodes whose morph weights the clip changes.
std::vector<char> morphingNodes(const Scene& scene, const Clip& clip);

/// A primitive after morphing (`weights`, one a target) and skinning. Where `joints` is given and the primitive has
/// influences, the result lies in the world, else in the mesh's own space. Normals and tangents are unit length; what
/// the primitive lacks stays away. `mirrors`: the determinant of the skinned node's own world matrix is negative, which
/// turns the winding (section 3.7.2.1) though the matrix itself is not applied.
Primitive deformed(const Primitive& primitive, const std::vector<float>& weights, const std::vector<glm::mat4>* joints,
                   bool mirrors = false);

/// Whether the primitive, used by this instance, lies where joints or morph weights take it.
bool deforms(const Scene& scene, const Instance& instance, const Primitive& primitive);

/// A camera or light of the scene, as its node stands in the pose; unchanged when it hangs on none.
Camera posed(const Camera& camera, const Pose& pose);
PunctualLight posed(const PunctualLight& light, const Pose& pose);

/// A direction through the upper 3x3, unit length; `way` itself where that collapses.
glm::vec3 turned(const glm::dmat4& world, const glm::dvec3& way);
/// A camera's place and orthonormal axes from its node's world matrix.
void place(Camera& camera, const glm::dmat4& world);

/// From `--clip`: a name, or a number from 0; an empty text takes the first. Throws InputError with the nearest name,
/// or when the file has no clips.
const Clip& chooseClip(const Scene& scene, const std::string& text);

/// A time within the clip: it starts over when it ends. A clip without length stays at its start.
double wrapped(const Clip& clip, double seconds);

}  // namespace weir::scene
