// gbuffer.RayTraced against double-precision ray casting: distances, normals, packing, emission.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

constexpr scene::PrepareLimits kInstanceAll{0, 1};

GFrame trace(scene::Scene scene, const scene::Camera& camera, uint32_t width, uint32_t height,
             const scene::PrepareLimits& limits = {}, const Tolerance& tolerance = {}) {
  PassTest t("gbuffer.RayTraced");
  t.size(width, height).scene(std::move(scene)).limits(limits).camera(camera);
  t.run();
  const GFrame frame = readFrame(t, width, height);
  RayOracle oracle(t.sourceScene(), t.prepared());
  oracle.seeThrough(camera, width, height, LevelRule::Cone);
  expectOracle(frame, oracle, camera, tolerance);
  return frame;
}

size_t hits(const GFrame& frame) {
  return static_cast<size_t>(std::ranges::count_if(frame.pixels, [](const GPixel& p) { return p.distance > 0.0; }));
}

TEST(RayTraced, OwnScenes) {
  for (const char* name : {"cornell.glb", "materials.glb"}) {
    SCOPED_TRACE(name);
    const scene::Scene scene = own(name);
    const GFrame frame = trace(scene, scene.cameras.at(0), 64, 64);
    EXPECT_GT(hits(frame), 1000u);
  }
}

TEST(RayTraced, LampsShowWhereTheyFaceTheCamera) {
  const scene::Scene scene = own("cornell.glb");
  const GFrame frame = trace(scene, lookAt({0, 0.5f, 0.9f}, {0, 2, 0}), 64, 64);
  EXPECT_GT(std::ranges::count_if(frame.pixels, [](const GPixel& p) { return p.emission.r > 16.0; }), 50);
}

TEST(RayTraced, OddSizes) {
  const scene::Scene scene = own("cornell.glb");
  for (const auto& [w, h] : {std::pair(1u, 1u), {13u, 7u}, {9u, 65u}, {8u, 16u}}) {
    SCOPED_TRACE(testing::Message() << w << "x" << h);
    EXPECT_EQ(hits(trace(scene, lookAt({0.1f, 1, 0.9f}, {0, 0.9f, 0}, 40), w, h)), size_t{w} * h);
  }
}

TEST(GBuffer, AnEmptySceneIsAllMisses) {
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    PassTest t(type);
    t.size(9, 5).camera(lookAt({0, 0, 0}, {1, 2, 3}));
    t.run(2);
    for (const GPixel& p : readFrame(t, 9, 5).pixels) {
      EXPECT_EQ(p.distance, 0.0);
      EXPECT_EQ(p.emission, glm::dvec4(0.0));
      EXPECT_LT(glm::length(p.motion), 1e-3);
    }
  }
}

/// Every texture slot in use, with normals that point all over their hemisphere.
Builder textured(scene::Filter filter, scene::Wrap wrap, bool doubleSided) {
  Builder b;
  const auto colour = [](uint32_t salt) {
    return [salt](uint32_t x, uint32_t y) {
      const uint32_t h = hashOf(salt + 131 * x + 7919 * y);
      return glm::u8vec4(h & 255, (h >> 8) & 255, (h >> 16) & 255, 255);
    };
  };
  const auto bumps = [](uint32_t x, uint32_t y) {
    const double a = 6.28 * uniformOf(x + 64 * y), r = 0.7 * uniformOf(999 + x + 64 * y);
    const glm::dvec3 n(r * std::cos(a), r * std::sin(a), std::sqrt(1 - r * r));
    return glm::u8vec4(glm::round(glm::dvec4(n * 127.5 + 127.5, 255.0)));
  };
  scene::Material m;
  m.baseColor = {0.9f, 0.8f, 1.0f, 1.0f};
  m.metallic = 0.8f;
  m.roughness = 0.9f;
  m.emission = {3, 2, 1};
  m.normalScale = 0.7f;
  m.doubleSided = doubleSided;
  m.baseColorTexture.texture = b.texture(8, 4, colour(1), filter, wrap);
  m.metallicRoughnessTexture.texture = b.texture(4, 8, colour(2), filter, wrap);
  m.emissiveTexture.texture = b.texture(8, 8, colour(3), filter, wrap);
  m.normalTexture.texture = b.texture(8, 8, bumps, filter, wrap);
  const int material = b.material(m);
  scene::Primitive p = quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, material);
  for (glm::vec2& uv : p.uv0) uv = glm::vec2(uv.x * 1.7f - 0.3f, uv.y * 1.4f - 0.2f);
  // The file's own tangents, turned against the texture's axes, of either handedness.
  for (int i = 0; i < 4; ++i) p.tangents.emplace_back(glm::normalize(glm::vec3(1, 0.5f, 0)), -1.0f);
  const int mesh = b.mesh({p});
  const glm::mat4 turn(glm::vec4(0.8f, 0, 0.6f, 0), glm::vec4(0, 1, 0, 0), glm::vec4(-0.6f, 0, 0.8f, 0),
                       glm::vec4(0, 0, 0, 1));
  glm::mat4 left = turn, right = turn;
  left[3] = glm::vec4(-1.1f, 0, 0, 1);
  right[0] *= -1.0f;  // mirrored: the bitangent must follow
  right[3] = glm::vec4(1.1f, 0, 0, 1);
  b.place(mesh, left);
  b.place(mesh, right);
  return b;
}

TEST(RayTraced, TexturesAndNormalMaps) {
  for (const bool instanced : {false, true}) {
    for (const auto filter : {scene::Filter::Nearest, scene::Filter::Linear}) {
      for (const auto wrap : {scene::Wrap::Repeat, scene::Wrap::MirroredRepeat, scene::Wrap::ClampToEdge}) {
        SCOPED_TRACE(testing::Message() << instanced << " filter " << int(filter) << " wrap " << int(wrap));
        // Emission stops scenes from being instanced.
        Builder b = textured(filter, wrap, true);
        if (instanced) b.scene.materials[0].emission = glm::vec3(0);
        // Samplers blend in steps of 1/256 of a texel, and neighbours here differ by the whole range: what that
        // changes of a root is largest where the root is small.
        const bool linear = filter == scene::Filter::Linear;
        const Tolerance tolerance{.normal = linear ? 0.02 : 1e-3,
                                  .root = linear ? 0.02 : kSrgbRoot,
                                  .roughness = linear ? 0.01 : 1e-5,
                                  .emission = kSrgbRelative,
                                  .emissionBlend = linear ? 3.0 * 2 / 256 : 1e-6};
        const GFrame frame = trace(b.scene, lookAt({0.3f, 0.4f, 3}, {0, 0, 0}), 64, 40,
                                   instanced ? kInstanceAll : scene::PrepareLimits{}, tolerance);
        EXPECT_GT(hits(frame), 800u);
      }
    }
  }
}

TEST(RayTraced, TexturedBacksOfDoubleSidedSurfaces) {
  const Builder b = textured(scene::Filter::Nearest, scene::Wrap::Repeat, true);
  const GFrame frame = trace(b.scene, lookAt({0.3f, 0.4f, -3}, {0, 0, 0}), 64, 40, {},
                             {.normal = 1e-3, .root = kSrgbRoot, .roughness = 1e-5, .emission = kSrgbRelative});
  EXPECT_GT(hits(frame), 800u);
  for (const GPixel& p : frame.pixels) {
    if (p.distance > 0.0) {
      EXPECT_GT(p.geometricNormal.z * -1.0, 0.5) << "the back faces the viewer";
    }
  }
}

/// A single-sided and a double-sided lamp, mesh normals along +Z.
scene::Scene twoLamps() {
  Builder b;
  for (const bool doubleSided : {false, true}) {
    scene::Material m;
    m.emission = glm::vec3(5);
    m.doubleSided = doubleSided;
    const float x = doubleSided ? 1.0f : -1.0f;
    b.add(quad({x - 0.9f, -0.9f, 0}, {x + 0.9f, -0.9f, 0}, {x + 0.9f, 0.9f, 0}, {x - 0.9f, 0.9f, 0}, b.material(m)));
  }
  return b.scene;
}

TEST(RayTraced, EmissionOfFrontsAndBacks) {
  const auto lit = [](const GFrame& f, bool rightHalf) {
    size_t n = 0;
    for (uint32_t y = 0; y < f.height; ++y) {
      for (uint32_t x = 0; x < f.width / 2; ++x) n += f.at(x + (rightHalf ? f.width / 2 : 0), y).emission.r == 5.0;
    }
    return n;
  };
  const GFrame front = trace(twoLamps(), lookAt({0, 0, 3}, {0, 0, 0}), 64, 32);
  EXPECT_GT(lit(front, false), 100u);
  EXPECT_GT(lit(front, true), 100u);
  const GFrame back =
      trace(twoLamps(), lookAt({0, 0, -3}, {0, 0, 0}), 64, 32);  // the double-sided one is on the left now
  EXPECT_GT(lit(back, false), 100u);
  EXPECT_EQ(lit(back, true), 0u);
}

}  // namespace
}  // namespace weir::test
