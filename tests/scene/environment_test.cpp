// Environments as data: what becomes of texels, and whether the table picks every direction with light, in proportion
// to it.
#include <weir/image/hdr.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "scene_support.h"
#include "support/environment_oracle.h"
#include "support/small_scenes.h"

namespace weir::scene::test {
namespace {

using weir::test::environmentOf;
using weir::test::EnvironmentOracle;

constexpr double kPi = 3.14159265358979;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

glm::vec3 noise(uint32_t x, uint32_t y) {
  const auto u = [&](uint32_t c) { return static_cast<float>(weir::test::uniformOf(x * 7919 + y * 104729 + c)); };
  const float bright = u(5) < 0.1f ? 40.0f : 1.0f;
  return glm::vec3(u(1), u(2), u(3)) * bright;
}

TEST(Environment, TexelsKeepTheirValueWhateverTheirRange) {
  for (const float scale : {1.0f, 1e-6f, 3.0e7f, 0.37f}) {
    const Environment e = environmentOf(9, 5, noise, scale);
    const EnvironmentOracle oracle(e);
    double most = 0.0;
    for (uint32_t y = 0; y < 5; ++y) {
      for (uint32_t x = 0; x < 9; ++x) {
        const glm::dvec3 expected = glm::dvec3(noise(x, y)) * double(scale);
        for (int c = 0; c < 3; ++c) {
          // Half floats: 11 bits down to 2^-14 of a unit, then 2^-24.
          EXPECT_NEAR(oracle.texel(x, y)[c], expected[c], expected[c] * 0x1p-11 + 0x1p-25 * e.unit);
          most = std::max(most, oracle.texel(x, y)[c]);
        }
      }
    }
    EXPECT_GE(most / e.unit, 16384.0);
    EXPECT_LE(most / e.unit, 32768.0);
  }
}

TEST(Environment, HalfFloatsAreExact) {
  const float smallest = 0x1p-24f, largest = 65504.0f;
  const Environment e = environmentOf(
      2, 1, [&](uint32_t x, uint32_t) { return x == 0 ? glm::vec3(largest, 1, 0.1f) : glm::vec3(1, 2, 3); });
  EXPECT_EQ(EnvironmentOracle(e).texel(0, 0).x, largest);
  EXPECT_EQ(EnvironmentOracle(e).texel(1, 0), glm::dvec3(1, 2, 3));
  const Environment dark = environmentOf(1, 1, [&](uint32_t, uint32_t) { return glm::vec3(smallest, 0, 0); });
  EXPECT_EQ(EnvironmentOracle(dark).texel(0, 0).x, smallest);
}

TEST(Environment, WhatIsNoRadianceCountsAsBlackAndIsCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const glm::vec3 texels[] = {{1, 1, 1}, {nan, 1, 1}, {1, -2, 1}, {kInfinity, -kInfinity, 4}, {0, 0, 0}};
  const Environment e = environmentOf(5, 1, [&](uint32_t x, uint32_t) { return texels[x]; });
  EXPECT_EQ(e.mended, 3u);
  const EnvironmentOracle oracle(e);
  EXPECT_EQ(oracle.texel(1, 0), glm::dvec3(0, 1, 1));
  EXPECT_EQ(oracle.texel(2, 0), glm::dvec3(1, 0, 1));
  EXPECT_EQ(oracle.texel(3, 0), glm::dvec3(0, 0, 4));
  EXPECT_FALSE(environmentOf(4, 2, [](uint32_t, uint32_t) { return glm::vec3(-1, 0, 0); }).shines());
  EXPECT_FALSE(environmentOf(4, 2, noise, 0.0f).shines());
  EXPECT_THROW(environmentOf(
                   1, 1, [](uint32_t, uint32_t) { return glm::vec3(1e30f); }, 1e30f),
               InputError);
}

TEST(Environment, NothingIsTabulatedWhereNothingShines) {
  const EnvironmentTable t = tabulate(environmentOf(8, 4, [](uint32_t, uint32_t) { return glm::vec3(0); }));
  EXPECT_TRUE(t.cells.empty());
  EXPECT_EQ(t.integral, 0.0);
}

/// What the table does, cell by cell: probabilities sum to 1, solid angles to 4π, and every cell in which the
/// interpolated radiance is anywhere above zero can be picked.
void expectCovers(const Environment& e, uint64_t mostCells) {
  const EnvironmentTable t = tabulate(e, mostCells);
  ASSERT_EQ(t.cells.size(), size_t{t.columns} * t.rows);
  ASSERT_LE(t.cells.size(), mostCells);
  std::vector<AliasCell> alias;
  for (const EnvironmentCell& c : t.cells) alias.push_back({c.threshold, c.alias});
  const std::vector<double> p = aliasProbabilities(alias);
  double sum = 0.0, sphere = 0.0;
  const auto edge = [&](uint32_t i, uint32_t size) { return std::min(double(i) * t.block, double(size)) / size; };
  for (uint32_t y = 0; y < t.rows; ++y) {
    const double cap = std::cos(kPi * edge(y, e.height)) - std::cos(kPi * edge(y + 1, e.height));
    for (uint32_t x = 0; x < t.columns; ++x) {
      const size_t i = size_t{y} * t.columns + x;
      const double solidAngle = 2 * kPi * (edge(x + 1, e.width) - edge(x, e.width)) * cap;
      sum += p[i];
      sphere += solidAngle;
      if (p[i] > 0.0) {
        ASSERT_NEAR(t.cells[i].spread * p[i] / solidAngle, 1.0, 1e-4);
      } else {
        ASSERT_EQ(t.cells[i].spread, 0.0f);
      }
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
  EXPECT_NEAR(sphere, 4 * kPi, 1e-6);
  const EnvironmentOracle oracle(e);
  const int64_t width = e.width, height = e.height;
  const auto bright = [&](int64_t x, int64_t y) { return oracle.texel(x, y) != glm::dvec3(0); };
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      if (!bright(x, y)) continue;
      for (int64_t dy = -1; dy <= 1; ++dy) {
        for (int64_t dx = -1; dx <= 1; ++dx) {
          const int64_t ny = std::clamp<int64_t>(y + dy, 0, height - 1), nx = (x + dx + width) % width;
          ASSERT_GT(t.cells[ny / t.block * t.columns + nx / t.block].spread, 0.0f) << nx << ", " << ny;
        }
      }
    }
  }
}

TEST(Environment, EveryDirectionWithLightHasADensity) {
  const auto lonely = [](uint32_t width, uint32_t height, uint32_t atX, uint32_t atY) {
    return environmentOf(width, height, [=](uint32_t x, uint32_t y) {
      return x == atX && y == atY ? glm::vec3(1e6f, 0, 0) : glm::vec3(0);
    });
  };
  expectCovers(environmentOf(1, 1, [](uint32_t, uint32_t) { return glm::vec3(0, 0, 1); }), 1 << 21);
  expectCovers(environmentOf(2, 1, noise), 1 << 21);
  expectCovers(environmentOf(1, 7, noise), 1 << 21);
  expectCovers(environmentOf(64, 32, noise), 1 << 21);
  expectCovers(environmentOf(61, 33, noise), 100);  // blocks that don't divide the picture
  expectCovers(environmentOf(4096, 3, noise), 64);
  for (const auto& [x, y] : {std::pair{0u, 0u}, {63u, 31u}, {0u, 16u}, {40u, 9u}}) {
    expectCovers(lonely(64, 32, x, y), 1 << 21);
    expectCovers(lonely(64, 32, x, y), 128);
  }
  // A sun a million times as bright as the sky.
  expectCovers(environmentOf(64, 32, [](uint32_t x, uint32_t y) { return glm::vec3(x == 20 && y == 5 ? 1e6f : 1.0f); }),
               1 << 21);
}

TEST(Environment, LargeMapsTakeLittleTimeAndMemory) {
  image::Picture picture;
  picture.width = 4096;
  picture.height = 2048;
  picture.rgba.resize(size_t{4} * picture.width * picture.height);
  for (size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<float>(i % 1021);
  picture.rgba[4 * (4096 * 700 + 1234)] = 1e6f;
  const Environment e = makeEnvironment(picture);
  const auto start = std::chrono::steady_clock::now();
  const EnvironmentTable t = tabulate(e);
  RecordProperty("seconds",
                 std::to_string(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
  EXPECT_EQ(t.block, 2u);
  EXPECT_EQ(t.columns, 2048u);
  EXPECT_EQ(t.rows, 1024u);
  double sum = 0.0;
  for (const EnvironmentCell& c : t.cells) {
    ASSERT_TRUE(c.spread > 0.0f && std::isfinite(c.spread));
    ASSERT_LT(c.alias, t.cells.size());
    sum += c.spread;
  }
  EXPECT_GT(sum, 0.0);
}

// The interpolated luminance of a cell by 16² midpoints a texel against what the table realises; χ² of picks.
TEST(Environment, CellsArePickedInProportionToTheirLight) {
  for (const uint64_t mostCells : {uint64_t{1} << 21, uint64_t{40}}) {
    const Environment e = environmentOf(23, 11, noise);
    const EnvironmentOracle oracle(e);
    const EnvironmentTable t = tabulate(e, mostCells);
    std::vector<double> light(t.cells.size(), 0.0);
    double total = 0.0;
    const int n = 16;
    for (uint32_t y = 0; y < e.height * n; ++y) {
      const double cap = std::cos(kPi * y / (e.height * n)) - std::cos(kPi * (y + 1) / (e.height * n));
      for (uint32_t x = 0; x < e.width * n; ++x) {
        const glm::dvec3 c = oracle.at((x + 0.5) / (e.width * n), (y + 0.5) / (e.height * n));
        const double value = glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)) * cap * 2 * kPi / (e.width * n);
        light[y / n / t.block * t.columns + x / n / t.block] += value;
        total += value;
      }
    }
    EXPECT_NEAR(t.integral / total, 1.0, 1e-3);
    std::vector<uint64_t> counts(t.cells.size(), 0);
    std::mt19937 random(5);
    const uint64_t picks = 1'000'000;
    for (uint64_t i = 0; i < picks; ++i) {
      const uint64_t cell = uint64_t{random()} * t.cells.size() >> 32;
      ++counts[random() * 0x1p-32 < t.cells[cell].threshold ? cell : t.cells[cell].alias];
    }
    double chi = 0.0;
    for (size_t i = 0; i < counts.size(); ++i) {
      const double p = light[i] / total;  // the quadrature's own error is a few thousandths
      EXPECT_NEAR(counts[i] / double(picks), p, 5e-3 * p + 5 * std::sqrt(p / picks)) << i;
      const double solidAngle =
          2 * kPi * (std::min<double>((i % t.columns + 1) * t.block, e.width) - (i % t.columns) * t.block) / e.width *
          (std::cos(kPi * double(i / t.columns * t.block) / e.height) -
           std::cos(kPi * std::min<double>((i / t.columns + 1) * t.block, e.height) / e.height));
      const double realised = solidAngle / t.cells[i].spread * picks;
      chi += (double(counts[i]) - realised) * (double(counts[i]) - realised) / realised;
    }
    // χ² of k cells has mean k - 1 and variance 2(k - 1); five standard deviations.
    const double k = double(counts.size()) - 1;
    EXPECT_LT(chi, k + 5 * std::sqrt(2 * k));
  }
}

TEST(Environment, IsOneMoreLightOfTheTable) {
  weir::test::Builder b;
  b.add(weir::test::quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}));
  PunctualLight sun;
  sun.kind = LightKind::Directional;
  sun.intensity = glm::vec3(3.0f);
  b.scene.lights.push_back(sun);
  const PreparedScene without = prepareScene(b.scene);
  EXPECT_FALSE(without.traits.environment);
  EXPECT_EQ(without.lights.size(), 1u);
  EXPECT_EQ(traitDefines(without.traits).find("ENVIRONMENT"), std::string::npos);

  b.scene.environment = environmentOf(16, 8, [](uint32_t, uint32_t) { return glm::vec3(2.0f); });
  const PreparedScene with = prepareScene(b.scene);
  EXPECT_TRUE(with.traits.environment);
  EXPECT_NE(traitDefines(with.traits).find("#define SCENE_ENVIRONMENT 1"), std::string::npos);
  ASSERT_EQ(with.lights.size(), 2u);
  EXPECT_EQ(with.lights[1].kind, static_cast<uint32_t>(GpuLightKind::Environment));
  // 4π steradian of radiance 2 against 3 lux, over the same disc.
  EXPECT_NEAR(with.environment.integral, 4 * kPi * 2, 1e-5);
  EXPECT_NEAR(with.lights[1].pdf, 8 * kPi / (8 * kPi + 3), 1e-6);

  b.scene.environment = environmentOf(16, 8, [](uint32_t, uint32_t) { return glm::vec3(0.0f); });
  EXPECT_FALSE(prepareScene(b.scene).traits.environment);
  EXPECT_EQ(prepareScene(b.scene).lights.size(), 1u);
}

TEST(Environment, OwnSkyHasASun) {
  const Environment e = readEnvironment(WEIR_SOURCE_DIR "/scenes/sky.hdr", 1.0f, 0.0f);
  EXPECT_EQ(e.width, 64u);
  EXPECT_EQ(e.height, 32u);
  EXPECT_EQ(e.mended, 0u);
  const EnvironmentOracle oracle(e);
  EXPECT_NEAR(oracle.texel(54, 9).x, 700.0, 4.0);
  EXPECT_GT(oracle.texel(10, 2).z, oracle.texel(10, 2).x);
  EXPECT_LT(oracle.texel(10, 25).z, 0.1);
}

TEST(Environment, TurnsAboutTheVertical) {
  const std::string sky = WEIR_SOURCE_DIR "/scenes/sky.hdr";
  EXPECT_NEAR(readEnvironment(sky, 1, 90).rotation, kPi / 2, 1e-6);
  EXPECT_NEAR(readEnvironment(sky, 1, 3690).rotation, kPi / 2, 1e-6);
  // What the middle shows lies at -Z, turned by 90° at -X.
  const Environment e = readEnvironment(sky, 1, 90);
  const glm::dvec3 middle = EnvironmentOracle(e).direction(0.5, 0.5);
  EXPECT_NEAR(middle.x, -1.0, 1e-6);
}

TEST(Environment, BadFilesAreRefused) {
  const TempFolder folder;
  const std::string sky = WEIR_SOURCE_DIR "/scenes/sky.hdr";
  for (const float scale : {-1.0f, kInfinity, std::nanf("")}) EXPECT_THROW(readEnvironment(sky, scale, 0), InputError);
  EXPECT_THROW(readEnvironment(sky, 1, kInfinity), InputError);
  EXPECT_THROW(readEnvironment((folder.path() / "none.hdr").string(), 1, 0), InputError);
  EXPECT_THROW(readEnvironment(folder.path().string(), 1, 0), InputError);
  EXPECT_THROW(readEnvironment(folder.write("empty.exr", ""), 1, 0), InputError);
  EXPECT_THROW(readEnvironment(folder.write("words.hdr", "light"), 1, 0), InputError);
  image::Picture picture;
  picture.width = picture.height = 1;
  picture.rgba = {1, 1, 1, 1};
  const std::string png = (folder.path() / "a.png").string();
  image::writePng(png, picture, image::Encoding::Radiance);
  try {
    readEnvironment(png, 1, 0);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("expected radiance"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace weir::scene::test
