#include <fmt/format.h>
#include <weir/image/hdr.h>
#include <weir/image/image.h>
#include <weir/image/limits.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace weir::image {

void failRead(const std::string& path, const std::string& reason) {
  throw InputError(fmt::format("cannot read '{}': {}", path, reason));
}

void checkReadSize(const std::string& path, uint64_t width, uint64_t height) {
  if (width == 0 || height == 0) failRead(path, fmt::format("its size is {}x{}", width, height));
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
    failRead(path, fmt::format("its size {}x{} is beyond the limit of {} a side and {} pixels", width, height, kMaxSide,
                               kMaxPixels));
  }
}

void checkWritable(const std::string& path, const Picture& picture) {
  if (picture.width == 0 || picture.height == 0) throw RuntimeError(fmt::format("cannot write '{}': no pixels", path));
  if (picture.rgba.size() != 4 * size_t{picture.width} * picture.height) {
    throw RuntimeError(fmt::format("cannot write '{}': {} floats for {}x{} RGBA pixels", path, picture.rgba.size(),
                                   picture.width, picture.height));
  }
}

FileKind fileKind(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) failRead(path, "it is a folder");
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) failRead(path, std::generic_category().message(errno));
  std::array<unsigned char, 8> head{};
  const size_t count = std::fread(head.data(), 1, head.size(), file);
  std::fclose(file);
  static constexpr std::array<unsigned char, 4> exr{0x76, 0x2f, 0x31, 0x01};
  static constexpr std::array<unsigned char, 8> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (count >= exr.size() && std::memcmp(head.data(), exr.data(), exr.size()) == 0) return FileKind::Exr;
  if (count >= png.size() && std::memcmp(head.data(), png.data(), png.size()) == 0) return FileKind::Png;
  if (count >= 2 && head[0] == '#' && head[1] == '?') return FileKind::Hdr;
  failRead(path, count == 0 ? "the file is empty" : "neither an OpenEXR nor a Radiance nor a PNG file");
}

Picture readPicture(const std::string& path) {
  switch (fileKind(path)) {
    case FileKind::Exr:
      return readExr(path);
    case FileKind::Hdr:
      return readHdr(path);
    default:
      return readPng(path);
  }
}

}  // namespace weir::image
