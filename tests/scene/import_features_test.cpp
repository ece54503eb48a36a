// What the importer reads, feature by feature.
#include "scene_support.h"

namespace weir::scene::test {
namespace {

const Primitive& only(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0);
}

TEST(ImportFeatures, GlbAndJsonAgree) {
  const TempFolder folder;
  const GltfText g = GltfText::triangle();
  const Scene a = importGltf(folder.write("a.glb", g.glb())), b = load(g.text());
  EXPECT_EQ(only(a).positions, only(b).positions);
  EXPECT_EQ(only(a).indices, only(b).indices);
}

TEST(ImportFeatures, StripsFansAndUnindexedKeepTheWinding) {
  GltfText g;
  g.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});  // a strip that goes up
  g.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 5}}}}}};
  const auto allFaceFront = [](const Scene& scene, size_t triangles) {
    const PreparedScene p = prepareScene(scene);
    ASSERT_EQ(p.triangles.size(), triangles);
    for (const auto& t : p.triangles)
      EXPECT_GT(glm::cross(p.positions[t.v[1]] - p.positions[t.v[0]], p.positions[t.v[2]] - p.positions[t.v[0]]).z,
                0.0f);
  };
  allFaceFront(load(g.text()), 3);
  GltfText fan;
  fan.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0});
  fan.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 6}}}}}};
  allFaceFront(load(fan.text()), 3);
  GltfText list;
  list.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
  list.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  allFaceFront(load(list.text()), 2);
  list.j["meshes"][0]["primitives"][0]["mode"] = 0;
  const Scene points = load(list.text());
  EXPECT_TRUE(points.meshes[0].primitives.empty());
  EXPECT_EQ(points.warnings.size(), 1u);
}

TEST(ImportFeatures, UnusedVerticesAreLeftOut) {
  GltfText g;
  g.vec3({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 8, 8, 8});
  g.accessor<uint32_t>({3, 1, 2}, 5125, "SCALAR", 3);
  g.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  const Scene scene = load(g.text());
  EXPECT_EQ(only(scene).positions.size(), 3u);
  EXPECT_EQ(only(scene).positions[0], glm::vec3(0, 1, 0));
  EXPECT_EQ(only(scene).indices, (std::vector<uint32_t>{0, 1, 2}));
}

TEST(ImportFeatures, NormalisedInterleavedAndSparse) {
  GltfText g = GltfText::triangle();
  // Two shorts of UV at a stride of 8.
  g.j["bufferViews"].push_back({});
  g.j["bufferViews"].erase(2);
  const int view = g.view<uint16_t>({0, 65535, 7, 7, 32768, 0, 7, 7, 65535, 65535, 7, 7});
  g.j["bufferViews"][view]["byteStride"] = 8;
  g.j["accessors"].push_back(
      {{"bufferView", view}, {"componentType", 5123}, {"normalized", true}, {"count", 3}, {"type", "VEC2"}});
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
  const int indices = g.view<uint8_t>({1}), values = g.view<float>({5, 0, 0});
  g.j["accessors"][0]["sparse"] = {{"count", 1},
                                   {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                   {"values", {{"bufferView", values}}}};
  const Scene scene = load(g.text());
  EXPECT_EQ(only(scene).positions[1], glm::vec3(5, 0, 0));
  EXPECT_EQ(only(scene).uv0[0], glm::vec2(0, 1));
  EXPECT_NEAR(only(scene).uv0[1].x, 32768.0f / 65535.0f, 1e-7f);
  g.j["accessors"][0]["sparse"]["indices"]["byteOffset"] = 1;
  EXPECT_NE(refusal(g.text()).find("/accessors/0/sparse"), std::string::npos);
}

TEST(ImportFeatures, MaterialsInFull) {
  GltfText g = GltfText::triangle();
  g.j["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  g.j["materials"] = {
      {{"name", "m"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}},
       {"alphaMode", "BLEND"},
       {"alphaCutoff", 0.7},
       {"doubleSided", true}}};
  g.j["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = load(g.text());
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.emission, glm::vec3(20, 10, 0));
  EXPECT_EQ(m.alphaMode, AlphaMode::Blend);
  EXPECT_EQ(m.alphaCutoff, 0.7f);
  EXPECT_TRUE(m.doubleSided);
  EXPECT_TRUE(scene.warnings.empty());
  const PreparedScene p = prepareScene(scene);
  EXPECT_EQ(p.materials.size(), 2u);
  EXPECT_EQ(p.materials[0].flags, kMaterialBlend | kMaterialDoubleSided | kMaterialEmissive);
  EXPECT_EQ(p.ranges[1].masked, 1u);
  ASSERT_EQ(p.lights.size(), 1u);
  EXPECT_EQ(p.lights[0].kind, static_cast<uint32_t>(GpuLightKind::Triangle) | kLightDoubleSided);
}

TEST(ImportFeatures, LightsAndCamerasInTheWorld) {
  GltfText g = GltfText::triangle();
  g.j["extensionsUsed"] = {"KHR_lights_punctual"};
  g.j["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0.25}}, {"intensity", 8}, {"range", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
      {{"type", "directional"}, {"intensity", 2}}};
  g.j["cameras"] = {{{"type", "perspective"}, {"name", "eye"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
  const auto light = [](int i) { return json{{"KHR_lights_punctual", {{"light", i}}}}; };
  // The parent turns -Z to -X and doubles lengths.
  const double h = std::sqrt(0.5);
  g.j["nodes"] = {{{"rotation", {0, h, 0, h}}, {"scale", {2, 2, 2}}, {"children", {1, 2, 3, 4, 5}}},
                  {{"extensions", light(0)}, {"translation", {0, 0, -1}}},
                  {{"extensions", light(1)}},
                  {{"extensions", light(2)}},
                  {{"camera", 0}, {"translation", {0, 1, 0}}},
                  {{"mesh", 0}}};
  const Scene s = load(g.text());
  ASSERT_EQ(s.lights.size(), 3u);
  EXPECT_EQ(s.lights[0].intensity, glm::vec3(8, 4, 2));
  EXPECT_LT(glm::distance(s.lights[0].position, glm::vec3(-2, 0, 0)), 1e-6f);
  EXPECT_EQ(s.lights[0].range, 3.0f);
  EXPECT_EQ(s.lights[1].kind, LightKind::Spot);
  EXPECT_LT(glm::distance(s.lights[1].direction, glm::vec3(-1, 0, 0)), 1e-6f);
  EXPECT_EQ(s.lights[2].kind, LightKind::Directional);
  ASSERT_EQ(s.cameras.size(), 1u);
  EXPECT_LT(glm::distance(s.cameras[0].eye, glm::vec3(0, 2, 0)), 1e-6f);
  EXPECT_LT(glm::distance(s.cameras[0].forward, glm::vec3(-1, 0, 0)), 1e-6f);
  EXPECT_LT(glm::distance(s.cameras[0].up, glm::vec3(0, 1, 0)), 1e-6f);

  EXPECT_EQ(chooseCamera(s, "", 1.0f).name, "eye");
  EXPECT_EQ(chooseCamera(s, "eye", 1.0f).verticalFov, s.cameras[0].verticalFov);
  const Camera given = chooseCamera(s, "0,0,5,0,0,0,60", 1.0f);
  EXPECT_EQ(given.forward, glm::vec3(0, 0, -1));
  EXPECT_NEAR(given.verticalFov, 1.0471976f, 1e-6f);
  for (const std::string bad : {"eey", "1,2,3", "0,0,0,0,0,0", "0,0,5,0,0,0,180", "0,0,5,0,0,nan", "0,0,5,0,0,0,60,1"})
    EXPECT_THROW(chooseCamera(s, bad, 1.0f), InputError) << bad;
  EXPECT_NO_THROW(chooseCamera(s, "0,5,0,0,0,0", 1.0f));  // straight down
}

TEST(ImportFeatures, AFramingCameraSeesEveryCorner) {
  Bounds bounds;
  bounds.add({-3, 1, -2});
  bounds.add({5, 2, 4});
  for (const float aspect : {0.3f, 1.0f, 2.5f}) {
    const Camera c = framingCamera(bounds, aspect);
    for (int i = 0; i < 8; ++i) {
      const glm::vec3 p(i & 1 ? 5 : -3, i & 2 ? 2 : 1, i & 4 ? 4 : -2), d = p - c.eye;
      const float depth = glm::dot(d, c.forward), slope = std::tan(c.verticalFov / 2);
      EXPECT_GT(depth, 0.0f);
      EXPECT_LE(std::abs(d.y), depth * slope);
      EXPECT_LE(std::abs(d.x), depth * slope * aspect);
    }
  }
}

TEST(ImportFeatures, TwoUvSets) {
  GltfText g = GltfText::triangle();
  g.accessor<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2", 3);
  g.accessor<float>({5, 5, 6, 5, 5, 6}, 5126, "VEC2", 3);
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 3;
  g.j["meshes"][0]["primitives"][0]["material"] = 0;
  g.j["textures"] = {json::object()};
  g.j["images"] = json::array();
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}}};
  // The texture has no source, so the slot goes, and with it the second set.
  EXPECT_EQ(only(load(g.text())).uv0[0], glm::vec2(0, 0));
}

TEST(GeneratedLights, TotalDoesNotDependOnNAndPlacesStay) {
  const Scene base = load(GltfText::triangle().text());
  const float r = worldBounds(base).radius();
  Scene few = base, many = base, other = base;
  addGeneratedLights(few, 10, 1);
  addGeneratedLights(many, 1000, 1);
  addGeneratedLights(other, 10, 2);
  const auto total = [](const Scene& s) {
    double sum = 0.0;
    for (const auto& light : s.lights) sum += luminance(light.intensity);
    return sum;
  };
  EXPECT_NEAR(total(few), kGeneratedIntensity * r * r, 1e-4 * r * r);
  EXPECT_NEAR(total(many), kGeneratedIntensity * r * r, 1e-4 * r * r);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(few.lights[i].position, many.lights[i].position);
    EXPECT_NE(few.lights[i].position, other.lights[i].position);
  }
  Scene empty;
  EXPECT_THROW(addGeneratedLights(empty, 1, 1), InputError);
}

}  // namespace
}  // namespace weir::scene::test
