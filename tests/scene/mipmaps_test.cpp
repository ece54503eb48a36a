// Smaller levels of images against means by area in double precision.
#include "scene_support.h"

#include <weir/scene/mipmaps.h>

#include <array>
#include <cmath>
#include <random>

namespace weir::scene::test {
namespace {

double decode(double code, bool srgb) {
  const double c = code / 255.0;
  if (!srgb) return c;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double encode(double linear, bool srgb) {
  if (!srgb) return linear * 255.0;
  return 255.0 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055);
}

Image noise(uint32_t width, uint32_t height, int least = 0, int most = 255) {
  Image image{"noise", width, height, {}};
  std::mt19937 random(width * 1000 + height);
  std::uniform_int_distribution<int> code(least, most);
  for (size_t i = 0; i < size_t{4} * width * height; ++i) image.rgba.push_back(static_cast<uint8_t>(code(random)));
  return image;
}

/// Colours, linear and multiplied by what they count for, then alpha, then what they count for.
using Texel = std::array<double, 5>;

/// The mean over the area of each texel of the next level.
std::vector<Texel> halved(const std::vector<Texel>& level, uint32_t width, uint32_t height) {
  const uint32_t w = std::max(1u, width / 2), h = std::max(1u, height / 2);
  const double sx = double(width) / w, sy = double(height) / h;
  const auto overlap = [](double low, double high, uint32_t i) {
    return std::max(0.0, std::min<double>(high, i + 1) - std::max<double>(low, i));
  };
  std::vector<Texel> result;
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x) {
      Texel sum{};
      for (uint32_t j = 0; j < height; ++j)
        for (uint32_t i = 0; i < width; ++i) {
          const double area = overlap(x * sx, (x + 1) * sx, i) * overlap(y * sy, (y + 1) * sy, j) / (sx * sy);
          for (size_t k = 0; k < 5; ++k) sum[k] += area * level[size_t{j} * width + i][k];
        }
      result.push_back(sum);
    }
  return result;
}

/// Largest difference, in codes, between makeMipmaps() and means over areas.
double worstCode(const Image& image, const MipContent& content) {
  std::vector<Texel> level;
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    const uint8_t* c = image.rgba.data() + i;
    const double counts = content.weightByAlpha ? 1.0 / 256 + c[3] / 255.0 * 255 / 256 : 1.0;
    level.push_back({counts * decode(c[0], content.srgb), counts * decode(c[1], content.srgb),
                     counts * decode(c[2], content.srgb), c[3] / 255.0, counts});
  }
  const std::vector<uint8_t> made = makeMipmaps(image, content);
  size_t at = 0;
  double worst = 0.0;
  for (uint32_t w = image.width, h = image.height; w * h > 1; w = std::max(1u, w / 2), h = std::max(1u, h / 2)) {
    level = halved(level, w, h);
    for (const Texel& t : level)
      for (size_t k = 0; k < 4; ++k, ++at) {
        const double code = k < 3 ? encode(t[k] / t[4], content.srgb) : t[3] * 255.0;
        worst = std::max(worst, std::abs(made.at(at) - code));
      }
  }
  EXPECT_EQ(at, made.size());
  return worst;
}

TEST(Mipmaps, EveryTexelIsTheMeanOverItsArea) {
  for (const auto& [w, h] : {std::pair(16u, 16u), {8u, 2u}, {1u, 7u}, {5u, 3u}, {37u, 21u}, {33u, 64u}, {3u, 1u}})
    for (const bool srgb : {false, true})
      for (const bool weighted : {false, true}) {
        // Rounding is half a code; sRGB codes come out of a table of 65536 entries, a fortieth of a code at most.
        EXPECT_LE(worstCode(noise(w, h), {srgb, weighted}), 0.53) << w << " x " << h << " srgb " << srgb;
        EXPECT_LE(worstCode(noise(w, h, 0, 12), {srgb, weighted}), 0.53) << w << " x " << h << ", dark";
      }
}

TEST(Mipmaps, LevelsEndAtOneTexel) {
  EXPECT_EQ(mipLevelCount(1, 1), 1u);
  EXPECT_EQ(mipLevelCount(2, 1), 2u);
  EXPECT_EQ(mipLevelCount(5, 3), 3u);
  EXPECT_EQ(mipLevelCount(512, 64), 10u);
  EXPECT_TRUE(makeMipmaps(noise(1, 1), {}).empty());
  EXPECT_EQ(makeMipmaps(noise(4, 2), {}).size(), 4u * (2 + 1));
}

// Black and white texels look as bright from afar as from close by, which codes averaged as they are would not.
TEST(Mipmaps, SrgbIsAveragedAsLight) {
  Image image{"checks", 2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255}};
  EXPECT_EQ(makeMipmaps(image, {.srgb = true})[0], 188);
  EXPECT_EQ(makeMipmaps(image, {.srgb = false})[0], 128);
}

// What is see-through may have any colour: it doesn't get into what is seen. Where nothing is seen, colours stay as
// they are.
TEST(Mipmaps, ColoursOfSeeThroughTexelsDontBleed) {
  Image image{"leaf", 4, 1, {0, 200, 0, 255, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0}};
  const auto weighted = makeMipmaps(image, {.weightByAlpha = true}), plain = makeMipmaps(image, {});
  EXPECT_EQ(plain[0], 128);
  EXPECT_LE(weighted[0], 1);
  EXPECT_GE(weighted[1], 199);
  EXPECT_EQ(weighted[3], 128) << "alpha itself is the mean";
  EXPECT_EQ(weighted[4], 255) << "a colour that nobody sees";
}

// A texture in a colour slot, in a data slot and under a cut-out is three images; equal uses are one.
TEST(Mipmaps, UsesOfOneImage) {
  Scene scene;
  scene.images.push_back(noise(4, 4));
  scene.textures.push_back({.image = 0, .mipFilter = MipFilter::Linear});
  Material opaque, cutOut;
  opaque.baseColorTexture = opaque.normalTexture = opaque.metallicRoughnessTexture = {0, 0, {}};
  cutOut.baseColorTexture = {0, 0, {}};
  cutOut.alphaMode = AlphaMode::Mask;
  scene.materials = {opaque, cutOut};
  const PreparedScene p = prepareScene(scene);
  ASSERT_EQ(p.textures.size(), 3u);
  EXPECT_TRUE(p.traits.mipmaps);
  EXPECT_EQ(p.textures[0].content, (MipContent{true, false}));
  EXPECT_EQ(p.textures[1].content, (MipContent{false, false}));
  EXPECT_EQ(p.textures[2].content, (MipContent{true, true}));
  // Without levels nothing tells the two colours apart, and no shader needs to choose.
  scene.textures[0].mipFilter = MipFilter::None;
  const PreparedScene q = prepareScene(scene);
  EXPECT_EQ(q.textures.size(), 2u);
  EXPECT_FALSE(q.traits.mipmaps);
}

}  // namespace
}  // namespace weir::scene::test
