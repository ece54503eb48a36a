// Tangents by MikkTSpace's rules: closed forms for each rule, and the stored tangents of scenes by other people.
#include <weir/scene/packing.h>
#include <weir/scene/tangent_space.h>

#include <algorithm>
#include <cmath>

#include "scene_support.h"

namespace weir::scene::test {
namespace {

struct Surface {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> uvs;
  std::vector<uint32_t> indices;
  std::vector<glm::vec4> tangents() const { return cornerTangents(positions, normals, uvs, indices); }
};

void expectNear(const glm::vec4& a, const glm::vec4& b) {
  EXPECT_LT(glm::distance(a, b), 1e-5f) << a.x << " " << a.y << " " << a.z << " " << a.w;
}

/// A right triangle in the XY plane.
Surface triangle(const std::vector<glm::vec2>& uvs) {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<glm::vec3>(3, {0, 0, 1}), uvs, {0, 1, 2}};
}

TEST(TangentSpace, FollowsUAndPointsUpTheImage) {
  // u to the right, v down the image: upright, so cross(n, t) points up.
  for (const glm::vec4& t : triangle({{0, 1}, {1, 1}, {0, 0}}).tangents()) expectNear(t, {1, 0, 0, 1});
  for (const glm::vec4& t : triangle({{1, 1}, {0, 1}, {1, 0}}).tangents()) expectNear(t, {-1, 0, 0, -1});
  // Scale of the coordinates does not matter, however small.
  for (const glm::vec4& t : triangle({{0, 1e-18f}, {1e-18f, 1e-18f}, {0, 0}}).tangents()) expectNear(t, {1, 0, 0, 1});
}

TEST(TangentSpace, WithoutCoordinatesAnyDirectionInThePlane) {
  for (const auto& uvs : {std::vector<glm::vec2>(3), std::vector<glm::vec2>()})
    for (const glm::vec4& t : triangle(uvs).tangents()) {
      EXPECT_NEAR(glm::length(glm::vec3(t)), 1.0f, 1e-6f);
      EXPECT_EQ(t.z, 0.0f);
      EXPECT_EQ(std::abs(t.w), 1.0f);
    }
}

// Two triangles that share the edge from (0,0) to (0,1), with u to the right and v down the image in the right one.
// Angles at (0,0): 90° and 45°. `last`: coordinates of the left one's own corner; (-1, -1) continues the right one.
Surface pair(const glm::vec2& last) {
  Surface s;
  s.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
  s.normals.assign(4, {0, 0, 1});
  s.uvs = {{0, 0}, {1, 0}, {0, -1}, last};
  s.indices = {0, 1, 2, 0, 2, 3};
  return s;
}

TEST(TangentSpace, NeighboursAreWeightedByTheirAngles) {
  const Surface s = pair({-1, 0});
  const auto solve = [&](int a, int b, int c) {  // direction of u, by solving for it
    const glm::dvec2 e1 = s.positions[b] - s.positions[a], e2 = s.positions[c] - s.positions[a];
    const glm::dvec2 d1 = s.uvs[b] - s.uvs[a], d2 = s.uvs[c] - s.uvs[a];
    const double det = d1.x * d2.y - d2.x * d1.y;
    return glm::normalize((e1 * d2.y - e2 * d1.y) / det);
  };
  const glm::dvec2 right = solve(0, 1, 2), left = solve(0, 2, 3);
  EXPECT_GT(glm::distance(right, left), 0.1);
  const double quarter = std::acos(0.0), eighth = quarter / 2;
  const std::vector<glm::vec4> t = s.tangents();
  const glm::dvec2 atOrigin = glm::normalize(quarter * right + eighth * left);
  expectNear(t[0], {atOrigin.x, atOrigin.y, 0, 1});
  expectNear(t[3], {atOrigin.x, atOrigin.y, 0, 1});
  const glm::dvec2 atTop = glm::normalize(eighth * right + quarter * left);
  expectNear(t[2], {atTop.x, atTop.y, 0, 1});
  expectNear(t[4], {atTop.x, atTop.y, 0, 1});
  expectNear(t[1], {right.x, right.y, 0, 1});
  expectNear(t[5], {left.x, left.y, 0, 1});
}

TEST(TangentSpace, MirroredCoordinatesAreNotMixed) {
  const Surface s = pair({1, -1});  // u grows to the left in the left triangle
  const std::vector<glm::vec4> t = s.tangents();
  for (int k = 0; k < 3; ++k) expectNear(t[k], {1, 0, 0, 1});
  for (int k = 3; k < 6; ++k) expectNear(t[k], {-1, 0, 0, -1});
}

TEST(TangentSpace, DifferentNormalsPartAndEqualVerticesMeet) {
  const Surface s = pair({-1, 0});
  const std::vector<glm::vec4> shared = s.tangents();
  // The same with vertices of its own for each triangle: equal values are one vertex.
  Surface apart = s;
  apart.positions = {s.positions[0], s.positions[1], s.positions[2], s.positions[0], s.positions[2], s.positions[3]};
  apart.uvs = {s.uvs[0], s.uvs[1], s.uvs[2], s.uvs[0], s.uvs[2], s.uvs[3]};
  apart.normals.assign(6, {0, 0, 1});
  apart.indices = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(apart.tangents(), shared);
  // Without normals both triangles lie in one plane, so the flat normals are equal.
  Surface flat = apart;
  flat.normals.clear();
  EXPECT_EQ(flat.tangents(), shared);
  // With another normal at its corners the right triangle keeps to itself.
  for (int k = 0; k < 3; ++k) apart.normals[k] = glm::normalize(glm::vec3(0, 0.1f, 1));
  const std::vector<glm::vec4> parted = apart.tangents();
  expectNear(parted[0], {1, 0, 0, 1});
  EXPECT_GT(glm::distance(parted[0], parted[3]), 0.1f);
}

TEST(TangentSpace, TrianglesWithoutCoordinatesJoinTheirNeighbours) {
  const Surface s = pair({0, 0});  // no area in texture space on the left
  const std::vector<glm::vec4> t = s.tangents();
  for (int corner : {0, 1, 2, 3, 4}) expectNear(t[corner], {1, 0, 0, 1});
  // Its last corner touches nobody who knows a direction.
  EXPECT_NEAR(glm::length(glm::vec3(t[5])), 1.0f, 1e-6f);
}

TEST(TangentSpace, BrokenTrianglesHarmNobody) {
  Surface s = triangle({{0, 1}, {1, 1}, {0, 0}});
  const float nan = std::nanf("");
  s.positions.push_back({nan, 0, 0});
  s.normals.push_back({0, 0, 1});
  s.uvs.push_back({nan, nan});
  s.indices.insert(s.indices.end(), {0, 1, 3, 0, 0, 1, 2, 3, 3});
  const std::vector<glm::vec4> t = s.tangents();
  for (int k = 0; k < 3; ++k) expectNear(t[k], {1, 0, 0, 1});
  for (const glm::vec4& any : t) EXPECT_NEAR(glm::length(glm::vec3(any)), 1.0f, 1e-6f);
}

// A wavy grid with seams: the order of triangles must not matter.
TEST(TangentSpace, DoesNotDependOnTheOrder) {
  Surface s;
  const int n = 12;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      s.positions.emplace_back(x, y, std::sin(0.7f * static_cast<float>(x * y)));
      s.normals.push_back(
          glm::normalize(glm::vec3(std::sin(static_cast<float>(x)), std::cos(static_cast<float>(y)), 3)));
      s.uvs.emplace_back(std::abs(x - n / 2), 0.3f * static_cast<float>(y * y));
    }
  for (uint32_t y = 0; y < n; ++y)
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + n + 1;
      s.indices.insert(s.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
  const std::vector<glm::vec4> t = s.tangents();
  Surface turned = s;
  std::reverse(turned.indices.begin(), turned.indices.end());
  for (size_t i = 0; i < turned.indices.size(); i += 3) std::swap(turned.indices[i], turned.indices[i + 2]);
  const std::vector<glm::vec4> u = turned.tangents();
  const size_t triangles = s.indices.size() / 3;
  for (size_t i = 0; i < triangles; ++i)
    for (size_t k = 0; k < 3; ++k) expectNear(u[3 * (triangles - 1 - i) + k], t[3 * i + k]);
}

struct Agreement {
  size_t corners = 0, near = 0, sameSign = 0;
};

/// Our tangents of a scene's primitives beside those that it stores; `within` in degrees. `flat`: each triangle's own.
Agreement agreement(const Scene& scene, double within, bool flat = false) {
  Agreement a;
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& p : mesh.primitives) {
      if (p.tangents.empty()) continue;
      const std::vector<glm::vec4> ours =
          cornerTangents(p.positions, flat ? std::vector<glm::vec3>() : p.normals, p.uv0, p.indices);
      for (size_t i = 0; i < p.indices.size(); ++i) {
        const glm::vec4& stored = p.tangents[p.indices[i]];
        const double c = glm::dot(glm::dvec3(ours[i]), glm::dvec3(stored));
        ++a.corners;
        a.near += std::acos(std::clamp(c, -1.0, 1.0)) <= glm::radians(within);
        a.sameSign += ours[i].w == stored.w;
      }
    }
  return a;
}

TEST(TangentSpace, AgreesWithTheStoredTangentsOfSponza) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  // Sponza's maps point down the image and its signs with them: the directions are the same, the signs the opposite.
  const Agreement sponza = agreement(importGltf(folder + "/sponza/sponza.glb"), 1.0);
  EXPECT_GT(sponza.corners, 3u * 262000);
  EXPECT_GE(sponza.near, 0.99 * sponza.corners);
  EXPECT_EQ(sponza.sameSign, 0u);
  std::cout << "within 1 degree of " << sponza.corners << " corners: " << 100.0 * sponza.near / sponza.corners
            << " %\n";
}

// The helmet stores, for all three corners, the direction of its triangle: not orthogonal to the normals (up to 50°
// off) and with a sign of +1 where the coordinates are mirrored too. That is no MikkTSpace, but it is the direction
// that the method starts from: what it makes of flat normals.
TEST(TangentSpace, AgreesWithTheTrianglesDirectionsThatTheHelmetStores) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const Scene scene = importGltf(folder + "/scifi-helmet/scifi-helmet.glb");
  const Agreement flat = agreement(scene, 1.0, true);
  EXPECT_EQ(flat.corners, 3u * 23358);
  EXPECT_GE(flat.near, 0.99 * flat.corners);
  const Primitive& p = scene.meshes[0].primitives[0];
  for (const glm::vec4& stored : p.tangents) ASSERT_EQ(stored.w, 1.0f);
  // Ours are orthogonal to the normals.
  const std::vector<glm::vec4> ours = cornerTangents(p.positions, p.normals, p.uv0, p.indices);
  for (size_t i = 0; i < ours.size(); ++i)
    ASSERT_NEAR(glm::dot(glm::vec3(ours[i]), p.normals[p.indices[i]]), 0.0f, 1e-5f);
  std::cout << "within 1 degree of " << flat.corners << " corners: " << 100.0 * flat.near / flat.corners << " %\n";
}

// The files come in pairs: with stored tangents, and without, so that ours are computed.
TEST(TangentSpace, AgreesWithTheAssetGenerator) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  Agreement all;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "asset-generator/Node_NegativeScale")) {
    if (entry.path().extension() != ".gltf") continue;
    const Agreement a = agreement(importGltf(entry.path().string()), 1.0);
    all.corners += a.corners;
    all.near += a.near;
    all.sameSign += a.sameSign;
  }
  EXPECT_GT(all.corners, 0u);
  EXPECT_EQ(all.near, all.corners);
  EXPECT_EQ(all.sameSign, all.corners);
}

TEST(TangentSpace, AreComputedWhereANormalMapNeedsThem) {
  Scene scene;
  scene.images.push_back({"blue", 1, 1, {128, 128, 255, 255}});
  scene.textures.push_back({0});
  scene.materials.resize(2);
  scene.materials[0].normalTexture.texture = 0;
  const Surface s = triangle({{0, 1}, {1, 1}, {0, 0}});
  Primitive with;
  with.positions = s.positions;
  with.uv0 = s.uvs;
  with.indices = s.indices;
  with.material = 0;
  Primitive without = with;
  without.material = 1;
  scene.meshes = {{"with", {with}}, {"without", {without}}};
  glm::mat4 mirrored(1.0f);
  mirrored[0][0] = -2.0f;
  scene.instances = {{0, -1, mirrored}, {1, -1, glm::mat4(1.0f)}};
  const PreparedScene p = prepareScene(scene);
  ASSERT_EQ(p.triangles.size(), 2u);
  const auto tangentOf = [&](uint32_t material) {
    for (const auto& t : p.triangles)
      if (t.material == material) return unpackTangent(p.vertices[t.v[0]].tangent);
    return glm::vec4(0.0f);
  };
  // Mirroring turns the direction and, as normals keep to the front, the sign.
  EXPECT_LT(glm::distance(tangentOf(0), glm::vec4(-1, 0, 0, -1)), 1e-3f);
  EXPECT_LT(glm::distance(tangentOf(1), glm::vec4(0, 0, 1, 1)), 1e-3f);  // unused
}

}  // namespace
}  // namespace weir::scene::test
