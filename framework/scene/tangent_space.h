// Tangents for normal maps, by the method that glTF names: MikkTSpace. Internal to scene/prepare.
// Source: Morten S. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", master's thesis 2008, and the rules that
// its author documents for the method (mikktspace.com): order-independent, so that every tool arrives at the same
// frames as the one that baked the map.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace weir::scene {

/// A tangent for each corner of each triangle, indices.size() in all. `positions`, `normals` (unit length) and `uvs`
/// have one entry a vertex; `normals` may be empty, which stands for flat normals. xyz is a unit vector orthogonal to
/// the corner's normal that points along +U; w is such that cross(normal, tangent)·w points up the image (towards -V),
/// as glTF's normal maps expect.
///
/// Corners share a tangent when their triangles are connected by edges around a vertex of equal position, normal and
/// texture coordinates, and their texture coordinates turn the same way; it is the mean of the triangles' own tangents
/// in the vertex's plane, weighted by the triangles' angles there. Triangles without area in texture space take part in
/// the frames of their neighbours. Triangles without area or with values that are not finite, and corners that have no
/// neighbour to take from, get any direction orthogonal to the normal.
std::vector<glm::vec4> cornerTangents(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                      std::span<const glm::vec2> uvs, std::span<const uint32_t> indices);

/// Any unit vector orthogonal to a unit vector.
glm::dvec3 anyOrthogonal(const glm::dvec3& n);

}  // namespace weir::scene
