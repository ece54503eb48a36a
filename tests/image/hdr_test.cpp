// Radiance pictures, written here byte by byte from the format's description.
#include <weir/image/hdr.h>

#include <cmath>

#include "image/support.h"

namespace weir::image {
namespace {

const std::string kHead = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

std::string texel(int r, int g, int b, int e) {
  return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

Picture read(const std::string& bytes) {
  const Scratch scratch;
  std::ofstream(scratch / "a.hdr", std::ios::binary) << bytes;
  return readHdr(scratch / "a.hdr");
}

std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool names(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(Hdr, FlatTexels) {
  const Picture p = read(kHead + "-Y 1 +X 3\n" + texel(128, 64, 32, 129) + texel(255, 0, 1, 140) + texel(9, 9, 9, 0));
  ASSERT_EQ(p.width, 3u);
  ASSERT_EQ(p.height, 1u);
  // mantissa / 256 · 2^(exponent - 128)
  EXPECT_EQ(p.at(0, 0)[0], 1.0f);
  EXPECT_EQ(p.at(0, 0)[1], 0.5f);
  EXPECT_EQ(p.at(0, 0)[2], 0.25f);
  EXPECT_EQ(p.at(0, 0)[3], 1.0f);
  EXPECT_EQ(p.at(1, 0)[0], 255.0f * 16.0f);
  EXPECT_EQ(p.at(1, 0)[2], 16.0f);
  EXPECT_EQ(p.at(2, 0)[0], 0.0f) << "exponent 0 is black";
}

TEST(Hdr, ExtremeExponentsStayFinite) {
  const Picture p = read(kHead + "-Y 1 +X 2\n" + texel(255, 255, 255, 255) + texel(1, 1, 1, 1));
  EXPECT_TRUE(std::isfinite(p.at(0, 0)[0]));
  EXPECT_GT(p.at(1, 0)[0], 0.0f);
}

/// A scan line of eight texels: reds a run, greens written out, blues both, one exponent.
std::string coded() {
  return std::string{2, 2, 0, 8} + std::string{static_cast<char>(128 + 8), static_cast<char>(200)} +
         std::string{8, 1, 2, 3, 4, 5, 6, 7, 8} + std::string{3, 10, 20, 30, static_cast<char>(128 + 5), 40} +
         std::string{static_cast<char>(128 + 8), static_cast<char>(136)};
}

TEST(Hdr, RunsByChannel) {
  const Picture p = read(kHead + "-Y 2 +X 8\n" + coded() + coded());
  for (uint32_t y = 0; y < 2; ++y) {
    for (uint32_t x = 0; x < 8; ++x) {
      EXPECT_EQ(p.at(x, y)[0], 200.0f);
      EXPECT_EQ(p.at(x, y)[1], static_cast<float>(x + 1));
      EXPECT_EQ(p.at(x, y)[2], x < 3 ? 10.0f * static_cast<float>(x + 1) : 40.0f);
    }
  }
}

TEST(Hdr, RunsOfTheOlderKind) {
  // One texel, then a run of 2 and one of 1·256, which goes on: 259 texels in all.
  const Picture p =
      read(kHead + "-Y 1 +X 259\n" + texel(7, 8, 9, 136) + texel(1, 1, 1, 2) + texel(1, 1, 1, 1) + std::string(0, ' '));
  for (uint32_t x = 0; x < 259; ++x) ASSERT_EQ(p.at(x, 0)[1], 8.0f);
}

TEST(Hdr, ExposureAndColourCorrectionAreUndone) {
  const std::string head =
      "#?RGBE\nEXPOSURE= 2.0\nEXPOSURE=4\nCOLORCORR= 1 2 4\nFORMAT=32-bit_rle_rgbe\nSOFTWARE=x\n\n";
  const Picture p = read(head + "-Y 1 +X 1\n" + texel(64, 64, 64, 136));
  EXPECT_EQ(p.at(0, 0)[0], 8.0f);
  EXPECT_EQ(p.at(0, 0)[1], 4.0f);
  EXPECT_EQ(p.at(0, 0)[2], 2.0f);
}

TEST(Hdr, RowsAndColumnsInAnyOrder) {
  const std::string data = texel(1, 0, 0, 136) + texel(2, 0, 0, 136) + texel(3, 0, 0, 136) + texel(4, 0, 0, 136);
  const struct {
    const char* size;
    float expected[4];
  } cases[] = {{"-Y 2 +X 2\n", {1, 2, 3, 4}},
               {"+Y 2 +X 2\n", {3, 4, 1, 2}},
               {"-Y 2 -X 2\n", {2, 1, 4, 3}},
               {"+Y 2 -X 2\n", {4, 3, 2, 1}}};
  for (const auto& c : cases) {
    const Picture p = read(kHead + c.size + data);
    for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(p.at(i % 2, i / 2)[0], c.expected[i]) << c.size;
  }
}

TEST(Hdr, WhatIsWrongIsSaid) {
  const std::string one = texel(1, 1, 2, 128);
  EXPECT_TRUE(names(refusal("P6 1 1 255\n"), "#?"));
  EXPECT_TRUE(names(refusal("#?RADIANCE\n"), "no end"));
  EXPECT_TRUE(names(refusal("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + one), "xyze"));
  EXPECT_TRUE(names(refusal("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + one), "positive"));
  EXPECT_TRUE(names(refusal("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n" + one), "positive"));
  EXPECT_TRUE(names(refusal(kHead + "+X 1 -Y 1\n" + one), "resolution"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X\n" + one), "resolution"));
  EXPECT_TRUE(names(refusal(kHead + "-Y -1 +X 1\n" + one), "resolution"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 0 +X 1\n" + one), "0"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 99999 +X 99999\n" + one), "limit"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 10000 +X 10000\n" + one), "too few"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 2\n" + one), "early"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 2\n" + texel(1, 1, 1, 1) + one), "run"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 2\n" + one + texel(1, 1, 1, 2)), "run"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 9\n" + coded()), "as long as"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 8\n" + std::string{2, 2, 0, 8, 0}), "run"));
  EXPECT_TRUE(names(refusal(kHead + "-Y 1 +X 8\n" + std::string{2, 2, 0, 8, 9}), "run"));
  EXPECT_THROW(readHdr("/nonexistent/a.hdr"), InputError);
}

// Cut anywhere, or with any byte changed: a picture or an InputError.
TEST(Hdr, DamagedFilesNeverCrash) {
  const std::string whole = kHead + "-Y 2 +X 8\n" + coded() + coded();
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(read(whole.substr(0, length)), InputError) << length;
  }
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const int value : {0, 1, 2, 127, 128, 129, 255}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(value);
      try {
        EXPECT_LE(read(damaged).rgba.size(), 4u * 64 * damaged.size());
      } catch (const InputError&) {
      }
    }
  }
}

TEST(Hdr, IsKnownByItsFirstBytes) {
  const Scratch scratch;
  std::ofstream(scratch / "a.exr", std::ios::binary) << kHead + "-Y 1 +X 1\n" + texel(128, 128, 128, 129);
  EXPECT_EQ(fileKind(scratch / "a.exr"), FileKind::Hdr);
  EXPECT_EQ(readPicture(scratch / "a.exr").at(0, 0)[0], 1.0f);
}

}  // namespace
}  // namespace weir::image
