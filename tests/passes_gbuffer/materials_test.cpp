// The material models, vertex colours, sets of texture coordinates and their transforms, seen by both G-buffers and
// compared with the oracle. Roughness in the factors below lies on the packed steps' own grid nowhere: rounding counts.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

const scene::Camera kCamera = lookAt({0.3f, 0.4f, 3}, {0, 0, 0});

GFrame show(const char* type, const scene::Scene& scene, const Tolerance& tolerance) {
  SCOPED_TRACE(type);
  PassTest t(type);
  t.size(48, 40).scene(scene).camera(kCamera);
  t.run();
  const GFrame frame = readFrame(t, 48, 40);
  expectOracle(frame, RayOracle(t.sourceScene(), t.prepared()), kCamera, tolerance, 0.06);
  EXPECT_GT(std::ranges::count_if(frame.pixels, [](const GPixel& p) { return p.distance > 0; }), 300);
  return frame;
}

void showBoth(const scene::Scene& scene, const Tolerance& tolerance) {
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) show(type, scene, tolerance);
}

/// Texels that are told apart by every channel; sRGB codes far enough from black for one tolerance.
int noise(Builder& b, uint32_t salt) {
  return b.texture(
      8, 4,
      [salt](uint32_t x, uint32_t y) {
        const uint32_t h = hashOf(salt + 131 * x + 7919 * y);
        return glm::u8vec4(64 + (h & 127), 64 + (h >> 8 & 127), 64 + (h >> 16 & 127), 64 + (h >> 24 & 127));
      },
      scene::Filter::Nearest);
}

scene::Primitive panel(int material) {
  scene::Primitive p = quad({-1.4f, -1, 0}, {1.4f, -1, 0}, {1.4f, 1, 0.3f}, {-1.4f, 1, 0.3f}, material);
  p.uv1 = {{0.9f, 0.2f}, {0.1f, 0.4f}, {0.3f, 1.7f}, {1.2f, 1.1f}};
  return p;
}

// Nearest lookups of one texel: what is left is how the device decodes sRGB, in one texture or in a product of two.
const Tolerance kTextured{.normal = 1e-3, .root = 2 * kSrgbRoot, .roughness = 1e-5, .emission = kSrgbRelative};

TEST(Materials, SpecularGlossiness) {
  for (const bool textured : {false, true}) {
    SCOPED_TRACE(textured);
    Builder b;
    scene::Material m;
    m.model = scene::MaterialModel::SpecularGlossiness;
    m.baseColor = {0.9f, 0.7f, 0.5f, 1};
    m.specularColor = {0.3f, 0.8f, 0.5f};
    m.glossiness = 0.7f;
    m.metallic = m.roughness = 0.123f;  // of the fallback: must not matter
    if (textured) {
      m.baseColorTexture.texture = noise(b, 1);
      m.specularColorTexture.texture = noise(b, 2);
      m.metallicRoughnessTexture.texture = noise(b, 3);
    }
    b.add(panel(b.material(m)));
    const scene::PreparedScene p = scene::prepareScene(b.scene);
    EXPECT_TRUE(p.traits.specularGlossiness);
    EXPECT_FALSE(p.traits.dielectricSpecular || p.traits.f90 || p.traits.unlit);
    showBoth(b.scene, textured ? kTextured : Tolerance{});
  }
}

// The oracle is written from the extension too; this one is its text with numbers put in.
TEST(Materials, SpecularGlossinessByNumbers) {
  Builder b;
  scene::Material m;
  m.model = scene::MaterialModel::SpecularGlossiness;
  m.baseColor = {0.5f, 0.25f, 1, 1};
  m.specularColor = {0.2f, 0.36f, 0.1f};
  m.glossiness = 0.75f;
  b.add(panel(b.material(m)));
  const GFrame frame = show("gbuffer.RayTraced", b.scene, {});
  const GPixel& p = frame.at(24, 20);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(p.diffuseRoot[c], std::sqrt(m.baseColor[c] * 0.64), 1e-3);
    EXPECT_NEAR(p.f0Root[c], std::sqrt(m.specularColor[c]), 1e-3);
  }
  EXPECT_NEAR(p.roughness, 0.25, 2e-5);
}

TEST(Materials, IorAndSpecular) {
  struct Case {
    float ior, specular;
    glm::vec3 color;
    float metallic;
    bool textured;
  };
  for (const Case& c : {Case{1.33f, 1, {1, 1, 1}, 0, false}, Case{2.4f, 1, {1, 1, 1}, 0.3f, false},
                        Case{0, 1, {0.5f, 0.2f, 0.9f}, 0, false}, Case{1.5f, 0.4f, {1, 1, 1}, 0, false},
                        Case{1.8f, 0.6f, {9, 0.5f, 1}, 0.5f, false}, Case{1.6f, 0.9f, {3, 2, 1}, 0.2f, true}}) {
    SCOPED_TRACE(testing::Message() << "ior " << c.ior << ", specular " << c.specular << ", metallic " << c.metallic);
    Builder b;
    scene::Material m;
    m.baseColor = {0.6f, 0.5f, 0.4f, 1};
    m.metallic = c.metallic;
    m.roughness = 0.6f;
    m.ior = c.ior;
    m.specular = c.specular;
    m.specularColor = c.color;
    if (c.textured) {
      m.specularTexture.texture = noise(b, 5);
      m.specularColorTexture.texture = noise(b, 6);
    }
    b.add(panel(b.material(m)));
    const scene::PreparedScene p = scene::prepareScene(b.scene);
    EXPECT_TRUE(p.traits.dielectricSpecular);
    EXPECT_EQ(p.traits.f90, c.specular != 1.0f);
    Tolerance t = c.textured ? kTextured : Tolerance{};
    if (p.traits.f90) {
      t.roughnessStep = 1.0 / 1023;
      t.f90 = 1.0 / 63;
    }
    showBoth(b.scene, t);
  }
}

TEST(Materials, UnlitShowsItsBaseColourFromBothSidesAndReflectsNothing) {
  Builder b;
  scene::Material m;
  m.model = scene::MaterialModel::Unlit;
  m.baseColor = {0.9f, 0.4f, 0.1f, 1};
  m.baseColorTexture.texture = noise(b, 9);
  m.doubleSided = true;
  m.emission = {7, 7, 7};  // must not matter
  b.add(panel(b.material(m)));
  const scene::PreparedScene p = scene::prepareScene(b.scene);
  EXPECT_TRUE(p.traits.unlit && p.traits.f90);
  EXPECT_TRUE(p.lights.empty()) << "unlit surfaces are no lights";
  Tolerance t = kTextured;
  t.roughnessStep = 1.0 / 1023;
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    for (const GPixel& pixel : show(type, b.scene, t).pixels) {
      if (pixel.distance == 0) continue;
      EXPECT_EQ(pixel.diffuseRoot, glm::dvec3(0));
      EXPECT_EQ(pixel.f0Root, glm::dvec3(0));
      EXPECT_EQ(pixel.f90, 0.0);
    }
  }
}

TEST(Materials, VertexColoursScaleTheBaseColour) {
  for (const auto model : {scene::MaterialModel::MetallicRoughness, scene::MaterialModel::SpecularGlossiness,
                           scene::MaterialModel::Unlit}) {
    SCOPED_TRACE(static_cast<int>(model));
    Builder b;
    scene::Material m;
    m.model = model;
    m.baseColor = {0.9f, 0.8f, 1, 1};
    m.metallic = 0.5f;
    m.roughness = 0.5f;
    m.specularColor = glm::vec3(0.2f);
    scene::Primitive p = panel(b.material(m));
    p.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0.1f, 0.3f, 1, 1}, {1, 1, 1, 1}};
    b.add(p);
    EXPECT_TRUE(scene::prepareScene(b.scene).traits.vertexColors);
    Tolerance t{.root = 1e-5, .emission = 1e-5, .emissionBlend = 1e-5};
    if (model == scene::MaterialModel::Unlit) t.roughnessStep = 1.0 / 1023;
    showBoth(b.scene, t);
  }
}

// Where vertex colours are, flat normals split vertices and a second range has none at all: everything stays beside
// its vertex.
TEST(Materials, ColoursAndCoordinatesFollowTheirVertices) {
  Builder b;
  scene::Material m;
  m.metallic = 0;
  m.baseColorTexture = {noise(b, 4), 1, {}};
  scene::Material twoSided = m;
  twoSided.doubleSided = true;
  scene::Primitive colored = panel(b.material(m)), plain = panel(b.material(twoSided));
  colored.normals.clear();
  colored.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}};
  plain.uv0.clear();
  glm::mat4 left(1.0f), right(1.0f);
  left[3].x = -1.0f;
  left[0] *= 0.5f;
  right[3].x = 1.0f;
  right[0] *= -0.5f;
  b.add(colored, left);
  b.add(plain, right);
  showBoth(b.scene, kTextured);
}

// Two sets and a transform in every slot, the normal map's among them.
TEST(Materials, EverySlotHasItsOwnCoordinates) {
  for (const bool tangents : {false, true}) {
    SCOPED_TRACE(tangents);
    Builder b;
    const auto turned = [](float angle, glm::vec2 scale, glm::vec2 offset) {
      const float c = std::cos(angle), s = std::sin(angle);
      return scene::UvTransform{glm::mat2(glm::vec2(c, -s) * scale.x, glm::vec2(s, c) * scale.y), offset};
    };
    scene::Material m;
    m.metallic = 0.7f;
    m.roughness = 0.8f;
    m.emission = {2, 3, 4};
    m.baseColorTexture = {noise(b, 1), 0, turned(0.4f, {2, 0.7f}, {0.1f, 0.2f})};
    m.metallicRoughnessTexture = {noise(b, 2), 1, {}};
    m.emissiveTexture = {noise(b, 3), 1, turned(-1.1f, {0.5f, 1.5f}, {0.3f, -0.4f})};
    m.normalTexture = {noise(b, 7), 1, turned(2.0f, {1, -1}, {0, 0.5f})};
    scene::Primitive p = panel(b.material(m));
    if (tangents)
      for (int i = 0; i < 4; ++i) p.tangents.emplace_back(glm::normalize(glm::vec3(1, 0.5f, 0)), -1.0f);
    b.add(p);
    const scene::PreparedScene prepared = scene::prepareScene(b.scene);
    EXPECT_TRUE(prepared.traits.uvSets && prepared.traits.uvTransforms);
    EXPECT_FALSE(prepared.traits.mipmaps);
    showBoth(b.scene, kTextured);
  }
}

// The same triangle with its coordinates transformed by hand.
TEST(Materials, ATransformIsWhatTheExtensionSays) {
  const auto picture = [](bool byHand) {
    Builder b;
    scene::Material m;
    m.metallic = 0;
    m.baseColorTexture.texture = noise(b, 1);
    // "rotation 90° counter-clockwise, scale 0.5, offset (0, 1)": the lower left quarter of the image, turned.
    const scene::UvTransform t{glm::mat2(0, -0.5f, 0.5f, 0), glm::vec2(0, 1)};
    if (!byHand) m.baseColorTexture.transform = t;
    scene::Primitive p = panel(b.material(m));
    if (byHand)
      for (glm::vec2& uv : p.uv0) uv = glm::vec2(0.5f * uv.y, 1 - 0.5f * uv.x);
    b.add(p);
    return show("gbuffer.RayTraced", b.scene, kTextured);
  };
  const GFrame a = picture(false), b = picture(true);
  size_t same = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) same += a.pixels[i].diffuseRoot == b.pixels[i].diffuseRoot;
  EXPECT_GE(same, a.pixels.size() - 5) << "but where rounding moves a texel's edge";
}

// Vertex alpha with BLEND and MASK: shares of pixels, by both G-buffers. 5 σ of a binomial.
TEST(Materials, VertexAlphaCovers) {
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    for (const auto mode : {scene::AlphaMode::Blend, scene::AlphaMode::Mask}) {
      SCOPED_TRACE(testing::Message() << type << (mode == scene::AlphaMode::Mask ? " mask" : " blend"));
      Builder b;
      scene::Material m;
      m.alphaMode = mode;
      m.baseColor.a = 0.8f;
      m.alphaCutoff = 0.6f;
      scene::Primitive p = quad({-9, -9, -1}, {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}, b.material(m));
      p.colors = {{1, 1, 1, 0.5f}, {1, 1, 1, 0.5f}, {1, 1, 1, 1}, {1, 1, 1, 1}};
      b.add(p);
      PassTest t(type);
      t.size(64, 64).scene(b.scene).camera(lookAt({0, 0, 0}, {0, 0, -1}, 90));
      t.run();
      const GFrame frame = readFrame(t, 64, 64);
      const RayOracle oracle(t.sourceScene(), t.prepared());
      double covered = 0, expected = 0, variance = 0;
      for (uint32_t y = 0; y < 64; ++y) {
        for (uint32_t x = 0; x < 64; ++x) {
          const glm::dvec3 d = oracleDirection(lookAt({0, 0, 0}, {0, 0, -1}, 90), {x + 0.5, y + 0.5}, 64, 64);
          const double c = oracle.coverage(oracle.crossings({0, 0, 0}, d).at(0));
          expected += c;
          variance += c * (1 - c);
          covered += frame.at(x, y).distance > 0;
        }
      }
      // Alpha is 0.8 · 0.75 in the middle: the mask covers the upper half.
      EXPECT_NEAR(covered, expected, mode == scene::AlphaMode::Mask ? 64 : 5 * std::sqrt(variance));
      EXPECT_NEAR(expected, mode == scene::AlphaMode::Mask ? 2048 : 0.6 * 4096, 64);
    }
  }
}

}  // namespace
}  // namespace weir::test
