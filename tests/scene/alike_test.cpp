// Files that say the same thing in different ways must become the same geometry.
#include <fmt/format.h>

#include "scene_support.h"

#include <weir/scene/packing.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace weir::scene::test {
namespace {

struct Corner {
  glm::vec3 position, normal;
  glm::vec4 tangent;
  glm::vec2 uv;
};
using Corners = std::array<Corner, 3>;

/// The triangles of a scene in the world, in an order that depends on their places alone.
std::vector<Corners> worldTriangles(const Scene& scene) {
  const PreparedScene p = prepareScene(scene);
  std::vector<Corners> triangles;
  for (const PreparedInstance& instance : p.instances) {
    const TriangleRange& range = p.ranges[instance.range];
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      Corners corners;
      for (int k = 0; k < 3; ++k) {
        const uint32_t v = p.triangles[t].v[k];
        corners[k] = {glm::vec3(instance.toWorld * glm::vec4(p.positions[v], 1.0f)),
                      unpackNormal(p.vertices[v].normal),
                      unpackTangent(p.vertices[v].tangent),
                      {p.vertices[v].u, p.vertices[v].v}};
      }
      const auto place = [](const glm::vec3& q) { return glm::round(q * 1e4f); };
      const auto less = [&](const Corner& a, const Corner& b) {
        const glm::vec3 u = place(a.position), v = place(b.position);
        return std::tie(u.x, u.y, u.z) < std::tie(v.x, v.y, v.z);
      };
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
      triangles.push_back(corners);
    }
  }
  std::sort(triangles.begin(), triangles.end(), [](const Corners& a, const Corners& b) {
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) {
        const float x = std::round(a[k].position[c] * 1e4f), y = std::round(b[k].position[c] * 1e4f);
        if (x != y) return x < y;
      }
    return false;
  });
  return triangles;
}

/// `uv`: how far texture coordinates may lie apart; 2: they are not compared.
void expectAlike(const Scene& a, const Scene& b, float uv) {
  const std::vector<Corners> s = worldTriangles(a), t = worldTriangles(b);
  ASSERT_EQ(s.size(), t.size());
  ASSERT_FALSE(s.empty());
  for (size_t i = 0; i < s.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT(glm::distance(s[i][k].position, t[i][k].position), 1e-5f) << i;
      ASSERT_GT(glm::dot(s[i][k].normal, t[i][k].normal), 0.9999f) << i;
      ASSERT_GT(glm::dot(s[i][k].tangent, t[i][k].tangent), 1.999f) << i;
      ASSERT_LE(glm::distance(s[i][k].uv, t[i][k].uv), uv) << i;
    }
}

struct Group {
  const char* folder;
  std::vector<int> files;
  float uv;
};

TEST(Alike, AssetGeneratorGroups) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const Group groups[] = {
      // Float, byte and short coordinates in one buffer with the rest.
      {"Buffer_Interleaved", {0, 3, 4}, 0},
      // Byte and short colours. Their coordinates were written wrong (6e-39 in place of 1), so those differ.
      {"Buffer_Interleaved", {0, 1, 2}, 2},
      // Mirrors by matrix and by scale, with flat normals.
      {"Node_NegativeScale", {1, 4}, 0},
      {"Node_NegativeScale", {2, 5}, 0},
      {"Node_NegativeScale", {3, 6}, 0},
      // Mirrors with smooth normals; tangents computed in the first, stored in the second.
      {"Node_NegativeScale", {7, 10}, 0},
      {"Node_NegativeScale", {8, 11}, 0},
      {"Node_NegativeScale", {9, 12}, 0},
      // One plane of two primitives: shared textures, images, samplers, materials.
      {"Instancing", {0, 1, 2, 3}, 2},
      // Two planes: shared accessors, one mesh.
      {"Instancing", {4, 5, 6}, 2},
      // Two cubes at rest: shared animation samplers and their data.
      {"Instancing", {10, 11, 12}, 2},
  };
  for (const Group& group : groups) {
    const auto scene = [&](int i) {
      return importGltf(fmt::format("{0}/asset-generator/{1}/{1}_{2:02}.gltf", folder, group.folder, i));
    };
    const Scene first = scene(group.files[0]);
    for (int i : group.files) {
      SCOPED_TRACE(std::string(group.folder) + " " + std::to_string(i));
      expectAlike(first, scene(i), group.uv);
    }
  }
}

/// A quad with everything, as lists of plain floats with 32-bit indices.
struct Plain {
  std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f};
  std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  std::vector<float> uvs{0, 1, 1, 1, 1, 0, 0, 0};
  GltfText text(const std::vector<uint32_t>& indices = {0, 1, 2, 0, 2, 3}) const {
    GltfText g;
    const int p = g.vec3(positions), n = g.vec3(normals), uv = g.accessor(uvs, 5126, "VEC2", 4),
              i = g.accessor(indices, 5125, "SCALAR", indices.size());
    g.j["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", uv}}}, {"indices", i}}}}}};
    return g;
  }
};

json& primitive(GltfText& g) {
  return g.j["meshes"][0]["primitives"][0];
}

TEST(Alike, IndexWidthsStripsFansAndLists) {
  const Plain plain;
  const Scene expected = load(plain.text().text());
  GltfText bytes = plain.text();
  primitive(bytes)["indices"] = bytes.accessor<uint8_t>({0, 1, 2, 0, 2, 3}, 5121, "SCALAR", 6);
  expectAlike(expected, load(bytes.text()), 0);
  GltfText shorts = plain.text();
  primitive(shorts)["indices"] = shorts.accessor<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 6);
  expectAlike(expected, load(shorts.text()), 0);
  GltfText fan = plain.text({0, 1, 2, 3});
  primitive(fan)["mode"] = 6;
  expectAlike(expected, load(fan.text()), 0);
  GltfText strip = plain.text({1, 2, 0, 3});  // 1 2 0 and, turned, 2 3 0
  primitive(strip)["mode"] = 5;
  expectAlike(expected, load(strip.text()), 0);
  // A strip of one index a corner with a triangle that has no area where it turns.
  GltfText stitched = plain.text({0, 1, 2, 2, 0, 2, 3});
  primitive(stitched)["mode"] = 5;
  const Scene scene = load(stitched.text());
  expectAlike(expected, scene, 0);
  EXPECT_GT(prepareScene(scene).droppedTriangles, 0u);
}

TEST(Alike, InterleavedWithGaps) {
  const Plain plain;
  GltfText g = plain.text();
  std::vector<float> together;
  for (int i = 0; i < 4; ++i) {
    together.insert(together.end(), {-7, plain.uvs[2 * i], plain.uvs[2 * i + 1]});
    together.insert(together.end(), &plain.positions[3 * i], &plain.positions[3 * i] + 3);
    together.insert(together.end(), &plain.normals[3 * i], &plain.normals[3 * i] + 3);
    together.push_back(-9);
  }
  const int view = g.view(together);
  g.j["bufferViews"][view]["byteStride"] = 40;
  for (const auto& [accessor, offset] : {std::pair{0, 12}, {1, 24}, {2, 4}}) {
    g.j["accessors"][accessor]["bufferView"] = view;
    g.j["accessors"][accessor]["byteOffset"] = offset;
  }
  expectAlike(load(plain.text().text()), load(g.text()), 0);
}

TEST(Alike, SparseOverDataAndOverNothing) {
  const Plain plain;
  const Scene expected = load(plain.text().text());
  Plain wrong = plain;
  for (int c = 0; c < 3; ++c) wrong.positions[9 + c] = 77;
  GltfText over = wrong.text();
  const auto sparse = [](GltfText& g, const std::vector<uint8_t>& indices, const std::vector<float>& values) {
    const int i = g.view(indices), v = g.view(values);
    return json{{"count", indices.size()},
                {"indices", {{"bufferView", i}, {"componentType", 5121}}},
                {"values", {{"bufferView", v}}}};
  };
  over.j["accessors"][0]["sparse"] = sparse(over, {3}, {0, 1, 0.5f});
  expectAlike(expected, load(over.text()), 0);
  GltfText nothing = plain.text();
  nothing.j["accessors"][0].erase("bufferView");
  nothing.j["accessors"][0]["sparse"] = sparse(nothing, {1, 2, 3}, {1, 0, 0, 1, 1, 0, 0, 1, 0.5f});
  expectAlike(expected, load(nothing.text()), 0);
  // Indices too may be all zeros but for some.
  GltfText indices = plain.text();
  json& accessor = indices.j["accessors"][3];
  accessor = {{"componentType", 5125}, {"count", 6}, {"type", "SCALAR"}};
  const int i = indices.view<uint8_t>({1, 2, 4, 5}), v = indices.view<uint32_t>({1, 2, 2, 3});
  accessor["sparse"] = {
      {"count", 4}, {"indices", {{"bufferView", i}, {"componentType", 5121}}}, {"values", {{"bufferView", v}}}};
  expectAlike(expected, load(indices.text()), 0);
}

// KHR_mesh_quantization: each type that it allows, with the node's scale that undoes it.
TEST(Alike, QuantisedAttributes) {
  const Plain plain;
  const Scene expected = load(plain.text().text());
  const auto quantised = [&](auto one, int componentType, bool normalized) {
    using T = decltype(one);
    const double most = std::numeric_limits<T>::max();
    // Units a metre: an even number of them where values are plain, half of the range where they are normalised.
    const double scale =
        normalized ? most / 2 : std::min(most, 32766.0) / 2 - std::fmod(std::min(most, 32766.0) / 2, 2);
    GltfText g = plain.text();
    std::vector<T> data;
    for (int i = 0; i < 4; ++i) {
      for (int c = 0; c < 3; ++c) data.push_back(static_cast<T>(std::lround(plain.positions[3 * i + c] * scale)));
      data.push_back(0);  // elements start at multiples of four bytes
    }
    const int view = g.view(data);
    g.j["bufferViews"][view]["byteStride"] = 4 * sizeof(T);
    g.j["accessors"][0] = {{"bufferView", view},
                           {"componentType", componentType},
                           {"count", 4},
                           {"type", "VEC3"},
                           {"normalized", normalized}};
    const double back = normalized ? 2.0 : 1.0 / scale;
    g.j["nodes"][0]["scale"] = {back, back, back};
    std::vector<int8_t> normals;
    for (int i = 0; i < 4; ++i) normals.insert(normals.end(), {0, 0, 127, 0});
    const int normalView = g.view(normals);
    g.j["bufferViews"][normalView]["byteStride"] = 4;
    g.j["accessors"][1] = {
        {"bufferView", normalView}, {"componentType", 5120}, {"count", 4}, {"type", "VEC3"}, {"normalized", true}};
    g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Scene scene = load(g.text());
    EXPECT_TRUE(scene.warnings.empty());
    const std::vector<Corners> a = worldTriangles(expected), b = worldTriangles(scene);
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT(glm::distance(a[i][k].position, b[i][k].position), 1.1 / scale);
        EXPECT_GT(glm::dot(a[i][k].normal, b[i][k].normal), 0.9999f);
      }
  };
  for (const bool normalized : {false, true}) {
    quantised(int8_t{}, 5120, normalized);
    quantised(uint8_t{}, 5121, normalized);
    quantised(int16_t{}, 5122, normalized);
    quantised(uint16_t{}, 5123, normalized);
  }
}

TEST(Alike, MirroredAndStretchedNodesKeepFrontsAndNormals) {
  // A tilted triangle with its exact normal, under transforms of every kind.
  GltfText g;
  const std::vector<float> positions = {0, 0, 0, 1, 0, 1, 0, 1, 0};
  const int p = g.vec3(positions);
  const float h = std::sqrt(0.5f);
  const int n = g.vec3({-h, 0, h, -h, 0, h, -h, 0, h});
  g.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", p}, {"NORMAL", n}}}}}}}};
  for (const glm::vec3 scale :
       {glm::vec3(-1, 1, 1), glm::vec3(-2, -3, -4), glm::vec3(1, -5, 1), glm::vec3(3, 0.1f, 1), glm::vec3(-1, -1, 9)}) {
    g.j["nodes"][0]["scale"] = {scale.x, scale.y, scale.z};
    g.j["nodes"][0]["rotation"] = {0.5, 0.5, -0.5, 0.5};
    const std::vector<Corners> t = worldTriangles(load(g.text()));
    ASSERT_EQ(t.size(), 1u);
    // In glTF a mirroring transform turns the winding, so the front stays where the transformed normal points.
    const glm::vec3 front =
        glm::normalize(glm::cross(t[0][1].position - t[0][0].position, t[0][2].position - t[0][0].position));
    for (const Corner& corner : t[0]) EXPECT_GT(glm::dot(corner.normal, front), 0.9999f);
  }
}

TEST(Alike, DegenerateAndBrokenTrianglesAreDroppedAndCounted) {
  const Plain plain;
  GltfText g = plain.text({0, 1, 2, 0, 2, 3, 1, 1, 2, 0, 4, 1, 4, 4, 4});
  Plain broken = plain;
  broken.positions.insert(broken.positions.end(), {0, std::nanf(""), 0});
  broken.normals.insert(broken.normals.end(), {0, 0, 1});
  broken.uvs.insert(broken.uvs.end(), {0, 0});
  g = broken.text({0, 1, 2, 0, 2, 3, 1, 1, 2, 0, 4, 1, 4, 4, 4});
  g.j["accessors"][2]["count"] = 5;
  const Scene scene = load(g.text());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("not finite"), std::string::npos);
  expectAlike(load(plain.text().text()), scene, 0);
  EXPECT_EQ(prepareScene(scene).droppedTriangles, 3u);
}

TEST(Alike, PointsAndLinesAreLeftOutWithOneWarning) {
  const Plain plain;
  GltfText g = plain.text();
  json& primitives = g.j["meshes"][0]["primitives"];
  for (int mode : {0, 1, 2, 3}) {
    primitives.push_back(primitives[0]);
    primitives.back()["mode"] = mode;
  }
  const Scene scene = load(g.text());
  EXPECT_EQ(scene.warnings, std::vector<std::string>{"points and lines are left out"});
  expectAlike(load(plain.text().text()), scene, 0);
}

}  // namespace
}  // namespace weir::scene::test
