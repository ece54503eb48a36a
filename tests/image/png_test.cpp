#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/image/image.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

#include "image/support.h"

namespace weir::image {
namespace {

/// Writes `rows` as they are, with libpng itself.
void writeForeign(const std::string& path, int width, int height, int depth, int type, bool interlaced,
                  const std::vector<unsigned char>& bytes, bool transparentZero = false) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), depth, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[3] = {{255, 0, 0}, {0, 51, 0}, {0, 0, 255}};
  png_byte alpha[1] = {0};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 3);
  if (transparentZero) png_set_tRNS(png, info, alpha, 1, nullptr);
  png_write_info(png, info);
  const size_t rowBytes = png_get_rowbytes(png, info);
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) rows.push_back(const_cast<png_bytep>(bytes.data()) + rowBytes * size_t(y));
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

void expectPixel(const Picture& picture, uint32_t x, uint32_t y, float r, float g, float b, float a) {
  const float* p = picture.at(x, y);
  EXPECT_FLOAT_EQ(p[0], r);
  EXPECT_FLOAT_EQ(p[1], g);
  EXPECT_FLOAT_EQ(p[2], b);
  EXPECT_FLOAT_EQ(p[3], a);
}

TEST(Png, EncodingsRoundAndClamp) {
  const Scratch scratch;
  Picture picture = constantPicture(6, 1, 0, 0, 0);
  const float values[6][3] = {{0.0f, 1.0f, 2.0f},          {-1.0f, 0.5f, 0.2158605f},
                              {0.0031308f, 0.0f, 0.18f},   {0.25f, 0.75f, 1.f},
                              {std::nanf(""), 0.0f, 0.0f}, {0, std::numeric_limits<float>::infinity(), 0}};
  for (uint32_t x = 0; x < 6; ++x) std::copy(values[x], values[x] + 3, picture.at(x, 0));
  writePng(scratch / "d.png", picture, Encoding::Display);
  writePng(scratch / "r.png", picture, Encoding::Radiance);
  const Picture display = readPng(scratch / "d.png"), radiance = readPng(scratch / "r.png");
  expectPixel(display, 0, 0, 0, 1, 1, 1);
  expectPixel(display, 1, 0, 0, 128 / 255.f, 55 / 255.f, 1);  // 127.5 rounds up
  expectPixel(display, 3, 0, 64 / 255.f, 191 / 255.f, 1, 1);
  expectPixel(radiance, 1, 0, 0, 188 / 255.f, 128 / 255.f, 1);  // sRGB(0.5) = 0.7354, sRGB(0.2158605) = 128/255
  expectPixel(radiance, 2, 0, 10 / 255.f, 0, 118 / 255.f, 1);   // sRGB(0.18) = 0.4614
  for (const Picture& p : {display, radiance}) {
    expectPixel(p, 4, 0, 1, 0, 1, 1);
    expectPixel(p, 5, 0, 1, 0, 1, 1);
  }
}

TEST(Png, EveryEightBitValueSurvives) {
  const Scratch scratch;
  Picture picture = constantPicture(256, 1, 0, 0, 0);
  for (uint32_t x = 0; x < 256; ++x) {
    for (int c = 0; c < 3; ++c) picture.at(x, 0)[c] = float(x) / 255.0f;
  }
  writePng(scratch / "a.png", picture, Encoding::Display);
  EXPECT_EQ(readPng(scratch / "a.png").rgba, picture.rgba);
}

TEST(Png, ReadsGreyPaletteAlphaAndSixteenBits) {
  const Scratch scratch;
  const std::string path = scratch / "a.png";
  for (const bool interlaced : {false, true}) {
    writeForeign(path, 2, 2, 8, PNG_COLOR_TYPE_GRAY, interlaced, {0, 51, 102, 255});
    expectPixel(readPng(path), 1, 0, 0.2f, 0.2f, 0.2f, 1);
    expectPixel(readPng(path), 0, 1, 0.4f, 0.4f, 0.4f, 1);
    writeForeign(path, 4, 1, 2, PNG_COLOR_TYPE_GRAY, interlaced, {0b00011011});
    expectPixel(readPng(path), 2, 0, 2 / 3.f, 2 / 3.f, 2 / 3.f, 1);
    writeForeign(path, 1, 2, 8, PNG_COLOR_TYPE_GRAY_ALPHA, interlaced, {255, 0, 51, 102});
    expectPixel(readPng(path), 0, 1, 0.2f, 0.2f, 0.2f, 0.4f);
    writeForeign(path, 3, 1, 2, PNG_COLOR_TYPE_PALETTE, interlaced, {0b00011000}, true);
    expectPixel(readPng(path), 0, 0, 1, 0, 0, 0);
    expectPixel(readPng(path), 1, 0, 0, 0.2f, 0, 1);
    writeForeign(path, 1, 1, 16, PNG_COLOR_TYPE_RGB, interlaced, {0x12, 0x34, 0xff, 0xff, 0x00, 0x01});
    expectPixel(readPng(path), 0, 0, 0x1234 / 65535.f, 1, 1 / 65535.f, 1);
    writeForeign(path, 1, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, interlaced, {0, 0, 0, 0, 0, 0, 0x80, 0x00});
    expectPixel(readPng(path), 0, 0, 0, 0, 0, 0x8000 / 65535.f);
  }
}

TEST(Png, RefusesWhatIsNoPng) {
  const Scratch scratch;
  expectInputError([&] { readPng(scratch / "none.png"); }, {"none.png", "No such file"});
  writeExr(scratch / "exr.png", randomPicture(2, 2, 1));
  expectInputError([&] { readPng(scratch / "exr.png"); }, {"not a PNG"});
  EXPECT_EQ(fileKind(scratch / "exr.png"), FileKind::Exr);
  EXPECT_EQ(readPicture(scratch / "exr.png").width, 2u);
}

TEST(Png, CorruptFilesAreErrorsOrPicturesNeverCrashes) {
  const Scratch scratch;
  writePng(scratch / "rgb.png", randomPicture(40, 30, 3), Encoding::Display);
  writeForeign(scratch / "palette.png", 16, 16, 8, PNG_COLOR_TYPE_PALETTE, true, std::vector<unsigned char>(256, 1),
               true);
  for (const char* name : {"rgb.png", "palette.png"}) {
    expectSurvivesMutations(scratch / name, scratch / "mutant.png", 200, [](const std::string& p) { readPng(p); });
  }
}

template <class Write>
void expectCleanFailures(const Scratch& scratch, const Write& write) {
  // A missing folder is named.
  try {
    write(scratch / "no/such/folder/a");
    ADD_FAILURE();
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("no/such/folder"), std::string::npos) << error.what();
  }
  EXPECT_THROW(write(scratch / ""), RuntimeError);  // a folder
  EXPECT_THROW(write("/dev/null"), RuntimeError);   // a rename would replace the device
  EXPECT_TRUE(scratch.empty());

  // The file that was there stays when the disk is full half-way.
  writeBytes(scratch / "target", {1, 2, 3});
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{5000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write(scratch / "target"), RuntimeError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(readBytes(scratch / "target"), (std::vector<unsigned char>{1, 2, 3}));
  EXPECT_EQ(scratch.files(), 1u);

  // A link is followed, not replaced.
  std::filesystem::create_symlink(scratch / "target", scratch / "link");
  write(scratch / "link");
  EXPECT_TRUE(std::filesystem::is_symlink(scratch / "link"));
  EXPECT_GT(std::filesystem::file_size(scratch / "target"), 3u);
  EXPECT_EQ(scratch.files(), 2u);
}

TEST(Writing, AFailedExrLeavesNothingBehind) {
  const Picture picture = randomPicture(64, 64, 2);
  expectCleanFailures(Scratch(), [&](const std::string& path) { writeExr(path, picture); });
}

TEST(Writing, AFailedPngLeavesNothingBehind) {
  const Picture picture = randomPicture(64, 64, 2);
  expectCleanFailures(Scratch(), [&](const std::string& path) { writePng(path, picture, Encoding::Display); });
}

TEST(Writing, AReadOnlyFolderIsAnError) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "locked");
  std::filesystem::permissions(scratch / "locked",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THROW(writeExr(scratch / "locked/a.exr", randomPicture(2, 2, 1)), RuntimeError);
}

TEST(Writing, APictureWithoutPixelsIsRefused) {
  const Scratch scratch;
  EXPECT_THROW(writeExr(scratch / "a.exr", Picture{}), RuntimeError);
  Picture wrong = randomPicture(2, 2, 1);
  wrong.rgba.pop_back();
  EXPECT_THROW(writePng(scratch / "a.png", wrong, Encoding::Display), RuntimeError);
  EXPECT_TRUE(scratch.empty());
}

}  // namespace
}  // namespace weir::image
