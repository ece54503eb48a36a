// Pixels in words.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <limits>

#include "../../passes/common/layouts.h"
#include "easel.h"
#include "support/small_scenes.h"
#include "view/picture/unpack.h"
#include "view/picture/words.h"

namespace weir::test {
namespace {

class PictureProbe : public ::testing::Test {
 protected:
  /// What a pixel says, by label.
  std::map<std::string, std::string> at(const view::Port& port, uint32_t x, uint32_t y,
                                        std::span<const scene::GpuLight> lights = {}) {
    bool recorded = false;
    easel.device().submitAndWait([&](VkCommandBuffer commands) { recorded = probe.record(commands, 0, port, {x, y}); });
    EXPECT_TRUE(recorded);
    const view::Probed* probed = probe.collect(0);
    if (probed == nullptr) {
      ADD_FAILURE() << "nothing came back";
      return {};
    }
    EXPECT_EQ(probe.collect(0), nullptr) << "once";
    std::map<std::string, std::string> rows;
    for (const view::Row& row : view::wordsOf(*probed, lights)) rows.emplace(row.label, row.text);
    return rows;
  }
  Easel easel;
  view::Probe probe{easel.device()};
};

using Words = std::map<std::string, std::string>;

TEST_F(PictureProbe, ImagesByTheirChannels) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const FilledPort colors =
      easel.image(Format::RGBA32F, 2, 1, std::vector<float>{0, 0, 0, 0, 0.25f, -infinity, nan, 1});
  EXPECT_EQ(
      at(colors, 1, 0),
      (Words{{"pixel", "(1, 0)"}, {"R", "0.25"}, {"G", "-infinity"}, {"B", "NaN"}, {"A", "1"}, {"luminance", "NaN"}}));
  const FilledPort vectors = easel.image(Format::RG32F, 1, 2, std::vector<float>{0, 0, 3, -4});
  EXPECT_EQ(at(vectors, 0, 1), (Words{{"pixel", "(0, 1)"}, {"R", "3"}, {"G", "-4"}, {"length", "5"}}));
  const FilledPort halves = easel.image(Format::RGBA16F, 1, 1, std::vector<uint16_t>{0x3c00, 0xc000, 0x3800, 0x7c00});
  EXPECT_EQ(at(halves, 0, 0)["G"], "-2");
  EXPECT_EQ(at(halves, 0, 0)["A"], "infinity");
  const FilledPort bytes = easel.image(Format::RGBA8, 1, 1, std::vector<uint8_t>{0, 51, 128, 255});
  EXPECT_EQ(at(bytes, 0, 0)["G"], "0.2000 (51 of 255)");
  const FilledPort words = easel.image(Format::R32U, 1, 1, std::vector<uint32_t>{0xffffffffu});
  EXPECT_EQ(at(words, 0, 0)["value"], "4294967295 (0xffffffff)");
  const FilledPort one = easel.image(Format::R32F, 1, 1, std::vector<float>{1.5e-9f});
  EXPECT_EQ(at(one, 0, 0)["R"], "1.5e-09");
}

TEST_F(PictureProbe, SurfacesWithTheirMaterial) {
  std::vector<passes::PackedSurface> surfaces(3, passes::PackedSurface{});
  surfaces[1].distance = 2.0f;
  surfaces[1].shadingNormal = 0x7fffu;        // +x
  surfaces[1].geometricNormal = 0x7fff0000u;  // +y
  surfaces[1].diffuse = 2047u | 0u << 11 | 1023u << 22;
  surfaces[1].specular = 0;
  surfaces[1].roughnessJitter = 0xffffu << 16 | 0x7f7fu;
  surfaces[2].distance = std::numeric_limits<float>::quiet_NaN();
  const FilledPort filled = easel.buffer(layoutOf<passes::PackedSurface>(), 3, 1, 1, surfaces);
  // The middle pixel of an odd row is on the axis.
  const view::Port port{filled.storage, filled.resource, execute::toGpu(lookAt({0, 0, 3}, {0, 0, 0}), 3, 1)};
  Words words = at(port, 1, 0);
  EXPECT_EQ(words["position"], "(0, 0, 1) m");
  EXPECT_EQ(words["distance"], "2 m");
  EXPECT_EQ(words["shading normal"], "(1, 0, 0)");
  EXPECT_EQ(words["geometric normal"], "(0, 1, 0)");
  EXPECT_EQ(words["diffuse albedo"], "(1, 0, 1)");
  EXPECT_EQ(words["roughness"], "1 (alpha 1)");
  EXPECT_EQ(words["sampled at"], "(0.500, 0.500) of the pixel");
  EXPECT_FALSE(words.contains("F90"));
  EXPECT_EQ(at(port, 0, 0), (Words{{"pixel", "(0, 0)"}, {"surface", "none: background"}}));
  EXPECT_EQ(at(port, 2, 0)["surface"], "none: its distance is NaN");
  EXPECT_EQ(at({filled.storage, filled.resource, port.camera, true}, 1, 0)["F90"], "1");
}

std::vector<scene::GpuLight> someLights() {
  using scene::GpuLightKind;
  std::vector<scene::GpuLight> lights(5);
  for (uint32_t k = 0; k < 5; ++k) {
    lights[k].kind = k;
    lights[k].position = {1, 2, 3};
    lights[k].a = {2, 0, 0};
    lights[k].b = {0, 2, 0};
  }
  lights[3].kind |= scene::kLightDoubleSided;
  lights[3].triangle = 17;
  return lights;
}

TEST_F(PictureProbe, ReservoirsWithTheirLights) {
  std::vector<passes::Reservoir> all;
  for (uint32_t k = 0; k < 6; ++k) all.push_back({k, 0x3fff7fffu, 2.5f, 12.0f});
  all[1].light |= view::kSeenBit;
  all[2].light |= view::kHiddenBit;
  all.push_back({0, 0, 0.0f, 0.0f});
  all.push_back({0, 0, 0.0f, 1.0f});
  all.push_back({0, 0, std::numeric_limits<float>::quiet_NaN(), 1.0f});
  const FilledPort port = easel.buffer(layoutOf<passes::Reservoir>(), 9, 1, 1, all);
  const std::vector<scene::GpuLight> lights = someLights();
  EXPECT_EQ(at(port, 0, 0, lights), (Words{{"pixel", "(0, 0)"},
                                           {"sample", "light 0 (point) at (1, 2, 3) m"},
                                           {"place", "(0.49999, 0.24999)"},
                                           {"W", "2.5"},
                                           {"M", "12 frames"},
                                           {"visibility", "not known"}}));
  EXPECT_EQ(at(port, 1, 0, lights)["sample"], "light 1 (spot) at (1, 2, 3) m");
  EXPECT_EQ(at(port, 1, 0, lights)["visibility"], "seen by its shadow ray");
  EXPECT_EQ(at(port, 2, 0, lights)["sample"], "light 2 (directional) along (2, 0, 0)");
  EXPECT_EQ(at(port, 2, 0, lights)["visibility"], "hidden in the last frame");
  EXPECT_EQ(at(port, 3, 0, lights)["sample"], "light 3 (triangle 17) at (1.99998, 2.49998, 3) m");
  EXPECT_EQ(at(port, 3, 0, lights)["W"], "2.5 m\u00b2");
  EXPECT_EQ(at(port, 4, 0, lights)["sample"], "light 4 (environment)");
  EXPECT_EQ(at(port, 5, 0, lights)["sample"], "light 5, and there are 5");
  EXPECT_EQ(at(port, 3, 0)["sample"], "light 3");
  EXPECT_EQ(at(port, 6, 0, lights), (Words{{"pixel", "(6, 0)"}, {"sample", "none: empty"}, {"M", "0 frames"}}));
  EXPECT_EQ(at(port, 7, 0, lights),
            (Words{{"pixel", "(7, 0)"}, {"sample", "none: nothing that lights this was found"}, {"M", "1 frame"}}));
  EXPECT_EQ(at(port, 8, 0, lights)["sample"], "none: its W is NaN");
}

TEST_F(PictureProbe, UnknownLayoutsFieldByField) {
  static constexpr std::array<Field, 3> fields{{{"float", "weight"}, {"ivec2", "step"}, {"uint", "id"}}};
  const Layout layout = makeLayout("Odd", 1, 0, fields.data(), fields.size());
  ASSERT_EQ(layout.stride, 24u);
  const std::vector<uint32_t> words{0x3f000000u, 0, 0xffffffffu, 7, 16, 0, 0x40000000u, 0, 1, 2, 3, 0};
  const FilledPort port = easel.buffer(layout, 1, 1, 2, words);
  EXPECT_EQ(at(port, 0, 0), (Words{{"pixel", "(0, 0)"},
                                   {"[0] weight", "0.5"},
                                   {"[0] step", "(-1, 7)"},
                                   {"[0] id", "16 (0x00000010)"},
                                   {"[1] weight", "2"},
                                   {"[1] step", "(1, 2)"},
                                   {"[1] id", "3 (0x00000003)"}}));
  const FilledPort strip = easel.buffer(layout, 0, 0, 1, words, true);
  EXPECT_EQ(at(strip, 1, 0), (Words{{"element", "1"}, {"weight", "2"}, {"step", "(1, 2)"}, {"id", "3 (0x00000003)"}}));
}

TEST_F(PictureProbe, ManyElementsAreReadInPart) {
  static constexpr std::array<Field, 1> fields{{{"uint", "x"}}};
  const FilledPort port =
      easel.buffer(makeLayout("X", 1, 0, fields.data(), 1), 1, 1, 1030, std::vector<uint32_t>(1030, 5u));
  const Words words = at(port, 0, 0);
  EXPECT_EQ(words.at("[1023] x"), "5 (0x00000005)");
  EXPECT_FALSE(words.contains("[1024] x"));
  EXPECT_EQ(words.at("further"), "6 more elements");
}

TEST_F(PictureProbe, WhatIsNotThereIsNotRead) {
  const FilledPort image = easel.image(Format::R32F, 2, 2, std::vector<float>(4, 0.0f));
  FilledPort shorter = easel.buffer(layoutOf<passes::Reservoir>(), 2, 1, 1, std::vector<passes::Reservoir>(2));
  shorter.resource.width = 3;
  shorter.resource.elements = 3;
  easel.device().submitAndWait([&](VkCommandBuffer commands) {
    EXPECT_FALSE(probe.record(commands, 0, image, {2, 0}));
    EXPECT_FALSE(probe.record(commands, 0, image, {0, 0xffffffffu}));
    EXPECT_THROW(probe.record(commands, 2, image, {0, 0}), InputError);
    const FilledPort none{{}, image.resource};
    EXPECT_THROW(probe.record(commands, 0, none, {0, 0}), InputError);
    EXPECT_FALSE(probe.record(commands, 0, shorter, {2, 0}));
  });
  EXPECT_EQ(probe.collect(0), nullptr);
}

}  // namespace
}  // namespace weir::test
