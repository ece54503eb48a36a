// Meshes into world space: accessors, morph targets, skins, fronts of mirrored nodes.
#include <algorithm>
#include <cmath>

#include "model.h"

namespace weir::oracle {
namespace {

struct Vertices {
  Values position, normal, tangent, uv0, uv1, color, joints, weights;
};

Values optional(const Document& document, const Json& attributes, const char* name, size_t count) {
  if (!attributes.contains(name)) return {};
  Values v = document.accessor(attributes[name]);
  if (v.count != count) document.fail(name, "not as many as positions");
  return v;
}

void refuse(const Document& document, const Json& attributes) {
  for (const auto& [name, _] : attributes.items()) {
    const bool known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "TEXCOORD_0" ||
                       name == "TEXCOORD_1" || name == "COLOR_0" || name == "JOINTS_0" || name == "WEIGHTS_0";
    if (!known) document.fail("meshes", "the oracle doesn't know the attribute " + name);
  }
}

glm::dvec3 vec3At(const Values& v, size_t i) {
  return {v.at(i, 0), v.at(i, 1), v.at(i, 2)};
}

/// position, normal and tangent plus the weighted targets.
void morph(const Document& document, const Json& primitive, const std::vector<double>& weights, Vertices& v) {
  const Json targets = primitive.value("targets", Json::array());
  for (size_t t = 0; t < targets.size() && t < weights.size(); ++t) {
    const auto add = [&](const char* name, Values& to) {
      const Values delta = optional(document, targets[t], name, v.position.count);
      if (!delta || !to) return;
      for (size_t i = 0; i < to.count; ++i)
        for (size_t c = 0; c < 3; ++c) to.numbers[i * to.components + c] += weights[t] * delta.at(i, c);
    };
    add("POSITION", v.position);
    add("NORMAL", v.normal);
    add("TANGENT", v.tangent);
  }
}

std::vector<glm::dmat4> jointsOf(const Document& document, const Pose& pose, size_t skin) {
  const Json& s = document.json().at("skins").at(skin);
  const Json& joints = s.at("joints");
  Values inverse;
  if (s.contains("inverseBindMatrices")) inverse = document.accessor(s["inverseBindMatrices"]);
  if (inverse && (inverse.count < joints.size() || inverse.components != 16))
    document.fail("skins", "too few inverse bind matrices");
  std::vector<glm::dmat4> result;
  for (size_t j = 0; j < joints.size(); ++j) {
    glm::dmat4 bind(1);
    for (size_t k = 0; inverse && k < 16; ++k) bind[int(k / 4)][int(k % 4)] = inverse.at(j, k);
    result.push_back(pose.world.at(joints[j].get<size_t>()) * bind);
  }
  return result;
}

/// Transposed adjugate: what normals go by, up to a positive factor (times the sign of the determinant).
glm::dmat3 cofactor(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

glm::dvec3 unitOr(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return length > 0 ? v / length : fallback;
}

std::vector<size_t> indicesOf(const Document& document, const Json& primitive, size_t vertices) {
  std::vector<size_t> indices;
  if (primitive.contains("indices")) {
    const Values v = document.accessor(primitive["indices"]);
    for (const double i : v.numbers) indices.push_back(static_cast<size_t>(i));
  } else {
    for (size_t i = 0; i < vertices; ++i) indices.push_back(i);
  }
  if (primitive.value("mode", 4) != 4) document.fail("meshes", "the oracle knows triangle lists alone");
  if (indices.size() % 3 != 0) document.fail("meshes", "a count of indices that isn't a multiple of 3");
  for (const size_t i : indices)
    if (i >= vertices) document.fail("meshes", "an index beyond the vertices");
  return indices;
}

}  // namespace

void addMesh(const Document& document, const Pose& pose, size_t index, Model& model) {
  const Json& root = document.json();
  const Json& node = root.at("nodes").at(index);
  const Json& mesh = root.at("meshes").at(node["mesh"].get<size_t>());
  std::vector<double> weights = pose.weights[index];
  if (weights.empty()) weights = node.value("weights", mesh.value("weights", std::vector<double>{}));
  std::vector<glm::dmat4> joints;
  if (node.contains("skin")) joints = jointsOf(document, pose, node["skin"]);

  for (const Json& primitive : mesh.at("primitives")) {
    const Json& attributes = primitive.at("attributes");
    refuse(document, attributes);
    Vertices v;
    v.position = document.accessor(attributes.at("POSITION"));
    const size_t count = v.position.count;
    v.normal = optional(document, attributes, "NORMAL", count);
    v.tangent = optional(document, attributes, "TANGENT", count);
    v.uv0 = optional(document, attributes, "TEXCOORD_0", count);
    v.uv1 = optional(document, attributes, "TEXCOORD_1", count);
    v.color = optional(document, attributes, "COLOR_0", count);
    v.joints = optional(document, attributes, "JOINTS_0", count);
    v.weights = optional(document, attributes, "WEIGHTS_0", count);
    morph(document, primitive, weights, v);

    std::vector<glm::dmat4> toWorld(joints.empty() ? 1 : count, pose.world[index]);
    if (!joints.empty()) {
      if (!v.joints || !v.weights) document.fail("meshes", "a skinned mesh without joints and weights");
      for (size_t i = 0; i < count; ++i) {
        glm::dmat4 sum(0);
        double total = 0;
        for (size_t c = 0; c < 4; ++c) {
          sum += joints.at(static_cast<size_t>(v.joints.at(i, c))) * v.weights.at(i, c);
          total += v.weights.at(i, c);
        }
        toWorld[i] = sum / total;
      }
    }
    const bool mirrors = glm::determinant(glm::dmat3(pose.world[index])) < 0;
    const double sign = mirrors ? -1.0 : 1.0;
    const std::vector<size_t> indices = indicesOf(document, primitive, count);
    const int material = primitive.contains("material") ? primitive["material"].get<int>() + 1 : 0;
    const bool wantsTangents = bool(model.materials.at(static_cast<size_t>(material)).normalTexture);
    if (wantsTangents && (!v.normal || !v.tangent))
      document.fail("meshes", "the oracle makes no tangents: a normal map needs NORMAL and TANGENT");
    for (size_t i = 0; i < indices.size(); i += 3) {
      std::array<size_t, 3> corners = {indices[i], indices[i + 1], indices[i + 2]};
      if (mirrors) std::swap(corners[1], corners[2]);
      Triangle t;
      t.material = material;
      for (size_t k = 0; k < 3; ++k) {
        const size_t c = corners[k];
        const glm::dmat4& m = toWorld[joints.empty() ? 0 : c];
        t.position[k] = glm::dvec3(glm::vec3(glm::dvec3(m * glm::dvec4(vec3At(v.position, c), 1.0))));
        if (v.normal) t.normal[k] = unitOr(sign * cofactor(glm::dmat3(m)) * vec3At(v.normal, c), glm::dvec3(0));
        if (wantsTangents) t.tangent[k] = glm::dvec4(glm::dmat3(m) * vec3At(v.tangent, c), v.tangent.at(c, 3) * sign);
        if (v.uv0) t.uv[0][k] = {v.uv0.at(c, 0), v.uv0.at(c, 1)};
        if (v.uv1) t.uv[1][k] = {v.uv1.at(c, 0), v.uv1.at(c, 1)};
        if (v.color)
          t.color[k] = {v.color.at(c, 0), v.color.at(c, 1), v.color.at(c, 2),
                        v.color.components == 4 ? v.color.at(c, 3) : 1.0};
      }
      const glm::dvec3 cross = glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
      if (!(glm::length(cross) > 0)) continue;
      if (!v.normal) t.normal.fill(glm::normalize(cross));
      model.triangles.push_back(t);
    }
  }
}

}  // namespace weir::oracle
