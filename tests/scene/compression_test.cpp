// KHR_draco_mesh_compression and EXT_meshopt_compression, against files that their own encoders wrote.
#include "compressed_files.h"

#include <algorithm>
#include <array>
#include <set>

namespace weir::scene::test {
namespace {

/// Corner by corner, in any order of triangles and any rotation of their corners; attributes to within the coders'
/// rounding.
void expectGrid(const Scene& scene, const Grid& grid) {
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].primitives.size(), 1u);
  EXPECT_TRUE(scene.warnings.empty());
  const Primitive& p = scene.meshes[0].primitives[0];
  EXPECT_EQ(p.positions.size(), grid.vertices());
  ASSERT_EQ(p.normals.size(), p.positions.size());
  ASSERT_EQ(p.uv0.size(), p.positions.size());
  // Each vertex lies on its own point of the grid; by that it is known again.
  std::vector<uint32_t> source;
  for (size_t i = 0; i < p.positions.size(); ++i) {
    const int row = static_cast<int>(std::lround(std::sqrt(static_cast<double>(grid.vertices()))));
    const auto at = static_cast<uint32_t>(std::lround(p.positions[i].y) * row + std::lround(p.positions[i].x));
    ASSERT_LT(at, grid.vertices());
    source.push_back(at);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(p.positions[i][c], grid.positions[3 * at + c], 1e-3f);
      EXPECT_NEAR(p.normals[i][c], grid.normals[3 * at + c], 2e-3f);
    }
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(p.uv0[i][c], grid.uvs[2 * at + c], 1e-3f);
  }
  const auto triangles = [](const std::vector<uint32_t>& indices, const auto& vertex) {
    std::multiset<std::array<uint32_t, 3>> set;
    for (size_t t = 0; t < indices.size(); t += 3) {
      std::array<uint32_t, 3> v = {vertex(indices[t]), vertex(indices[t + 1]), vertex(indices[t + 2])};
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      set.insert(v);
    }
    return set;
  };
  EXPECT_EQ(triangles(p.indices, [&](uint32_t i) { return source[i]; }),
            triangles(grid.indices, [](uint32_t i) { return i; }));
}

TEST(Draco, BothWaysToStoreConnectivity) {
  const Grid grid(17);
  for (const bool sequential : {false, true}) expectGrid(load(dracoFile(grid, sequential).text()), grid);
}

TEST(Draco, FaultsAreRefusedWithTheirPlace) {
  const Grid grid(5);
  const GltfText good = dracoFile(grid);
  const std::string place = "/meshes/0/primitives/0";
  const auto extension = [](GltfText& g) -> json& {
    return g.j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  };
  GltfText g = good;
  extension(g)["attributes"]["NORMAL"] = 77;
  EXPECT_NE(refusal(g.text()).find(place + "/extensions/KHR_draco_mesh_compression: the data has no attribute 77"),
            std::string::npos);
  g = good;  // positions that are not compressed, but too few
  extension(g)["attributes"].erase("POSITION");
  g.j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = g.vec3({0, 0, 0, 1, 0, 0});
  EXPECT_NE(refusal(g.text()).find(place + ": 2 positions for 36 compressed vertices"), std::string::npos);
  g = good;
  g.j["bufferViews"][0]["byteLength"] = 40;  // cut short
  EXPECT_NE(refusal(g.text()).find(place + "/extensions/KHR_draco_mesh_compression"), std::string::npos);
  g = good;
  extension(g).erase("bufferView");
  EXPECT_NE(refusal(g.text()).find("lacks \"bufferView\""), std::string::npos);
  g = good;
  extension(g)["attributes"]["NORMAL"] = -1;
  EXPECT_NE(refusal(g.text()).find("/attributes/NORMAL"), std::string::npos);
  g = good;
  g.binary[5] = 9;  // a version that there isn't
  EXPECT_NE(refusal(g.text()).find("version"), std::string::npos);
  // Says that it holds billions of vertices: refused before memory is taken for them.
  g = good;
  g.binary.replace(12, 5, "\xff\xff\xff\xff\x0f");
  EXPECT_NE(refusal(g.text()).find("announces"), std::string::npos);
}

TEST(Draco, TheCompressedDuckIsADuck) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const Scene scene = importGltf(folder + "/duck-draco/Duck.gltf");
  EXPECT_TRUE(scene.warnings.empty());
  const SceneSummary s = summarize(scene);
  EXPECT_EQ(s.storedTriangles, 4212u);
  EXPECT_EQ(s.vertices, 2399u);
  // The bounds that the file's accessor states, to within Draco's rounding.
  const Primitive& p = scene.meshes[0].primitives[0];
  Bounds bounds;
  for (const glm::vec3& position : p.positions) bounds.add(position);
  EXPECT_LT(glm::distance(bounds.high, glm::vec3(96.26074f, 164.09024f, 54.02973f)), 0.3f);
  EXPECT_LT(glm::distance(bounds.low, glm::vec3(-69.37933f, 9.84853f, -61.40904f)), 0.3f);
  // The same duck, quantised: same surface in the world, to within both roundings.
  const PreparedScene ours = prepareScene(scene),
                      other = prepareScene(importGltf(folder + "/duck-quantized/Duck.gltf"));
  const auto area = [](const PreparedScene& prepared) {
    double sum = 0.0;
    for (const auto& t : prepared.triangles) {
      const glm::dvec3 a(prepared.positions[t.v[0]]), b(prepared.positions[t.v[1]]), c(prepared.positions[t.v[2]]);
      sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
  };
  EXPECT_NEAR(area(ours) / area(other), 1.0, 5e-3);
}

TEST(Meshopt, AttributesTrianglesAndSequences) {
  const Grid grid(17);
  for (const bool triangles : {true, false}) expectGrid(load(meshoptFile(grid, triangles).text()), grid);
}

TEST(Meshopt, PlainAttributesAndShortIndices) {
  GltfText g = GltfText::triangle();
  const std::vector<float> positions = {0, 0, 0, 2, 0, 0, 0, 3, 0};
  g.j["accessors"][0]["bufferView"] = meshoptView(g, meshoptVertices(positions.data(), 3, 12), 3, 12, "ATTRIBUTES");
  g.j["accessors"][1]["bufferView"] = meshoptView(g, meshoptIndices({2, 0, 1}, 3, true), 3, 2, "TRIANGLES");
  g.j["extensionsUsed"] = {"EXT_meshopt_compression"};
  g.j["buffers"] = {
      {{"byteLength", g.binary.size()}, {"uri", "data:application/octet-stream;base64," + GltfText::base64(g.binary)}},
      {{"byteLength", 64}}};
  const Scene scene = load(g.text());
  const Primitive& p = scene.meshes[0].primitives[0];
  Bounds bounds;
  for (const glm::vec3& position : p.positions) bounds.add(position);
  EXPECT_EQ(bounds.high, glm::vec3(2, 3, 0));
  EXPECT_GT(glm::cross(p.positions[p.indices[1]] - p.positions[p.indices[0]],
                       p.positions[p.indices[2]] - p.positions[p.indices[0]])
                .z,
            0.0f);
}

TEST(Meshopt, FaultsAreRefusedWithTheirPlace) {
  const GltfText good = meshoptFile(Grid(5));
  const auto refused = [&](int view, const char* key, const json& value, const std::string& word) {
    GltfText g = good;
    g.j["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
    const std::string message = refusal(g.text());
    EXPECT_NE(message.find("/bufferViews/" + std::to_string(view) + "/extensions/EXT_meshopt_compression"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find(word), std::string::npos) << message;
  };
  refused(0, "mode", "VERTICES", "unknown mode");
  refused(0, "filter", "ROUND", "filter \"ROUND\"");
  refused(0, "filter", "QUATERNION", "byteStride 12");
  refused(0, "byteStride", 13, "byteStride 13");
  refused(3, "byteStride", 3, "byteStride 3");
  refused(3, "filter", "EXPONENTIAL", "mode TRIANGLES");
  refused(3, "count", 151, "no triangles");
  refused(0, "count", 2000000000, "can't come from");
  refused(0, "byteLength", 1 << 20, "of a buffer of");
  refused(0, "byteLength", 20, "broken");
  refused(0, "count", json(), "expected an integer");
}

}  // namespace
}  // namespace weir::scene::test
