// What the GPU shows against what OpenColorIO's own CPU processor makes of the same colours.
#include <OpenColorIO/OpenColorIO.h>
#include <weir/core/error.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "output/view_transform.h"
#include "passes_output/configs.h"
#include "passes_output/one_pass.h"

namespace weir::test {
namespace {

namespace ocio = OCIO_NAMESPACE;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kTolerance = 1.0f / 1024.0f;

struct Choice {
  std::string config = "weir", display, view, space;
  float exposure = 0.0f;
};

std::string tonemap(const Choice& c) {
  return fmt::format(
      R"({{"type": "output.Tonemap", "inputs": {{"color": "given.color"}}, "params": {{"config": "{}", "display": "{}", )"
      R"("view": "{}", "space": "{}", "exposure": {}}}}})",
      c.config, c.display, c.view, c.space, c.exposure);
}

/// Colours of all magnitudes: dark, in [0, 1], bright and huge; negatives; grey ones; and values that aren't finite.
std::vector<float> colours(size_t count, float largest) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<float> rgba;
  rgba.reserve(4 * count);
  const float odd[] = {0.0f, -0.0f, 1.0f, kNan, -kNan, kInfinity, -kInfinity, 0.18f, 1e-40f, largest, -largest};
  for (size_t i = 0; i < count; ++i) {
    const float scale = i % 2 == 0 ? 1.0f : std::exp2(-20.0f + (20.0f + std::log2(largest)) * unit(random));
    float rgb[3] = {scale * unit(random), scale * unit(random), scale * unit(random)};
    if (i % 16 == 3) rgb[1] = rgb[2] = rgb[0];
    if (i % 8 == 5) rgb[i / 8 % 3] *= -0.3f;
    if (i % 64 == 9) rgb[i / 64 % 3] = odd[random() % std::size(odd)];
    rgba.insert(rgba.end(), {rgb[0], rgb[1], rgb[2], unit(random)});
  }
  return rgba;
}

/// The promise of the pass's documentation, written again.
float given(float x, float exposure) {
  if (std::isnan(x)) return 0.0f;
  return std::clamp(x * std::exp2(exposure), -1073741824.0f, 1073741824.0f);
}

std::vector<float> onCpu(const Choice& c, const char* source, std::vector<float> rgba) {
  std::istringstream text(passes::builtInConfig());
  const auto config =
      c.config == "weir" ? ocio::Config::CreateFromStream(text) : ocio::Config::CreateFromFile(c.config.c_str());
  const auto shown = ocio::DisplayViewTransform::Create();
  const std::string display = c.display.empty() ? config->getDefaultDisplay() : c.display;
  shown->setSrc(source);
  shown->setDisplay(display.c_str());
  shown->setView(c.view.empty() ? config->getDefaultView(display.c_str()) : c.view.c_str());
  // Without the fast approximations that the CPU path has by default.
  const auto processor = config->getProcessor(shown)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
  for (size_t i = 0; i < rgba.size(); i += 4) {
    for (size_t k = 0; k < 3; ++k) rgba[i + k] = given(rgba[i + k], c.exposure);
    rgba[i + 3] = 1.0f;
    processor->applyRGB(&rgba[i]);
  }
  return rgba;
}

void expectNear(const std::vector<float>& gpu, const std::vector<float>& cpu, const std::vector<float>& from) {
  ASSERT_EQ(gpu.size(), cpu.size());
  size_t wrong = 0;
  float worst = 0.0f;
  for (size_t i = 0; i < gpu.size(); ++i) {
    // Beyond what a screen shows, of the value.
    const float error = std::abs(gpu[i] - cpu[i]) / std::max(1.0f, std::abs(cpu[i]));
    worst = std::max(worst, error);
    if (error <= kTolerance) continue;
    const size_t p = i / 4 * 4;
    if (++wrong <= 5) {
      ADD_FAILURE() << fmt::format("({}, {}, {}) channel {}: {} on the GPU, {} on the CPU", from[p], from[p + 1],
                                   from[p + 2], i - p, gpu[i], cpu[i]);
    }
  }
  EXPECT_EQ(wrong, 0u) << "worst " << worst;
}

void compare(const Choice& c, const char* source, uint32_t width, uint32_t height, float largest) {
  const std::vector<float> rgba = colours(size_t{width} * height, largest);
  OnePass pass(tonemap(c), width, height);
  expectNear(pass.show(rgba), onCpu(c, source, rgba), rgba);
}

TEST(Tonemap, AcesMatchesTheCpu) {
  compare({}, "Linear Rec.709", 1024, 1024, 1e9f);
}

TEST(Tonemap, EveryOtherBuiltInViewMatchesTheCpu) {
  for (const char* display : {"sRGB", "Rec.1886"}) {
    for (const char* view : {"ACES SDR", "Standard", "Raw"}) {
      SCOPED_TRACE(fmt::format("{}, {}", display, view));
      compare({.display = display, .view = view}, "Linear Rec.709", 128, 64, 1e9f);
    }
  }
}

TEST(Tonemap, MiddleGreyIsWhereAcesPutsIt) {
  OnePass pass(tonemap({}), 1, 1);
  for (float channel : pass.show({0.18f, 0.18f, 0.18f, 0.5f})) {
    EXPECT_NEAR(channel, channel == 1.0f ? 1.0f : 0.356f, 1e-3f);
  }
}

TEST(Tonemap, WhatIsNotFiniteBecomesFinite) {
  OnePass pass(tonemap({.view = "Raw"}), 4, 1);
  const float most = 1073741824.0f;
  EXPECT_EQ(pass.show({kNan, -kNan, 1, kNan, kInfinity, -kInfinity, 2, 0, 1e38f, 0, 3, 0, -0.0f, -1, 4, 0}),
            (std::vector<float>{0, 0, 1, 1, most, -most, 2, 1, most, 0, 3, 1, 0, -1, 4, 1}));
  OnePass aces(tonemap({}), 1, 1);
  for (float x : aces.show({kInfinity, kNan, -kInfinity, 0})) EXPECT_TRUE(std::isfinite(x)) << x;
}

TEST(Tonemap, OneExposureValueIsAFactorOfTwo) {
  const std::vector<float> rgba = colours(64 * 64, 1000.0f);
  for (float exposure : {-3.0f, -1.0f, 1.0f, 2.0f}) {
    std::vector<float> scaled = rgba;
    for (float& x : scaled) x = std::ldexp(x, static_cast<int>(exposure));
    OnePass exposed(tonemap({.exposure = exposure}), 64, 64), plain(tonemap({}), 64, 64);
    EXPECT_EQ(exposed.show(rgba), plain.show(scaled)) << exposure;
  }
  compare({.exposure = 0.3f}, "Linear Rec.709", 64, 64, 1000.0f);
  // What overflows only without the exposure isn't lost.
  OnePass dark(tonemap({.view = "Raw", .exposure = -20.0f}), 1, 1);
  EXPECT_EQ(dark.show({1e12f, 1e12f, 1e12f, 1})[0], std::ldexp(1e12f, -20));
}

TEST(Tonemap, LookupTablesMatchTheCpu) {
  const TemporaryFolder folder;
  const std::string config = lutConfig(folder);
  for (const char* view : {"curve", "long", "cube", "tetrahedra", "both", "live"}) {
    SCOPED_TRACE(view);
    compare({.config = config, .view = view}, "lin", 128, 128, 4.0f);
  }
}

TEST(Tonemap, ANearestTableHasSteps) {
  // Which side of a step a colour falls on is a matter of rounding: away from the steps.
  const TemporaryFolder folder;
  const Choice c = {.config = lutConfig(folder), .view = "nearest"};
  std::vector<float> rgba;
  for (int i = 0; i < 64; ++i) {
    const float x = (static_cast<float>(i / 4) + 0.3f * static_cast<float>(i % 4 - 1)) / 16.0f;
    if (i % 4 != 3) rgba.insert(rgba.end(), {x, x, x, 1.0f});
  }
  OnePass pass(tonemap(c), static_cast<uint32_t>(rgba.size() / 4), 1);
  expectNear(pass.show(rgba), onCpu(c, "lin", rgba), rgba);
}

TEST(Tonemap, AForeignSceneLinearIsNotMistakenForOurs) {
  const TemporaryFolder folder;
  const std::vector<float> rgba = {1.0f, 0.0f, 0.0f, 1.0f, 0.2f, 0.4f, 0.1f, 1.0f};
  const Choice c = {.config = foreignConfig(folder, true), .view = "plain"};
  OnePass pass(tonemap(c), 2, 1);
  // In and out are the same primaries, so that only the curve is left.
  const std::vector<float> shown = pass.show(rgba);
  const float expected[] = {1.0f, 0.0f, 0.0f, 1.0f, 0.4845f, 0.6652f, 0.3492f, 1.0f};
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(shown[i], expected[i], kTolerance) << i;

  OnePass named(tonemap({.config = c.config, .view = "plain", .space = "AP1"}), 2, 1);
  expectNear(named.show(rgba), onCpu(c, "AP1", rgba), rgba);
  EXPECT_GT(std::abs(named.show(rgba)[0] - shown[0]), 0.1f);

  OnePass untouched(tonemap({.config = c.config, .view = "untouched"}), 2, 1);
  EXPECT_EQ(untouched.show(rgba), rgba);
}

TEST(Tonemap, WithoutTheRoleSceneLinearIsTakenAsItIs) {
  const TemporaryFolder folder;
  const std::vector<float> rgba = {1.0f, 0.0f, 0.0f, 1.0f, 0.2f, 0.4f, 0.1f, 1.0f};
  const Choice c = {.config = foreignConfig(folder, false), .view = "plain"};
  OnePass pass(tonemap(c), 2, 1);
  expectNear(pass.show(rgba), onCpu(c, "AP1", rgba), rgba);
}

TEST(Tonemap, AWrongViewIsRefusedWithTheChoices) {
  try {
    OnePass pass(tonemap({.view = "Standart"}), 1, 1);
    FAIL() << "not refused";
  } catch (const InputError& e) {
    for (const char* part : {"Standart", "ACES SDR, Standard, Raw", "did you mean \"Standard\""}) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace weir::test
