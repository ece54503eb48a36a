// Pictures as plain floats, read from and written to files. Row 0 is the top.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace weir::image {

/// RGBA float pixels plus text attributes (EXR header). Radiance is linear Rec.709, never clamped.
struct Picture {
  uint32_t width = 0, height = 0;
  std::vector<float> rgba;  ///< 4 · width · height
  std::map<std::string, std::string> attributes;
  float* at(uint32_t x, uint32_t y) { return &rgba[4 * (size_t{y} * width + x)]; }
  const float* at(uint32_t x, uint32_t y) const { return &rgba[4 * (size_t{y} * width + x)]; }
};

/// 32-bit float scanline EXR with channels R, G, B (and A when `alpha`), ZIP compression, every attribute as a string.
/// Written to a temporary file beside it and renamed. Throws RuntimeError.
void writeExr(const std::string& path, const Picture& picture, bool alpha = false);
/// Any EXR with R, G, B (half or float; missing A is 1; a single channel Y is taken as grey). Throws InputError.
Picture readExr(const std::string& path);

/// How numbers become 8-bit PNG values: Radiance is clamped to [0,1] and sRGB-encoded, Display is clamped only.
enum class Encoding : unsigned char { Radiance, Display };
/// 8-bit RGB, rounded to nearest; non-finite values become magenta. Temporary file and rename. Throws RuntimeError.
void writePng(const std::string& path, const Picture& picture, Encoding encoding);
/// 8- or 16-bit PNG, values/max as they are (no decoding of sRGB). Throws InputError.
Picture readPng(const std::string& path);

enum class FileKind : unsigned char { Exr, Png, Hdr };
/// What the file is by its first bytes, whatever its name says. Throws InputError.
FileKind fileKind(const std::string& path);
/// readExr, readPng or readHdr (image/hdr.h) by fileKind(). Throws InputError.
Picture readPicture(const std::string& path);

}  // namespace weir::image
