// Images of every format, channel by channel, against the values that they were filled with.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <random>

#include "easel.h"
#include "view/picture/uploaded_picture.h"

namespace weir::test {
namespace {

constexpr uint32_t kWidth = 37, kHeight = 21;

/// Values of a pixel as the format holds them, RGBA.
struct Filled {
  FilledPort port;
  std::vector<std::array<float, 4>> values;
};

Filled filled(Easel& easel, Format format) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-0.5f, 1.5f);
  Filled f;
  f.values.resize(size_t{kWidth} * kHeight);
  std::vector<float> floats;
  std::vector<uint16_t> halves;
  std::vector<uint8_t> bytes;
  for (auto& v : f.values) {
    for (float& c : v) c = uniform(random);
    switch (format) {
      case Format::R32F:
        floats.push_back(v[0]);
        v = {v[0], 0, 0, 1};
        break;
      case Format::RG32F:
        floats.insert(floats.end(), {v[0], v[1]});
        v = {v[0], v[1], 0, 1};
        break;
      case Format::RGBA32F:
        floats.insert(floats.end(), v.begin(), v.end());
        break;
      case Format::RGBA16F:
        for (float& c : v) {
          halves.push_back(glm::packHalf1x16(c));
          c = glm::unpackHalf1x16(halves.back());
        }
        break;
      default:
        for (float& c : v) {
          bytes.push_back(static_cast<uint8_t>(byteOf(c)));
          c = static_cast<float>(bytes.back()) / 255.0f;
        }
    }
  }
  if (format == Format::RGBA16F)
    f.port = easel.image(format, kWidth, kHeight, halves);
  else if (format == Format::RGBA8)
    f.port = easel.image(format, kWidth, kHeight, bytes);
  else
    f.port = easel.image(format, kWidth, kHeight, floats);
  return f;
}

double luminance(const std::array<float, 4>& v) {
  return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2];
}

/// What a channel's numbers are at a pixel, by its name.
std::array<double, 3> numbersOf(const std::string& channel, const std::array<float, 4>& v) {
  if (channel == "RGB") return {v[0], v[1], v[2]};
  double x = 0;
  if (channel == "R") x = v[0];
  if (channel == "G") x = v[1];
  if (channel == "B") x = v[2];
  if (channel == "A") x = v[3];
  if (channel == "luminance") x = luminance(v);
  if (channel == "length") x = std::hypot(v[0], v[1]);
  return {x, x, x};
}

TEST(PictureImages, EveryFormatAndChannelShowsItsValuesByTheRange) {
  Easel easel;
  view::PictureMode mode;
  mode.low = -0.25f;
  mode.high = 1.25f;
  for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8}) {
    const Filled f = filled(easel, format);
    for (const view::Channel& channel : view::channelsOf(f.port.resource, Meaning::Data)) {
      if (channel.shows == view::Shows::Direction) continue;
      easel.draw(f.port, channel, mode);
      const std::vector<uint8_t> shown = easel.pixels();
      for (uint32_t y = 0; y < kHeight; ++y) {
        for (uint32_t x = 0; x < kWidth; ++x) {
          const std::array<double, 3> v = numbersOf(channel.name, f.values[size_t{y} * kWidth + x]);
          Rgb wanted{};
          for (size_t c = 0; c < 3; ++c) wanted[c] = byteOf((v[c] + 0.25) / 1.5);
          expectNear(Easel::at(shown, x, y), wanted, std::string(formatName(format)) + " " + channel.name);
        }
      }
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(PictureImages, RadianceIsExposedAndEncodedAsInPngFiles) {
  Easel easel;
  const Filled f = filled(easel, Format::RGBA32F);
  const view::Channel rgb = channelNamed(f.port.resource, "RGB", Meaning::Radiance);
  for (const float exposure : {0.0f, -1.5f, 2.0f}) {
    easel.draw(f.port, rgb, {.exposure = exposure});
    const std::vector<uint8_t> shown = easel.pixels();
    for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
      Rgb wanted{};
      for (size_t c = 0; c < 3; ++c) wanted[c] = byteOf(srgbOf(f.values[i][c] * std::exp2(exposure)));
      expectNear(Easel::at(shown, i % kWidth, i / kWidth), wanted, "exposure");
    }
  }
  // What a file would hold, by the code that writes it.
  image::Picture picture{.width = kWidth, .height = kHeight, .rgba = {}, .attributes = {}};
  for (const auto& v : f.values) picture.rgba.insert(picture.rgba.end(), v.begin(), v.end());
  const TemporaryFolder folder;
  image::writePng(folder.path() + "/a.png", picture, image::Encoding::Radiance);
  const image::Picture file = image::readPng(folder.path() + "/a.png");
  easel.draw(f.port, rgb, {});
  const std::vector<uint8_t> shown = easel.pixels();
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
    const float* p = file.at(i % kWidth, i / kWidth);
    expectNear(Easel::at(shown, i % kWidth, i / kWidth), {byteOf(p[0]), byteOf(p[1]), byteOf(p[2])}, "file");
  }
}

TEST(PictureImages, DisplayValuesAndAlphaAreNeitherExposedNorEncoded) {
  Easel easel;
  const Filled f = filled(easel, Format::RGBA32F);
  easel.draw(f.port, channelNamed(f.port.resource, "RGB", Meaning::Display), {.exposure = 3.0f});
  std::vector<uint8_t> shown = easel.pixels();
  for (uint32_t i = 0; i < kWidth; ++i)
    expectNear(Easel::at(shown, i, 0), {byteOf(f.values[i][0]), byteOf(f.values[i][1]), byteOf(f.values[i][2])},
               "display");
  easel.draw(f.port, channelNamed(f.port.resource, "A", Meaning::Radiance), {.exposure = 3.0f});
  shown = easel.pixels();
  for (uint32_t i = 0; i < kWidth; ++i) {
    const int a = byteOf(f.values[i][3]);
    expectNear(Easel::at(shown, i, 0), {a, a, a}, "alpha");
  }
}

TEST(PictureImages, IntegersAreNumbersOrLabels) {
  Easel easel;
  std::vector<uint32_t> values(size_t{kWidth} * kHeight);
  for (uint32_t i = 0; i < values.size(); ++i) values[i] = i % 100;
  values[3] = 0xffffffffu;
  const FilledPort port = easel.image(Format::R32U, kWidth, kHeight, values);
  easel.draw(port, channelNamed(port.resource, "value"), {.low = 0.0f, .high = 100.0f});
  std::vector<uint8_t> shown = easel.pixels();
  for (uint32_t i = 0; i < values.size(); ++i) {
    const int v = byteOf(values[i] / 100.0);
    expectNear(Easel::at(shown, i % kWidth, i / kWidth), {v, v, v}, "value");
  }
  easel.draw(port, channelNamed(port.resource, "label"), {});
  shown = easel.pixels();
  std::map<uint32_t, Rgb> colors;
  std::set<Rgb> different;
  for (uint32_t i = 0; i < values.size(); ++i) {
    const Rgb c = Easel::at(shown, i % kWidth, i / kWidth);
    const auto [known, fresh] = colors.emplace(values[i], c);
    EXPECT_EQ(known->second, c) << "one colour for " << values[i];
    different.insert(c);
  }
  // 101 labels among 205³ colours: two alike once in 1700 sets of labels, and these are always the same.
  EXPECT_EQ(different.size(), colors.size());
}

TEST(PictureImages, DirectionsAreHues) {
  Easel easel;
  const std::vector<float> vectors{4, 0, 0, 4, -4, 0, 0, -4, 2, 0, 0, 0, 400, 0};
  const FilledPort port = easel.image(Format::RG32F, 7, 1, vectors);
  const view::Channel channel = channelNamed(port.resource, "direction");
  easel.draw(port, channel, {.low = 0.0f, .high = 4.0f});
  const std::vector<uint8_t> shown = easel.pixels();
  expectNear(Easel::at(shown, 0, 0), {255, 0, 0}, "right");
  expectNear(Easel::at(shown, 1, 0), {128, 255, 0}, "down");
  expectNear(Easel::at(shown, 2, 0), {0, 255, 255}, "left");
  expectNear(Easel::at(shown, 3, 0), {128, 0, 255}, "up");
  expectNear(Easel::at(shown, 4, 0), {128, 0, 0}, "half as far");
  expectNear(Easel::at(shown, 5, 0), {0, 0, 0}, "nowhere");
  expectNear(Easel::at(shown, 6, 0), {255, 0, 0}, "beyond the range");
}

TEST(PictureImages, FilesAreShownAsPortsAre) {
  Easel easel;
  image::Picture picture{
      .width = 2, .height = 1, .rgba = {0.5f, 0.25f, 1.0f, 1.0f, 0.0f, 2.0f, 0.125f, 1.0f}, .attributes = {}};
  const view::UploadedPicture file(easel.device(), picture, "a.exr");
  const view::Channel rgb = channelNamed(file.resource(), "RGB", Meaning::Radiance);
  easel.draw({file.storage(), file.resource()}, rgb, {});
  const std::vector<uint8_t> shown = easel.pixels();
  expectNear(Easel::at(shown, 0, 0), {byteOf(srgbOf(0.5)), byteOf(srgbOf(0.25)), 255}, "first");
  expectNear(Easel::at(shown, 1, 0), {0, 255, byteOf(srgbOf(0.125))}, "second");
  picture.width = 0;
  EXPECT_THROW(view::UploadedPicture(easel.device(), picture, "a.exr"), InputError);
  picture.width = 3;
  EXPECT_THROW(view::UploadedPicture(easel.device(), picture, "a.exr"), InputError);
}

}  // namespace
}  // namespace weir::test
