// Files that must be refused, each with a message that says where and why.
#include "scene_support.h"

namespace weir::scene::test {
namespace {

void expectRefused(const GltfText& g, const std::string& part, const ImportLimits& limits = {}) {
  const std::string message = refusal(g.text(), limits);
  EXPECT_NE(message.find(part), std::string::npos) << "message: " << message << "\nlacks: " << part;
  EXPECT_NE(message.find("test.gltf"), std::string::npos) << message;
}

TEST(ImportGuards, AcceptsThePlainTriangle) {
  const Scene scene = load(GltfText::triangle().text());
  EXPECT_EQ(summarize(scene).storedTriangles, 1u);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(ImportGuards, MissingOrStrangeFiles) {
  const TempFolder folder;
  EXPECT_THROW(importGltf((folder.path() / "absent.glb").string()), InputError);
  EXPECT_THROW(importGltf(folder.path().string()), InputError);  // a folder
  EXPECT_THROW(importGltf(folder.write("empty.glb", "")), InputError);
  EXPECT_THROW(importGltf(folder.write("short.glb", "glTF")), InputError);
  ImportLimits small;
  small.fileBytes = 10;
  EXPECT_THROW(importGltf(folder.write("big.gltf", GltfText::triangle().text()), small), InputError);
}

TEST(ImportGuards, EveryPrefixAndEveryFlippedByteOfAGlb) {
  const TempFolder folder;
  const std::string glb = GltfText::triangle().glb();
  ASSERT_NO_THROW(importGltf(folder.write("whole.glb", glb)));
  for (size_t n = 0; n < glb.size(); ++n)
    EXPECT_THROW(importGltf(folder.write("cut.glb", glb.substr(0, n))), InputError) << n;
  for (size_t n = 0; n < glb.size(); ++n)
    for (const char flip : {char(0xff), char(0x01), char(0x80)}) {
      std::string broken = glb;
      broken[n] = static_cast<char>(broken[n] ^ flip);
      try {
        prepareScene(importGltf(folder.write("flip.glb", broken)));
      } catch (const InputError&) {
      }
    }
}

TEST(ImportGuards, AccessorsThatLeaveTheirView) {
  GltfText g = GltfText::triangle();
  g.j["accessors"][0]["count"] = 1000;
  expectRefused(g, "/accessors/0");
  g = GltfText::triangle();
  g.j["accessors"][0]["byteOffset"] = 4;
  expectRefused(g, "/accessors/0");
  g = GltfText::triangle();
  g.j["accessors"][0]["count"] = 9007199254740992ull;  // count · stride would wrap in 64 bits without care
  expectRefused(g, "/accessors/0");
  g = GltfText::triangle();
  g.j["bufferViews"][0]["byteLength"] = 1 << 20;
  expectRefused(g, "/bufferViews/0");
  g = GltfText::triangle();
  g.j["bufferViews"][0]["byteStride"] = 4;
  expectRefused(g, "byteStride");
  g = GltfText::triangle();
  g.j["bufferViews"][0]["byteStride"] = 252;
  expectRefused(g, "/accessors/0");
}

TEST(ImportGuards, IndicesAndReferencesOutOfRange) {
  GltfText g = GltfText::triangle();
  g.binary[g.binary.size() - 2] = 3;
  expectRefused(g, "/meshes/0/primitives/0/indices");
  for (const json& bad : {json(2), json(-1), json(1.5), json("0"), json(nullptr), json(1e300)}) {
    g = GltfText::triangle();
    g.j["meshes"][0]["primitives"][0]["indices"] = bad;
    expectRefused(g, "/meshes/0/primitives/0/indices");
    g = GltfText::triangle();
    g.j["nodes"][0]["mesh"] = bad;
    expectRefused(g, "/nodes/0/mesh");
    g = GltfText::triangle();
    g.j["bufferViews"][1]["buffer"] = bad;
    expectRefused(g, "/bufferViews/1/buffer");
  }
  g = GltfText::triangle();
  g.j["meshes"][0]["primitives"][0]["material"] = 0;
  expectRefused(g, "0 materials");
}

TEST(ImportGuards, NodesThatAreNoTree) {
  GltfText g = GltfText::triangle();
  g.j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
  expectRefused(g, "ancestor");
  g.j["nodes"] = {{{"children", {0}}}};
  expectRefused(g, "ancestor");
  g.j["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  expectRefused(g, "already a child");
  g.j["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
  expectRefused(g, "already a child");
  json chain = json::array();
  for (int i = 1; i <= 2000; ++i) chain.push_back({{"children", {i}}});
  chain.push_back({{"mesh", 0}});
  g.j["nodes"] = chain;
  expectRefused(g, "deeper than");
  // A cycle that no scene reaches is a fault all the same.
  g.j["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
  expectRefused(g, "ancestor");
}

TEST(ImportGuards, DeepJsonAndBrokenText) {
  EXPECT_NE(refusal(std::string(1'000'000, '[')).find("deep"), std::string::npos);
  const GltfText g = GltfText::triangle();
  std::string text = g.text();
  text.insert(1, "\"extras\":" + std::string(5000, '[') + std::string(5000, ']') + ",");
  EXPECT_NE(refusal(text).find("deep"), std::string::npos);
  std::string nodes = "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}";
  for (int i = 0; i < 1'000'000; ++i) nodes += ",{}";
  EXPECT_NE(refusal(nodes + "]}").find("JSON objects"), std::string::npos);
  refusal("");
  refusal("null");
  refusal("{}");
  refusal(std::string("{\"asset\":{\"version\":\"2.0\"},\"x\":\"\xff\xfe\"}"));
}

TEST(ImportGuards, UrisStayInTheFolder) {
  const TempFolder folder;
  GltfText g = GltfText::triangle();
  folder.write("outside.bin", g.binary);
  folder.write("in/beside.bin", g.binary);
  fs::create_symlink(folder.path() / "outside.bin", folder.path() / "in" / "link.bin");
  const auto with = [&](const std::string& uri) {
    g.j["buffers"] = {{{"byteLength", g.binary.size()}, {"uri", uri}}};
    return folder.write("in/scene.gltf", g.text());
  };
  EXPECT_NO_THROW(importGltf(with("beside.bin")));
  EXPECT_NO_THROW(importGltf(with("./beside%2Ebin")));
  for (const std::string uri : {"../outside.bin", "%2e%2e/outside.bin", "link.bin", "/etc/passwd", "file:///etc/passwd",
                                "", "absent.bin", "x/../../outside.bin", "http://127.0.0.1/x.bin", "."}) {
    try {
      importGltf(with(uri));
      ADD_FAILURE() << uri << " was read";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("/buffers/0"), std::string::npos) << e.what();
    }
  }
}

TEST(ImportGuards, ExtensionsRequiredAreRefusedByName) {
  for (const std::string name :
       {"KHR_meshopt_compression", "KHR_texture_basisu", "KHR_materials_transmission", "X_y"}) {
    GltfText g = GltfText::triangle();
    g.j["extensionsUsed"] = {name};
    const Scene scene = load(g.text());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find(name), std::string::npos);
    g.j["extensionsRequired"] = {name};
    expectRefused(g, name);
  }
}

/// A PNG header alone, with the given size; enough for every check before decoding.
std::string pngHeader(uint32_t width, uint32_t height) {
  std::string png = "\x89PNG\r\n\x1a\n";
  const auto big = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return png + big(13) + "IHDR" + big(width) + big(height) + std::string("\x08\x06\0\0\0", 5) + "\0\0\0\0";
}

TEST(ImportGuards, ImagesAreCheckedBeforeTheyAreDecoded) {
  GltfText g = GltfText::triangle();
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  g.j["textures"] = {{{"source", 0}}};
  const auto with = [&](const std::string& bytes) {
    g.j["images"] = {{{"uri", "data:image/png;base64," + GltfText::base64(bytes)}}};
    return g;
  };
  expectRefused(with(pngHeader(100000, 10)), "/images/0");
  expectRefused(with(pngHeader(16384, 16384)), "can't come from");
  expectRefused(with(pngHeader(8, 8)), "/images/0");
  expectRefused(with("not an image"), "neither PNG nor JPEG");
  expectRefused(with(""), "/images/0");
  g.j["images"] = {{{"uri", "absent.png"}}};
  expectRefused(g, "absent.png");
}

TEST(ImportGuards, RepeatedGeometryIsBounded) {
  // A thousand primitives over the same 3000 triangles: small in the file, large in memory.
  GltfText g;
  std::vector<float> positions(3 * 9000, 0.0f);
  g.vec3(positions);
  json primitives = json::array();
  for (int i = 0; i < 1000; ++i) primitives.push_back({{"attributes", {{"POSITION", 0}}}});
  g.j["meshes"] = {{{"primitives", primitives}}};
  expectRefused(g, "more triangles than");
  g = GltfText::triangle();
  json nodes = json::array(), roots = json::array();
  for (int i = 0; i < 100; ++i) {
    nodes.push_back({{"mesh", 0}});
    roots.push_back(i);
  }
  g.j["nodes"] = nodes;
  g.j["scenes"][0]["nodes"] = roots;
  ImportLimits limits;
  limits.triangles = 99;
  expectRefused(g, "with all instances", limits);
}

TEST(ImportGuards, TransformsThatAreNotFinite) {
  GltfText g = GltfText::triangle();
  g.j["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
  expectRefused(g, "not finite");
}

TEST(ImportGuards, NaNAndDegenerateTrianglesAreDroppedAndCounted) {
  GltfText g;
  const float nan = std::nanf("");
  g.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, INFINITY, 0, 0, 0.5f, 0, 0});
  g.accessor<uint8_t>({0, 1, 2, 0, 1, 3, 0, 4, 2, 0, 0, 1, 0, 5, 1}, 5121, "SCALAR", 15);
  g.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  const Scene scene = load(g.text());
  const PreparedScene prepared = prepareScene(scene);
  EXPECT_EQ(prepared.triangles.size(), 1u);
  EXPECT_EQ(prepared.droppedTriangles, 4u);
  EXPECT_EQ(prepared.bounds.high, glm::vec3(1, 1, 0));
}

}  // namespace
}  // namespace weir::scene::test
