// Materials, textures and vertex attributes of glTF's extensions as the importer reads them, and what is refused.
#include "scene_support.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <cmath>

namespace weir::scene::test {
namespace {

/// A PNG without compression. `rows` holds each row's bytes without the filter byte.
std::string png(uint32_t width, uint32_t height, int depth, int colorType, const std::vector<std::string>& rows,
                const std::string& palette = {}, const std::string& transparency = {}) {
  const auto big = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    uint32_t crc = ~0u;
    for (const char c : type + data) {
      crc ^= static_cast<uint8_t>(c);
      for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return big(static_cast<uint32_t>(data.size())) + type + data + big(~crc);
  };
  std::string raw;
  for (const std::string& row : rows) raw += '\0' + row;
  uint32_t a = 1, b = 0;
  for (const char c : raw) {
    a = (a + static_cast<uint8_t>(c)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<uint16_t>(raw.size());
  std::string deflated{'\x78', '\x01', '\x01', char(size), char(size >> 8), char(~size), char(~size >> 8)};
  deflated += raw + big((b << 16) | a);
  std::string out = "\x89PNG\r\n\x1a\n";
  out += chunk("IHDR", big(width) + big(height) + std::string{char(depth), char(colorType), 0, 0, 0});
  if (!palette.empty()) out += chunk("PLTE", palette);
  if (!transparency.empty()) out += chunk("tRNS", transparency);
  return out + chunk("IDAT", deflated) + chunk("IEND", "");
}

const std::string kPixel = png(1, 1, 8, 2, {"\x10\x20\x30"});

GltfText withImage(const std::string& bytes) {
  GltfText g = GltfText::triangle();
  g.j["meshes"][0]["primitives"][0]["material"] = 0;
  g.j["images"] = {{{"uri", "data:image/png;base64," + GltfText::base64(bytes)}}};
  g.j["textures"] = {{{"source", 0}}};
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  return g;
}

GltfText withExtension(const std::string& name, const json& content) {
  GltfText g = withImage(kPixel);
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {name};
  g.j["materials"][0]["extensions"] = {{name, content}};
  return g;
}

std::vector<int> texels(const std::string& bytes) {
  const Scene scene = load(withImage(bytes).text());
  return {scene.images.at(0).rgba.begin(), scene.images[0].rgba.end()};
}

TEST(MaterialImport, EveryKindOfPng) {
  using V = std::vector<int>;
  EXPECT_EQ(texels(png(2, 1, 8, 0, {std::string("\x40\xff", 2)})), (V{64, 64, 64, 255, 255, 255, 255, 255})) << "grey";
  EXPECT_EQ(texels(png(1, 1, 8, 4, {"\x40\x80"})), (V{64, 64, 64, 128})) << "grey with alpha";
  EXPECT_EQ(texels(png(1, 1, 8, 2, {"\x01\x02\x03"})), (V{1, 2, 3, 255})) << "colour";
  EXPECT_EQ(texels(png(1, 1, 8, 6, {"\x01\x02\x03\x04"})), (V{1, 2, 3, 4})) << "colour with alpha";
  EXPECT_EQ(texels(png(2, 1, 8, 3, {std::string("\x01\x00", 2)}, "\x0a\x0b\x0c\x64\x65\x66", std::string("\x80", 1))),
            (V{100, 101, 102, 255, 10, 11, 12, 128}))
      << "palette with alpha";
  EXPECT_EQ(texels(png(2, 1, 1, 0, {std::string("\x40", 1)})), (V{0, 0, 0, 255, 255, 255, 255, 255})) << "one bit";
  EXPECT_EQ(texels(png(1, 1, 8, 0, {"\x33"}, "", std::string("\x00\x33", 2))), (V{51, 51, 51, 0}))
      << "one grey is transparent";
  // 16 bits are rounded to the nearest of 8: 0x7fff is 127.498 of 255, 0x80c0 is 128.25, 0x01c2 is 1.75.
  EXPECT_EQ(texels(png(1, 1, 16, 2, {std::string("\x7f\xff\x80\xc0\x01\xc2", 6)})), (V{127, 128, 2, 255}));
  EXPECT_EQ(texels(png(1, 1, 16, 6, {std::string("\xff\xff\x00\x00\xff\x00\x12\x34", 8)})), (V{255, 0, 254, 18}));
  EXPECT_EQ(texels(png(1, 1, 16, 0, {std::string("\xc0\x00", 2)})), (V{191, 191, 191, 255}));
}

TEST(MaterialImport, Jpeg) {
  std::vector<uint8_t> image;
  for (int i = 0; i < 16 * 16; ++i)
    for (const int c : {10 * (i % 16), 10 * (i / 16), 200}) image.push_back(static_cast<uint8_t>(c));
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  stbi_write_jpg_to_func(append, &bytes, 16, 16, 3, image.data(), 100);
  const std::vector<int> read = texels(bytes);
  ASSERT_EQ(read.size(), 16u * 16 * 4);
  for (size_t i = 0; i < 256; ++i) {
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(read[4 * i + c], image[3 * i + c], 6) << "quality 100 keeps a ramp";
    EXPECT_EQ(read[4 * i + 3], 255);
  }
}

TEST(MaterialImport, SpecularGlossinessIsPreferredToItsFallback) {
  const Scene s =
      load(withExtension("KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                                                 {"specularFactor", {0.5, 0.6, 0.7}},
                                                                 {"glossinessFactor", 0.8},
                                                                 {"specularGlossinessTexture", {{"index", 0}}}})
               .text());
  const Material& m = s.materials.at(0);
  EXPECT_EQ(m.model, MaterialModel::SpecularGlossiness);
  EXPECT_EQ(m.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(m.specularColor, glm::vec3(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(m.glossiness, 0.8f);
  EXPECT_FALSE(m.baseColorTexture) << "the fallback's";
  EXPECT_TRUE(m.specularColorTexture);
  EXPECT_TRUE(s.warnings.empty());
  const Material defaults =
      load(withExtension("KHR_materials_pbrSpecularGlossiness", json::object()).text()).materials[0];
  EXPECT_EQ(defaults.baseColor, glm::vec4(1));
  EXPECT_EQ(defaults.specularColor, glm::vec3(1));
  EXPECT_EQ(defaults.glossiness, 1.0f);
  const std::string said =
      refusal(withExtension("KHR_materials_pbrSpecularGlossiness", {{"diffuseTexture", {{"index", 1}}}}).text());
  EXPECT_NE(said.find("/materials/0/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture/index"),
            std::string::npos)
      << said;
}

TEST(MaterialImport, UnlitKeepsItsBaseColourOnly) {
  GltfText g = withExtension("KHR_materials_unlit", json::object());
  g.j["materials"][0]["emissiveFactor"] = {1, 1, 1};
  g.j["materials"][0]["normalTexture"] = {{"index", 0}};
  g.j["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
  const Scene s = load(g.text());
  const Material& m = s.materials.at(0);
  EXPECT_EQ(m.model, MaterialModel::Unlit);
  EXPECT_TRUE(m.baseColorTexture);
  EXPECT_FALSE(m.normalTexture || m.metallicRoughnessTexture || m.emissiveTexture);
  EXPECT_FALSE(m.isEmissive());
  EXPECT_TRUE(prepareScene(s).lights.empty());
}

TEST(MaterialImport, IorAndSpecular) {
  const auto f0 = [](const char* name, const json& content) {
    const PreparedScene p = prepareScene(load(withExtension(name, content).text()));
    return p.speculars.empty() ? PackedSpecular{} : p.speculars[0];
  };
  EXPECT_NEAR(f0("KHR_materials_ior", {{"ior", 1.33}}).f0.x, std::pow(0.33 / 2.33, 2), 1e-7);
  EXPECT_EQ(f0("KHR_materials_ior", {{"ior", 0}}).f0.x, 1.0f);
  const PackedSpecular s = f0("KHR_materials_specular", {{"specularFactor", 0.5},
                                                         {"specularColorFactor", {2, 1, 0.5}},
                                                         {"specularTexture", {{"index", 0}}},
                                                         {"specularColorTexture", {{"index", 0}}}});
  EXPECT_NEAR(s.f0.x, 0.08f, 1e-7f);
  EXPECT_NEAR(s.f0.z, 0.02f, 1e-7f);
  EXPECT_EQ(s.weight, 0.5f);
  ASSERT_TRUE(s.colorTexture >= 0 && s.weightTexture >= 0);
  EXPECT_NE(s.colorTexture, s.weightTexture) << "one is a colour, one is data";
  // What says nothing new costs nothing.
  const PreparedScene plain = prepareScene(load(withExtension("KHR_materials_ior", {{"ior", 1.5}}).text()));
  EXPECT_TRUE(plain.speculars.empty());
  EXPECT_EQ(plain.traits, prepareScene(load(withImage(kPixel).text())).traits);
  EXPECT_EQ(load(withExtension("KHR_materials_ior", {{"ior", 0.5}}).text()).warnings.size(), 1u);
}

// The extension's own example: the lower left quarter of the image, turned clockwise by 90°.
TEST(MaterialImport, TextureTransformsInEverySlot) {
  const json transform = {{"KHR_texture_transform",
                           {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}, {"texCoord", 1}}}};
  const json slot = {{"index", 0}, {"texCoord", 0}, {"extensions", transform}};
  GltfText g = withImage(kPixel);
  g.accessor<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2", 3);
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
  g.accessor<float>({5, 5, 6, 5, 5, 6}, 5126, "VEC2", 3);
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 3;
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"KHR_texture_transform"};
  g.j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", slot}, {"metallicRoughnessTexture", slot}}},
                       {"normalTexture", slot},
                       {"emissiveTexture", {{"index", 0}}},
                       {"emissiveFactor", {1, 1, 1}}}};
  const Scene s = load(g.text());
  const Material& m = s.materials.at(0);
  for (const TextureSlot* used : {&m.baseColorTexture, &m.metallicRoughnessTexture, &m.normalTexture}) {
    EXPECT_LT(glm::distance(used->transform({0, 0}), glm::vec2(0, 1)), 1e-6f);
    EXPECT_LT(glm::distance(used->transform({1, 1}), glm::vec2(0.5f, 0.5f)), 1e-6f);
    EXPECT_LT(glm::distance(used->transform({1, 0}), glm::vec2(0, 0.5f)), 1e-6f);
    EXPECT_EQ(used->uvSet, 0) << "the file's second set is the first that a slot reads";
  }
  EXPECT_EQ(m.emissiveTexture.uvSet, 1);
  EXPECT_TRUE(m.emissiveTexture.transform.isIdentity());
  EXPECT_EQ(s.meshes[0].primitives[0].uv0[0], glm::vec2(5, 5));
  EXPECT_EQ(s.meshes[0].primitives[0].uv1[0], glm::vec2(0, 0));
  EXPECT_EQ(summarize(s).uvTransforms, 3u);
  const PreparedScene p = prepareScene(s);
  EXPECT_TRUE(p.traits.uvSets && p.traits.uvTransforms);
  EXPECT_EQ(p.uvs1.size(), p.positions.size());
}

TEST(MaterialImport, OneSetOfCoordinatesIsStoredOnceWhateverItsNumber) {
  GltfText g = withImage(kPixel);
  g.accessor<float>({5, 5, 6, 5, 5, 6}, 5126, "VEC2", 3);
  g.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = 2;
  g.j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 3;
  const Scene s = load(g.text());
  EXPECT_EQ(s.meshes[0].primitives[0].uv0[1], glm::vec2(6, 5));
  EXPECT_TRUE(s.meshes[0].primitives[0].uv1.empty());
  EXPECT_FALSE(prepareScene(s).traits.uvSets);
}

TEST(MaterialImport, ThirdSetsAreLeftOutWithAWarning) {
  GltfText g = withImage(kPixel);
  g.j["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}, {"texCoord", 1}};
  g.j["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 2}};
  const Scene s = load(g.text());
  EXPECT_FALSE(s.materials[0].normalTexture);
  EXPECT_EQ(s.warnings.size(), 1u);
}

TEST(MaterialImport, VertexColoursOfEveryType) {
  const auto with = [](auto values, int type, const char* kind, bool normalized) {
    GltfText g = GltfText::triangle();
    const int a = g.accessor(values, type, kind, 3);
    g.j["accessors"][a]["normalized"] = normalized;
    g.j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = a;
    return load(g.text());
  };
  // A float RGB triangle in red, green and blue; with integers padded to four bytes an element.
  const Scene rgb = with(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.2f}, 5126, "VEC3", false);
  const Scene rgba = with(std::vector<float>{1, 0, 0, 1, 0, 1, 0, 0.2f, 0, 0, 0.2f, 1}, 5126, "VEC4", false);
  const Scene bytes = with(std::vector<uint8_t>{255, 0, 0, 255, 0, 255, 0, 51, 0, 0, 51, 255}, 5121, "VEC4", true);
  const Scene shorts =
      with(std::vector<uint16_t>{65535, 0, 0, 65535, 0, 65535, 0, 13107, 0, 0, 13107, 65535}, 5123, "VEC4", true);
  for (const Scene* s : {&rgb, &rgba, &bytes, &shorts}) {
    const auto& c = s->meshes[0].primitives[0].colors;
    ASSERT_EQ(c.size(), 3u);
    EXPECT_EQ(c[0], glm::vec4(1, 0, 0, 1));
    EXPECT_NEAR(c[2].b, 0.2f, 1e-6f);
    EXPECT_NEAR(c[1].a, s == &rgb ? 1.0f : 0.2f, 1e-6f);
    EXPECT_EQ(summarize(*s).coloredPrimitives, 1u);
    EXPECT_TRUE(s->warnings.empty());
    const PreparedScene p = prepareScene(*s);
    EXPECT_TRUE(p.traits.vertexColors);
    ASSERT_EQ(p.colors.size(), p.positions.size());
  }
  const PreparedScene packed = prepareScene(bytes);
  for (size_t v = 0; v < 3; ++v)
    if (packed.positions[v] == glm::vec3(1, 0, 0)) {
      EXPECT_EQ(packed.colors[v].ba >> 16, 13107u) << "51/255 is kept exactly";
    }
  const Scene white = with(std::vector<float>(12, 1.0f), 5126, "VEC4", false);
  EXPECT_FALSE(prepareScene(white).traits.vertexColors) << "white says nothing";
  EXPECT_EQ(with(std::vector<float>{2, 0, 0, -1, 0, 0, 0, 0, 0}, 5126, "VEC3", false).warnings.size(), 1u);
}

TEST(MaterialImport, OtherImagesAreNamed) {
  GltfText g = withImage(kPixel);
  g.j["extensionsUsed"] = {"KHR_texture_basisu"};
  g.j["textures"][0]["extensions"] = {{"KHR_texture_basisu", {{"source", 0}}}};
  const Scene fallback = load(g.text());
  ASSERT_EQ(fallback.warnings.size(), 1u);
  EXPECT_NE(fallback.warnings[0].find("KHR_texture_basisu"), std::string::npos);
  EXPECT_TRUE(fallback.materials[0].baseColorTexture);
  g.j["textures"][0].erase("source");
  const Scene without = load(g.text());
  EXPECT_FALSE(without.materials[0].baseColorTexture);
  EXPECT_NE(without.warnings.at(0).find("KHR_texture_basisu"), std::string::npos);
  g.j["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_NE(refusal(g.text()).find("KHR_texture_basisu"), std::string::npos);
  // An image that lies about its type.
  EXPECT_NE(refusal(withImage("\xabKTX 20\xbb\r\n\x1a\n").text()).find("KHR_texture_basisu"), std::string::npos);
  EXPECT_NE(refusal(withImage(std::string("RIFF\0\0\0\0WEBPVP8 ", 16)).text()).find("EXT_texture_webp"),
            std::string::npos);
}

TEST(MaterialImport, SamplersAndTheirDefaults) {
  GltfText g = withImage(kPixel);
  const Texture plain = load(g.text()).textures.at(0);
  EXPECT_EQ(plain.mipFilter, MipFilter::Linear);
  EXPECT_EQ(plain.wrapS, Wrap::Repeat);
  g.j["textures"][0]["sampler"] = 0;
  struct Case {
    int code;
    Filter filter;
    MipFilter mip;
  };
  for (const Case& c :
       {Case{9728, Filter::Nearest, MipFilter::None}, Case{9729, Filter::Linear, MipFilter::None},
        Case{9984, Filter::Nearest, MipFilter::Nearest}, Case{9985, Filter::Linear, MipFilter::Nearest},
        Case{9986, Filter::Nearest, MipFilter::Linear}, Case{9987, Filter::Linear, MipFilter::Linear}}) {
    g.j["samplers"] = {{{"minFilter", c.code}, {"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}}};
    const Texture t = load(g.text()).textures.at(0);
    EXPECT_EQ(t.minFilter, c.filter) << c.code;
    EXPECT_EQ(t.mipFilter, c.mip) << c.code;
    EXPECT_EQ(t.magFilter, Filter::Nearest);
    EXPECT_EQ(t.wrapS, Wrap::ClampToEdge);
    EXPECT_EQ(t.wrapT, Wrap::MirroredRepeat);
  }
}

// The light's power comes from the texels that it shows: those of the transformed second set.
TEST(MaterialImport, EmissiveTexturesWeighByTheirOwnCoordinates) {
  Scene scene;
  Image image{"half", 16, 16, {}};
  for (int i = 0; i < 256; ++i) {
    const uint8_t v = i % 16 < 8 ? 0 : 255;
    image.rgba.insert(image.rgba.end(), {v, v, v, 255});
  }
  scene.images.push_back(image);
  scene.textures.push_back({.image = 0});
  const auto add = [&](int set, const UvTransform& transform) {
    Material m;
    m.emission = glm::vec3(1);
    m.emissiveTexture = {0, set, transform};
    scene.materials.push_back(m);
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.uv0 = {{0.1f, 0.1f}, {0.3f, 0.1f}, {0.1f, 0.3f}};  // black
    p.uv1 = {{0.7f, 0.1f}, {0.9f, 0.1f}, {0.7f, 0.3f}};  // white
    p.indices = {0, 1, 2};
    p.material = static_cast<int>(scene.materials.size()) - 1;
    scene.meshes.push_back({"", {p}});
    scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, -1, glm::mat4(1)});
  };
  add(0, {});
  add(1, {});
  add(0, {glm::mat2(1.0f), {0.5f, 0}});
  add(1, {glm::mat2(1.0f), {0.5f, 0}});
  const PreparedScene p = prepareScene(scene);
  ASSERT_EQ(p.lights.size(), 2u);
  for (const GpuLight& light : p.lights) {
    const uint32_t material = p.triangles[light.triangle].material;
    EXPECT_TRUE(material == 1 || material == 2) << material;
    EXPECT_NEAR(light.pdf, 0.5, 1e-6);
  }
  EXPECT_TRUE(p.traits.texturedLights);
}

// Whoever uses none of the models pays for none: no line stands before his shaders but that there is a lamp.
TEST(MaterialImport, PlainScenesHaveNoTraits) {
  const PreparedScene cornell = prepareScene(importGltf(WEIR_SOURCE_DIR "/scenes/cornell.glb"));
  EXPECT_EQ(cornell.traits, SceneTraits{.triangleLights = true});
  EXPECT_EQ(traitDefines(cornell.traits), "#define SCENE_TRIANGLE_LIGHTS 1\n");
  const PreparedScene points = prepareScene(importGltf(WEIR_SOURCE_DIR "/scenes/cornell-1000-points.glb"));
  EXPECT_EQ(points.traits, SceneTraits{});
  EXPECT_TRUE(traitDefines(points.traits).empty());
  EXPECT_TRUE(cornell.colors.empty() && cornell.uvs1.empty() && cornell.speculars.empty());
}

}  // namespace
}  // namespace weir::scene::test
