// Morph targets and skins: writes the frame's vertices (framework/execute/scene_motion.cpp). glTF 2.0, sections 3.7.2.2 and 3.7.3.
// One launch for each Deformation (framework/scene/prepared.h), one invocation a vertex; then, where triangles store no normals, one
// a triangle, after the positions are there.
#include "packing.glsl"

layout(local_size_x = 64) in;

struct Vertex { uint normal, tangent; vec2 uv; };
struct Influence { uint joint; float weight; };

layout(set = 0, binding = 0, std430) readonly buffer RestPositions { float restPositions[]; };
layout(set = 0, binding = 1, std430) readonly buffer RestVertices { Vertex restVertices[]; };
layout(set = 0, binding = 2, std430) readonly buffer Influences { Influence influences[]; };
layout(set = 0, binding = 3, std430) readonly buffer Deltas { float deltas[]; };
layout(set = 0, binding = 4, std430) readonly buffer Joints { mat4 joints[]; };
layout(set = 0, binding = 5, std430) readonly buffer Weights { float weights[]; };
layout(set = 0, binding = 6, std430) readonly buffer Flat { uint flatVertices[]; };
layout(set = 0, binding = 7, std430) buffer Positions { float positions[]; };
layout(set = 0, binding = 8, std430) buffer Vertices { Vertex vertices[]; };

layout(push_constant) uniform Launch {
  uint flatNormals, count;  // what this launch does; vertices or triangles
  uint firstVertex, influencesPerVertex, firstInfluence, firstJoint;
  uint targets, firstWeight, kinds, firstDelta, firstFlat;
  float side;  // -1: the skinned node mirrors
} launch;

vec3 positionOf(uint v) { return vec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]); }
vec3 delta(uint i) { return vec3(deltas[3u * i], deltas[3u * i + 1u], deltas[3u * i + 2u]); }

vec3 unitOr(vec3 v, vec3 otherwise) {
  const float l = length(v);
  return l > 0.0 && !isinf(l) ? v / l : otherwise;
}

void writeFlatNormal(uint i) {
  const uint at = 3u * (launch.firstFlat + i);
  const uvec3 v = uvec3(flatVertices[at], flatVertices[at + 1u], flatVertices[at + 2u]);
  const vec3 p = positionOf(v.x);
  const vec3 normal = unitOr(cross(positionOf(v.y) - p, positionOf(v.z) - p), vec3(0.0, 0.0, 1.0));
  for (int k = 0; k < 3; ++k) vertices[v[k]].normal = packNormal(normal);
}

void writeVertex(uint i) {
  const uint v = launch.firstVertex + i;
  const Vertex rest = restVertices[v];
  const vec3 restNormal = unpackNormal(rest.normal);
  const vec4 restTangent = unpackTangent(rest.tangent);
  vec3 position = vec3(restPositions[3u * v], restPositions[3u * v + 1u], restPositions[3u * v + 2u]);
  vec3 normal = restNormal, tangent = restTangent.xyz;
  for (uint t = 0u; t < launch.targets; ++t) {
    const float weight = weights[launch.firstWeight + t];
    if (weight == 0.0) continue;
    const uint at = launch.firstDelta + (t * launch.count + i) * launch.kinds;
    position += weight * delta(at);
    if (launch.kinds > 1u) normal += weight * delta(at + 1u);
    if (launch.kinds > 2u) tangent += weight * delta(at + 2u);
  }
  if (launch.influencesPerVertex > 0u) {
    mat4 m = mat4(0.0);
    for (uint k = 0u; k < launch.influencesPerVertex; ++k) {
      const Influence influence = influences[launch.firstInfluence + i * launch.influencesPerVertex + k];
      if (influence.weight > 0.0) m += influence.weight * joints[launch.firstJoint + influence.joint];
    }
    position = (m * vec4(position, 1.0)).xyz;
    const mat3 linear = mat3(m);
    normal = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1])) * normal * launch.side;
    tangent = linear * tangent;
  }
  normal = unitOr(normal, restNormal);
  tangent = unitOr(tangent - normal * dot(normal, tangent), restTangent.xyz);
  positions[3u * v] = position.x;
  positions[3u * v + 1u] = position.y;
  positions[3u * v + 2u] = position.z;
  vertices[v].normal = packNormal(normal);
  vertices[v].tangent = packTangent(vec4(tangent, restTangent.w));
}

void main() {
  const uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (i >= launch.count) return;
  if (launch.flatNormals != 0u) writeFlatNormal(i);
  else writeVertex(i);
}
