// Buffers: layouts that Weir knows against the host's own unpacking, unknown ones by their fields, elements, strips.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "../../passes/common/layouts.h"
#include "easel.h"
#include "support/small_scenes.h"
#include "view/picture/unpack.h"

namespace weir::test {
namespace {

constexpr uint32_t kWidth = 23, kHeight = 17;

/// Random words in every field but the distance, which is 0 in every fifth pixel.
std::vector<passes::PackedSurface> surfaces() {
  std::mt19937 random(3);
  std::vector<passes::PackedSurface> all(size_t{kWidth} * kHeight);
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].distance = i % 5 == 0 ? 0.0f : 0.1f + 0.01f * static_cast<float>(i);
    all[i].geometricNormal = random();
    all[i].shadingNormal = random();
    all[i].diffuse = random();
    all[i].specular = random();
    all[i].roughnessJitter = random();
  }
  return all;
}

execute::GpuCamera someCamera() {
  return execute::toGpu(lookAt({1, 2, 3}, {0, 0.5f, -1}), kWidth, kHeight);
}

void expectClose(float is, float wanted, const std::string& what) {
  // A few roundings of numbers of the size of the picture's, on both sides.
  EXPECT_NEAR(is, wanted, 4e-6 * std::max(1.0f, std::abs(wanted))) << what;
}

void compareSurfaces(bool f90) {
  Easel easel;
  const std::vector<passes::PackedSurface> packed = surfaces();
  const FilledPort filled = easel.buffer(layoutOf<passes::PackedSurface>(), kWidth, kHeight, 1, packed);
  const view::Port port{filled.storage, filled.resource, someCamera(), f90};
  using Values = view::SurfaceValues;
  const auto number = [](float x) { return glm::vec3(x); };
  const std::map<std::string, std::function<glm::vec3(const Values&)>> wanted{
      {"distance", [&](const Values& s) { return number(s.distance); }},
      {"position", [](const Values& s) { return s.position; }},
      {"shading normal", [](const Values& s) { return s.shadingNormal; }},
      {"geometric normal", [](const Values& s) { return s.geometricNormal; }},
      {"diffuse albedo", [](const Values& s) { return s.diffuse; }},
      {"F0", [](const Values& s) { return s.f0; }},
      {"base colour", [](const Values& s) { return s.baseColor; }},
      {"metallic", [&](const Values& s) { return number(s.metallic); }},
      {"roughness", [&](const Values& s) { return number(s.roughness); }},
      {"F90", [&](const Values& s) { return number(s.f90); }},
      {"facing", [&](const Values& s) { return number(s.facing); }},
      {"sample place", [](const Values& s) { return glm::vec3(s.samplePlace, 0); }},
  };
  size_t compared = 0;
  for (const view::Channel& channel : view::channelsOf(filled.resource, Meaning::Data, f90)) {
    if (channel.shows == view::Shows::State) continue;
    ASSERT_TRUE(wanted.contains(channel.name)) << channel.name;
    ++compared;
    const auto cells = easel.values({port, channel});
    ASSERT_EQ(cells.size(), packed.size());
    for (uint32_t i = 0; i < packed.size(); ++i) {
      if (i % 5 == 0) {
        EXPECT_EQ(cells[i].finite + cells[i].others, 0u) << channel.name << " of nothing";
        continue;
      }
      const Values s = view::unpackSurface(packed[i], i % kWidth, i / kWidth, {kWidth, kHeight}, port.camera, f90);
      const glm::vec3 v = wanted.at(channel.name)(s);
      // The root in metallic loses half the digits where it starts at zero.
      const float slack = channel.name == "metallic" || channel.name == "base colour" ? 1e-4f : 0.0f;
      for (int c = 0; c < 3; ++c) {
        if (slack > 0.0f)
          EXPECT_NEAR(cells[i].value[c], v[c], slack) << channel.name;
        else
          expectClose(cells[i].value[c], v[c], channel.name);
      }
    }
  }
  EXPECT_EQ(compared, f90 ? wanted.size() : wanted.size() - 1);
}

TEST(PictureBuffers, SurfacesAreWhatTheShadersUnpack) {
  compareSurfaces(false);
}
TEST(PictureBuffers, SurfacesWithF90Too) {
  compareSurfaces(true);
}

TEST(PictureBuffers, BaseColourAndMetallicAreThoseOfTheMaterial) {
  // Packed as glTF's metallic-roughness model makes them, to the nearest code.
  const auto pack = [](const glm::vec3& c) {
    const auto code = [](float v, float steps) { return static_cast<uint32_t>(std::sqrt(v) * steps + 0.5f); };
    return code(c.x, 2047) | code(c.y, 2047) << 11 | code(c.z, 1023) << 22;
  };
  for (const float metallic : {0.0f, 0.3f, 1.0f}) {
    const glm::vec3 base(0.8f, 0.4f, 0.2f);
    passes::PackedSurface p{.distance = 1.0f};
    p.diffuse = pack(base * (1 - metallic));
    p.specular = pack(glm::mix(glm::vec3(0.04f), base, metallic));
    const view::SurfaceValues s = view::unpackSurface(p, 0, 0, {4, 4}, someCamera(), false);
    EXPECT_NEAR(s.metallic, metallic, 0.005);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(s.baseColor[c], base[c], 0.005);
  }
}

std::vector<passes::Reservoir> reservoirs() {
  return {{0, 0, 0.0f, 0.0f},
          {7, 0, 0.0f, 5.0f},
          {7, 0x80004000u, 2.5f, 12.0f},
          {7 | view::kHiddenBit, 0xffffffffu, 0.5f, 1.0f},
          {0x3fffffffu | view::kSeenBit, 0, 1.0f, 20.0f},
          {8, 1, std::numeric_limits<float>::quiet_NaN(), 3.0f}};
}

TEST(PictureBuffers, ReservoirsInTheFieldsTerms) {
  Easel easel;
  const FilledPort port = easel.buffer(layoutOf<passes::Reservoir>(), 6, 1, 1, reservoirs());
  const auto channel = [&](const char* name) { return channelNamed(port.resource, name); };
  auto cells = easel.values({port, channel("light")});
  const std::array<uint32_t, 6> lights{0, 0, 7, 7, 0x3fffffffu, 0};
  const std::array<bool, 6> samples{false, false, true, true, true, false};
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(cells[i].finite, samples[i] ? 1u : 0u);
    EXPECT_EQ(cells[i].word, lights[i]);
  }
  cells = easel.values({port, channel("W")});
  EXPECT_EQ(cells[2].value[0], 2.5f);
  EXPECT_EQ(cells[0].value[0], 0.0f);
  EXPECT_EQ(cells[5].others, 1u);
  cells = easel.values({port, channel("M")});
  EXPECT_EQ(cells[4].value[0], 20.0f);
  cells = easel.values({port, channel("place")});
  EXPECT_FLOAT_EQ(cells[2].value[0], (0x4000 + 0.5f) / 65536);
  EXPECT_FLOAT_EQ(cells[2].value[1], (0x8000 + 0.5f) / 65536);
  cells = easel.values({port, channel("state")});
  const std::array<uint32_t, 6> states{0, 1, 2, 3, 4, 1};
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(cells[i].word, states[i]) << i;

  easel.draw(port, channel("light"), {});
  const std::vector<uint8_t> pixels = easel.pixels();
  EXPECT_EQ(Easel::at(pixels, 2, 0), Easel::at(pixels, 3, 0)) << "the same light, whatever is known of its visibility";
  EXPECT_NE(Easel::at(pixels, 2, 0), Easel::at(pixels, 4, 0));
  expectNear(Easel::at(pixels, 1, 0), {byteOf(0.1), byteOf(0.1), byteOf(0.1)}, "no sample");
  easel.draw(port, channel("W"), {});
  EXPECT_EQ(Easel::at(easel.pixels(), 5, 0), (Rgb{255, 0, 255})) << "NaN";
}

TEST(PictureBuffers, PlacesAreUnpackedAlike) {
  Easel easel;
  std::mt19937 random(5);
  std::vector<uint32_t> places(64);
  for (uint32_t& p : places) p = random();
  places[0] = 0;
  places[1] = 0xffffffffu;
  places[2] = 0x80007fffu;
  const gpu::Buffer in = gpu::uploadBuffer(easel.device(), places, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "places");
  const gpu::Buffer out(easel.device(), 64 * 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                        gpu::Residency::Device, "unpacked");
  const execute::ToolKernel kernel(easel.device(), easel.compiler(),
                                   {.name = "places",
                                    .file = sourcePath("tests/view_picture/shaders/places.glsl"),
                                    .includeFolders = {},
                                    .defines = {},
                                    .images = {false, false}});
  const std::array<execute::ToolBinding, 2> bindings{execute::ToolBinding{.buffer = in.handle()},
                                                     execute::ToolBinding{.buffer = out.handle()}};
  easel.device().submitAndWait([&](VkCommandBuffer commands) { kernel.record(commands, 0, bindings, {}, 8, 8); });
  const std::vector<std::byte> bytes = gpu::readBuffer(easel.device(), out);
  for (size_t i = 0; i < places.size(); ++i) {
    glm::vec4 v;
    std::memcpy(&v, &bytes[16 * i], 16);
    const glm::vec2 place = view::unpackPlace(places[i]), on = view::placeOnTriangle(places[i]);
    EXPECT_EQ(v, glm::vec4(place, on)) << places[i];
  }
}

/// As a plugin that nobody knows would have it.
struct Odd {
  float weight;
  uint32_t pad[3];
  float direction[3];
  uint32_t id;
  int32_t step[2];
  float offset[2];
};
Layout oddLayout() {
  static constexpr std::array<Field, 5> fields{
      {{"float", "weight"}, {"vec3", "direction"}, {"uint", "id"}, {"ivec2", "step"}, {"vec2", "offset"}}};
  static_assert(std430Stride(fields.data(), fields.size()) == sizeof(Odd));
  return makeLayout("Odd", 3, 0, fields.data(), fields.size());
}

TEST(PictureBuffers, UnknownLayoutsAreShownByTheirFields) {
  Easel easel;
  const std::vector<Odd> values{{0.5f, {}, {0.1f, 0.2f, 0.3f}, 77, {-4, 9}, {3.0f, 4.0f}},
                                {-2.5f, {}, {1.0f, 2.0f, 3.0f}, 0xffe00401u, {5, -6}, {0.0f, 1.0f}}};
  const FilledPort port = easel.buffer(oddLayout(), 1, 1, 2, values);
  const std::map<std::string, std::array<std::array<float, 3>, 2>> wanted{
      {"weight", {{{0.5f, 0.5f, 0.5f}, {-2.5f, -2.5f, -2.5f}}}},
      {"direction", {{{0.1f, 0.2f, 0.3f}, {1, 2, 3}}}},
      {"direction.y", {{{0.2f, 0.2f, 0.2f}, {2, 2, 2}}}},
      {"id", {{{77, 77, 77}, {4292871169.0f, 4292871169.0f, 4292871169.0f}}}},
      {"id bits", {{{0, 0, 77.0f / 1023}, {1, 1.0f / 2047, 1.0f / 1023}}}},
      {"step.x", {{{-4, -4, -4}, {5, 5, 5}}}},
      {"step.y", {{{9, 9, 9}, {-6, -6, -6}}}},
      {"offset", {{{5, 5, 5}, {1, 1, 1}}}},  // a vector counts by its length
      {"offset.x", {{{3, 3, 3}, {0, 0, 0}}}},
  };
  for (const auto& [name, both] : wanted) {
    for (uint32_t k = 0; k < 2; ++k) {
      const view::Channel channel = channelNamed(port.resource, name);
      const auto cells = easel.values({port, channel}, k);
      for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(cells[0].value[c], both[k][c]) << name << " of element " << k;
    }
  }
  const view::Channel label = channelNamed(port.resource, "id label");
  EXPECT_EQ(easel.values({port, label}, 1)[0].word, 0xffe00401u);
  view::PictureMode mode;
  mode.element = 2;
  EXPECT_THROW(easel.draw(port, label, mode), InputError);
}

TEST(PictureBuffers, LayoutsWithoutKnownFieldsAreWords) {
  graph::Resource resource;
  resource.type.layout.stride = 12;
  resource.type.layout.fields = {{"mat4", "matrix"}};
  const std::vector<view::Channel> channels = view::channelsOf(resource, Meaning::Data);
  ASSERT_EQ(channels.size(), 9u);
  EXPECT_EQ(channels[6].name, "word 2");
  EXPECT_EQ(channels[6].word, 2u);
  // A stride that is too short for the fields: nothing beyond it is read.
  resource.type.layout.fields = {{"float", "a"}, {"vec4", "b"}};
  EXPECT_EQ(view::channelsOf(resource, Meaning::Data).size(), 1u);
}

TEST(PictureBuffers, ElementsOfAFixedBufferFillRows) {
  Easel easel;
  std::vector<float> values(11);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) / 10;
  static constexpr std::array<Field, 1> fields{{{"float", "x"}}};
  const FilledPort port = easel.buffer(makeLayout("X", 1, 0, fields.data(), 1), 0, 0, 1, values, true);
  EXPECT_EQ(view::extentOf(port.resource), (view::Extent{4, 3}));
  easel.draw(port, channelNamed(port.resource, "x"), {});
  const std::vector<uint8_t> pixels = easel.pixels();
  for (uint32_t i = 0; i < 11; ++i) {
    const int v = byteOf(values[i]);
    expectNear(Easel::at(pixels, i % 4, i / 4), {v, v, v}, "element");
  }
  expectNear(Easel::at(pixels, 3, 2), {byteOf(0.1), byteOf(0.1), byteOf(0.1)}, "no such element");
  expectNear(Easel::at(pixels, 4, 0), {0x1c, 0x1c, 0x1c}, "beside");
  graph::Resource none = port.resource;
  none.elements = 0;
  EXPECT_EQ(view::extentOf(none), (view::Extent{0, 0}));
  const view::Channel x = channelNamed(port.resource, "x");
  easel.draw({{port.storage, none}, x}, {}, easel.plainTarget());
  expectNear(Easel::at(easel.pixels(), 0, 0), {0x1c, 0x1c, 0x1c}, "nothing at all");
}

TEST(PictureBuffers, BuffersShorterThanTheirPlanEndWhereTheyEnd) {
  Easel easel;
  static constexpr std::array<Field, 1> fields{{{"float", "x"}}};
  FilledPort port = easel.buffer(makeLayout("X", 1, 0, fields.data(), 1), 8, 1, 1, std::vector<float>(8, 1.0f));
  port.resource.width = 60;
  port.resource.elements = 60;
  easel.draw(port, channelNamed(port.resource, "x"), {});
  const std::vector<uint8_t> pixels = easel.pixels();
  EXPECT_EQ(Easel::at(pixels, 7, 0)[0], 255);
  EXPECT_LT(Easel::at(pixels, 8, 0)[0], 60);
}

TEST(PictureBuffers, ChannelsOfOtherLayoutsAreRefused) {
  Easel easel;
  const FilledPort port = easel.buffer(layoutOf<passes::Reservoir>(), 6, 1, 1, reservoirs());
  const FilledPort other = easel.buffer(layoutOf<passes::PackedSurface>(), kWidth, kHeight, 1, surfaces());
  EXPECT_THROW(easel.draw(other, channelNamed(port.resource, "W"), {}), InputError);
  EXPECT_THROW(easel.draw(port, channelNamed(other.resource, "roughness"), {}), InputError);
}

}  // namespace
}  // namespace weir::test
