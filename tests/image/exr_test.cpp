#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>
#include <weir/core/error.h>
#include <weir/image/image.h>

#include <array>
#include <cmath>
#include <limits>

#include "image/support.h"

namespace weir::image {
namespace {

TEST(Exr, RoundTripIsExactIncludingNonFiniteAndNegativeValues) {
  const Scratch scratch;
  Picture picture = randomPicture(37, 21, 1);
  picture.at(0, 0)[0] = -5.0f;
  picture.at(1, 0)[1] = std::numeric_limits<float>::infinity();
  picture.at(2, 0)[2] = std::numeric_limits<float>::quiet_NaN();
  picture.at(3, 0)[0] = 1e30f;
  picture.at(4, 0)[3] = 0.25f;
  writeExr(scratch / "a.exr", picture, true);
  const Picture back = readExr(scratch / "a.exr");
  ASSERT_EQ(back.width, 37u);
  ASSERT_EQ(back.height, 21u);
  EXPECT_TRUE(sameBits(back.rgba, picture.rgba));
}

TEST(Exr, WithoutAlphaItReadsAsOne) {
  const Scratch scratch;
  Picture picture = randomPicture(3, 2, 1);
  for (size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 0.5f;
  writeExr(scratch / "a.exr", picture);
  const Picture back = readExr(scratch / "a.exr");
  for (size_t i = 3; i < back.rgba.size(); i += 4) EXPECT_EQ(back.rgba[i], 1.0f);
  EXPECT_EQ(back.at(2, 1)[2], picture.at(2, 1)[2]);
}

TEST(Exr, AttributesSurvive) {
  const Scratch scratch;
  Picture picture = randomPicture(2, 2, 1);
  picture.attributes = {{"weir.scene", "scenes/box.gltf"},
                        {"weir.graph", "{\"version\": 1,\n\"name\": \"ünïcode\"}"},
                        {"weir.a name longer than thirty-one characters", std::string(10000, 'x')},
                        {"weir.empty", ""}};
  writeExr(scratch / "a.exr", picture);
  EXPECT_EQ(readExr(scratch / "a.exr").attributes, picture.attributes);
}

TEST(Exr, AnAttributeThatTheFormatOwnsIsRefused) {
  const Scratch scratch;
  Picture picture = randomPicture(2, 2, 1);
  picture.attributes = {{"dataWindow", "everything"}};
  EXPECT_THROW(writeExr(scratch / "a.exr", picture), RuntimeError);
  EXPECT_TRUE(scratch.empty());
}

/// Writes a file with OpenEXR itself, the way other programs do.
struct Foreign {
  Imath::Box2i window;
  std::vector<const char*> channels;
  Imf::PixelType type = Imf::HALF;
  bool tiled = false;
  Imf::LineOrder order = Imf::INCREASING_Y;
  Imf::Compression compression = Imf::PIZ_COMPRESSION;

  static float value(int x, int y, size_t channel) {
    return 0.25f * float(x) - 0.5f * float(y) + 8.0f * float(channel);
  }

  void write(const std::string& path) const {
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
    header.compression() = compression;
    header.lineOrder() = order;
    const size_t bytes = type == Imf::HALF ? 2 : 4;
    std::vector<std::vector<char>> data;
    Imf::FrameBuffer buffer;
    for (size_t c = 0; c < channels.size(); ++c) {
      header.channels().insert(channels[c], Imf::Channel(type));
      data.emplace_back(bytes * size_t(width) * size_t(height));
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const float v = value(x, y, c);
          char* out = &data[c][bytes * (size_t(y) * size_t(width) + size_t(x))];
          if (type == Imf::HALF) {
            const Imath::half h(v);
            std::memcpy(out, &h, 2);
          } else {
            std::memcpy(out, &v, 4);
          }
        }
      }
      buffer.insert(channels[c], Imf::Slice::Make(type, data[c].data(), window, bytes, bytes * size_t(width)));
    }
    if (tiled) {
      header.setTileDescription(Imf::TileDescription(16, 8));
      Imf::TiledOutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(buffer);
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      Imf::OutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(buffer);
      file.writePixels(height);
    }
  }
};

void expectColours(const Picture& picture, const std::array<size_t, 3>& source) {
  for (uint32_t y = 0; y < picture.height; ++y) {
    for (uint32_t x = 0; x < picture.width; ++x) {
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(picture.at(x, y)[c], Foreign::value(int(x), int(y), source[c])) << x << ' ' << y << ' ' << c;
      }
    }
  }
}

TEST(Exr, ReadsWhatOthersWrite) {
  const Scratch scratch;
  const std::string path = scratch / "a.exr";
  for (const bool tiled : {false, true}) {
    for (const auto type : {Imf::HALF, Imf::FLOAT}) {
      for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
        for (const auto compression : {Imf::NO_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
          // The data window lies off the origin and sticks out of the display window.
          Foreign{Imath::Box2i({-7, 90}, {32, 379}), {"B", "G", "R"}, type, tiled, order, compression}.write(path);
          const Picture picture = readExr(path);
          ASSERT_EQ(picture.width, 40u);
          ASSERT_EQ(picture.height, 290u);
          expectColours(picture, {2, 1, 0});
          EXPECT_EQ(picture.at(5, 5)[3], 1.0f);
        }
      }
    }
  }
}

TEST(Exr, GreyAndExtraChannels) {
  const Scratch scratch;
  const Imath::Box2i window({0, 0}, {9, 9});
  Foreign{window, {"Y"}}.write(scratch / "y.exr");
  expectColours(readExr(scratch / "y.exr"), {0, 0, 0});
  Foreign{window, {"A", "B", "G", "R", "Z", "normal.X"}}.write(scratch / "more.exr");
  const Picture picture = readExr(scratch / "more.exr");
  expectColours(picture, {3, 2, 1});
  EXPECT_EQ(picture.at(4, 0)[3], Foreign::value(4, 0, 0));
}

TEST(Exr, MissingColoursAreNamed) {
  const Scratch scratch;
  const std::string path = scratch / "rg.exr";
  Foreign{Imath::Box2i({0, 0}, {9, 9}), {"G", "R", "depth"}}.write(path);
  expectInputError([&] { readExr(path); }, {path, "G, R, depth"});
}

TEST(Exr, RefusesWhatIsNoExr) {
  const Scratch scratch;
  expectInputError([&] { readExr(scratch / "none.exr"); }, {"none.exr", "No such file"});
  expectInputError([&] { readExr(scratch / ""); }, {"folder"});
  writeBytes(scratch / "empty.exr", {});
  expectInputError([&] { readExr(scratch / "empty.exr"); }, {"empty"});
  writeBytes(scratch / "text.exr", std::vector<unsigned char>(100, 'x'));
  expectInputError([&] { readExr(scratch / "text.exr"); }, {"neither"});
  writePng(scratch / "png.exr", randomPicture(2, 2, 1), Encoding::Display);
  expectInputError([&] { readExr(scratch / "png.exr"); }, {"not an OpenEXR"});
}

TEST(Exr, AHugeDataWindowIsRefusedBeforeMemoryIs) {
  const Scratch scratch;
  writeExr(scratch / "a.exr", randomPicture(4, 4, 1));
  std::vector<unsigned char> bytes = readBytes(scratch / "a.exr");
  const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const auto found = std::search(bytes.begin(), bytes.end(), name.begin(), name.end());
  ASSERT_NE(found, bytes.end());
  const std::array<unsigned char, 8> corner{0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0};  // 65535, 65535: 2^32 pixels
  std::copy(corner.begin(), corner.end(), found + 21 + 8);
  writeBytes(scratch / "huge.exr", bytes);
  expectInputError([&] { readExr(scratch / "huge.exr"); }, {"huge.exr", "65536x65536", "limit"});
}

TEST(Exr, CorruptFilesAreErrorsOrPicturesNeverCrashes) {
  const Scratch scratch;
  writeExr(scratch / "scan.exr", randomPicture(33, 40, 5), true);
  const Imath::Box2i window({-3, 5}, {40, 60});
  Foreign{window, {"B", "G", "R"}, Imf::HALF, true}.write(scratch / "tiled.exr");
  Foreign{window, {"B", "G", "R"}, Imf::HALF, false, Imf::DECREASING_Y, Imf::B44A_COMPRESSION}.write(scratch /
                                                                                                     "b44.exr");
  Foreign{window, {"Y"}, Imf::FLOAT, false, Imf::INCREASING_Y, Imf::PXR24_COMPRESSION}.write(scratch / "pxr.exr");
  Foreign{window, {"B", "G", "R"}, Imf::HALF, false, Imf::INCREASING_Y, Imf::DWAA_COMPRESSION}.write(scratch /
                                                                                                     "dwa.exr");
  for (const char* name : {"scan.exr", "tiled.exr", "b44.exr", "pxr.exr", "dwa.exr"}) {
    expectSurvivesMutations(scratch / name, scratch / "mutant.exr", 150, [](const std::string& p) { readExr(p); });
  }
}

}  // namespace
}  // namespace weir::image
