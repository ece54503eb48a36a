// Levels of detail: ray cones in RayTraced and derivatives in Raster, each against its own formula in double precision,
// and against each other.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;

struct Sampler {
  scene::Filter mag, min;
  scene::MipFilter mip;
};

/// A floor that runs to the horizon under every kind of texture, of sides that halve unevenly. `stretch`: how much
/// longer the texture is along one axis of the floor than along the other, in texels a metre.
Builder floor(const Sampler& sampler, float stretch, bool normalMap) {
  Builder b;
  const auto noise = [&](uint32_t width, uint32_t height, uint32_t salt) {
    const int index = b.texture(width, height, [=](uint32_t x, uint32_t y) {
      const uint32_t h = hashOf(salt + x + 4099 * y);
      return glm::u8vec4(h & 255, h >> 8 & 255, h >> 16 & 255, 255);
    });
    scene::Texture& t = b.scene.textures[static_cast<size_t>(index)];
    t.magFilter = sampler.mag;
    t.minFilter = sampler.min;
    t.mipFilter = sampler.mip;
    return index;
  };
  scene::Material m;
  m.metallic = 0.5f;
  m.emission = {1, 2, 3};
  m.baseColorTexture = {noise(64, 64, 1), 0, {}};
  m.metallicRoughnessTexture = {noise(37, 37, 2), 1, {}};
  // Turned and stretched: the level follows the transform.
  m.emissiveTexture = {noise(48, 48, 3), 0, {glm::mat2(0.6f, -0.8f, 0.8f, 0.6f) * 1.7f, {0.1f, 0}}};
  if (normalMap) m.normalTexture = {noise(32, 32, 4), 0, {}};
  const float far = 40;
  scene::Primitive p = quad({-20, -1, 0}, {20, -1, 0}, {20, -1, -far}, {-20, -1, -far}, b.material(m));
  p.uv0 = {{0, 0}, {40, 0}, {40, 40 * stretch}, {0, 40 * stretch}};
  p.uv1 = {{0, 0}, {30, 0}, {30, 30 * stretch}, {0, 30 * stretch}};
  b.add(p);
  return b;
}

const scene::Camera kCamera = lookAt({0.3f, 0.2f, 1}, {0.2f, -1, -4}, 60);

GFrame show(PassTest& t, const scene::Scene& scene) {
  t.size(kWidth, kHeight).scene(scene).camera(kCamera);
  t.run();
  return readFrame(t, kWidth, kHeight);
}

constexpr auto kLinear = scene::Filter::Linear, kNearest = scene::Filter::Nearest;

TEST(Mipmap, LevelsAreThoseOfTheirRule) {
  const Sampler samplers[] = {{kLinear, kLinear, scene::MipFilter::Linear},
                              {kLinear, kNearest, scene::MipFilter::Linear},
                              {kNearest, kLinear, scene::MipFilter::Nearest},
                              {kLinear, kNearest, scene::MipFilter::None}};
  for (const Sampler& sampler : samplers) {
    for (const float stretch : {1.0f, 4.0f}) {
      // Texels far smaller than the rounding of their coordinates aren't comparable.
      if (sampler.mip == scene::MipFilter::None && stretch > 1) continue;
      for (const auto& [type, rule] :
           {std::pair("gbuffer.RayTraced", LevelRule::Cone), {"gbuffer.Raster", LevelRule::Derivatives}}) {
        SCOPED_TRACE(testing::Message() << type << " stretch " << stretch << " min " << int(sampler.min) << " mip "
                                        << int(sampler.mip));
        PassTest t(type);
        const GFrame frame = show(t, floor(sampler, stretch, false).scene);
        ASSERT_TRUE(t.prepared().traits.mipmaps);
        RayOracle oracle(t.sourceScene(), t.prepared());
        oracle.seeThrough(kCamera, kWidth, kHeight, rule);
        // Devices blend texels and levels in steps of 1/256 of neighbours that differ by the whole range.
        expectOracle(
            frame, oracle, kCamera,
            {.normal = 1e-3, .root = 0.02, .roughness = 0.02, .emission = kSrgbRelative, .emissionBlend = 0.03}, 0.05);
      }
    }
  }
}

// The picture holds both: texels larger than pixels, and pixels larger than the whole texture.
TEST(Mipmap, TheFloorSpansAllLevels) {
  const Builder b = floor({kLinear, kLinear, scene::MipFilter::Linear}, 1, false);
  const scene::PreparedScene prepared = scene::prepareScene(b.scene);
  RayOracle oracle(b.scene, prepared);
  oracle.seeThrough(kCamera, kWidth, kHeight, LevelRule::Cone);
  double least = 1e9, most = -1e9;
  for (uint32_t y = 0; y < kHeight; ++y) {
    const glm::dvec3 d = oracleDirection(kCamera, {kWidth / 2.0, y + 0.5}, kWidth, kHeight);
    const OracleHit hit = oracle.closest(kCamera.eye, d, true);
    if (!hit) continue;
    least = std::min(least, oracle.level(prepared.materials[0].baseColorTexture, hit, d));
    most = std::max(most, oracle.level(prepared.materials[0].baseColorTexture, hit, d));
  }
  EXPECT_LT(least, 2.0);
  EXPECT_GT(most, 5.0);
}

// Both rules are one number up to the curvature of a pixel's edges, here a hundredth of a level, wherever the pixel
// lies and however the texture is stretched.
TEST(Mipmap, TheRulesAgree) {
  for (const float stretch : {1.0f, 4.0f}) {
    const Builder b = floor({kLinear, kLinear, scene::MipFilter::Linear}, stretch, false);
    const scene::PreparedScene prepared = scene::prepareScene(b.scene);
    RayOracle cone(b.scene, prepared), derivatives(b.scene, prepared);
    cone.seeThrough(kCamera, kWidth, kHeight, LevelRule::Cone);
    derivatives.seeThrough(kCamera, kWidth, kHeight, LevelRule::Derivatives);
    size_t n = 0;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        const glm::dvec3 d = oracleDirection(kCamera, {x + 0.5, y + 0.5}, kWidth, kHeight);
        const OracleHit hit = cone.closest(kCamera.eye, d, true);
        if (!hit) continue;
        const int32_t texture = prepared.materials[0].emissiveTexture;
        EXPECT_NEAR(cone.level(texture, hit, d), derivatives.level(texture, hit, d), 0.01);
        ++n;
      }
    }
    EXPECT_GT(n, 1000u);
  }
}

// The two G-buffers read the same levels, and so agree in the mean of what they show: to 0.1 % of the picture.
TEST(Mipmap, TheGBuffersAgreeInTheMean) {
  for (const float stretch : {1.0f, 4.0f}) {
    glm::dvec3 emission[2] = {}, diffuse[2] = {};
    for (int i = 0; i < 2; ++i) {
      PassTest t(i == 0 ? "gbuffer.RayTraced" : "gbuffer.Raster");
      t.param("jitter", "true");
      t.size(kWidth, kHeight)
          .scene(floor({kLinear, kLinear, scene::MipFilter::Linear}, stretch, true).scene)
          .camera(kCamera);
      for (int f = 0; f < 16; ++f) {
        t.run();
        for (const GPixel& p : readFrame(t, kWidth, kHeight).pixels) {
          emission[i] += glm::dvec3(p.emission);
          diffuse[i] += p.diffuseRoot * p.diffuseRoot;
        }
      }
    }
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(emission[1][c] / emission[0][c], 1.0, 1e-3) << "stretch " << stretch;
      EXPECT_NEAR(diffuse[1][c] / diffuse[0][c], 1.0, 1e-3) << "stretch " << stretch;
    }
  }
}

}  // namespace
}  // namespace weir::test
