// libpng behind the two functions of image.h.
//
// libpng reports errors by longjmp, which must not skip a destructor: decode() and encode() hold plain data only, every
// owner lives in their callers.
#include <fmt/format.h>
#include <png.h>
#include <weir/image/atomic_file.h>
#include <weir/image/limits.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

namespace weir::image {
namespace {

using Message = std::array<char, 256>;

void onError(png_structp png, png_const_charp text) {
  auto& message = *static_cast<Message*>(png_get_error_ptr(png));
  std::strncpy(message.data(), text, message.size() - 1);
  png_longjmp(png, 1);
}
void onWarning(png_structp, png_const_charp) {}  // a bad colour profile is no news here: values are taken as they are

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

struct Reader {
  Message message{};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, onError, onWarning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
  Message message{};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, onError, onWarning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

struct Layout {
  uint32_t width = 0, height = 0;
  int depth = 0, passes = 1;
  size_t storedRowBytes = 0;  ///< as in the file, before it is expanded
  size_t rowBytes = 0;
};

/// Header and transforms: afterwards every row is RGBA of 8 or 16 bits a value. False on an error.
bool readHeader(Reader& reader, std::FILE* file, Layout& layout) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_init_io(reader.png, file);
  png_set_user_limits(reader.png, kMaxSide, kMaxSide);
  png_read_info(reader.png, reader.info);
  layout.width = png_get_image_width(reader.png, reader.info);
  layout.height = png_get_image_height(reader.png, reader.info);
  layout.storedRowBytes = png_get_rowbytes(reader.png, reader.info);
  png_set_expand(reader.png);  // palette to RGB, fewer than 8 bits to 8, tRNS to alpha
  png_set_gray_to_rgb(reader.png);
  png_set_add_alpha(reader.png, 0xffff, PNG_FILLER_AFTER);
  layout.passes = png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  layout.depth = png_get_bit_depth(reader.png, reader.info);
  layout.rowBytes = png_get_rowbytes(reader.png, reader.info);
  return true;
}

bool readRow(Reader& reader, png_bytep row) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_row(reader.png, row, nullptr);
  return true;
}

bool readEnd(Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_end(reader.png, nullptr);
  return true;
}

void appendRow(std::vector<float>& rgba, const unsigned char* row, const Layout& layout) {
  for (size_t i = 0; i < 4 * size_t{layout.width}; ++i) {
    rgba.push_back(layout.depth == 16 ? static_cast<float>(row[2 * i] << 8 | row[2 * i + 1]) / 65535.0f
                                      : static_cast<float>(row[i]) / 255.0f);
  }
}

bool encode(Writer& writer, std::FILE* file, uint32_t width, uint32_t height, const unsigned char* rgb) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_init_io(writer.png, file);
  png_set_IHDR(writer.png, writer.info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Display values were encoded by the tone map of whoever made them, for an sRGB screen: both encodings say sRGB.
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_RELATIVE);
  png_write_info(writer.png, writer.info);
  for (uint32_t y = 0; y < height; ++y) png_write_row(writer.png, rgb + size_t{3} * width * y);
  png_write_end(writer.png, nullptr);
  return true;
}

/// IEC 61966-2-1.
float encodeSrgb(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

std::vector<unsigned char> toBytes(const Picture& picture, Encoding encoding) {
  const size_t pixels = size_t{picture.width} * picture.height;
  std::vector<unsigned char> rgb(3 * pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const float* in = &picture.rgba[4 * i];
    unsigned char* out = &rgb[3 * i];
    if (!std::isfinite(in[0]) || !std::isfinite(in[1]) || !std::isfinite(in[2])) {
      out[0] = out[2] = 255;  // magenta: seen at once, where black or white could be taken for the scene
      out[1] = 0;
      continue;
    }
    for (int c = 0; c < 3; ++c) {
      const float clamped = std::clamp(in[c], 0.0f, 1.0f);
      const float value = encoding == Encoding::Radiance ? encodeSrgb(clamped) : clamped;
      out[c] = static_cast<unsigned char>(std::min(255.0f, value * 255.0f + 0.5f));
    }
  }
  return rgb;
}

}  // namespace

void writePng(const std::string& path, const Picture& picture, Encoding encoding) {
  checkWritable(path, picture);
  const std::vector<unsigned char> rgb = toBytes(picture, encoding);
  AtomicFile file(path);
  Writer writer;
  if (!writer.info) throw RuntimeError(fmt::format("cannot write '{}': libpng does not start", path));
  if (!encode(writer, file.stream(), picture.width, picture.height, rgb.data())) {
    throw RuntimeError(fmt::format("cannot write '{}': {}", path, writer.message.data()));
  }
  file.commit();
}

Picture readPng(const std::string& path) {
  if (fileKind(path) != FileKind::Png) failRead(path, "not a PNG file");
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) failRead(path, std::generic_category().message(errno));
  std::error_code ignored;
  Reader reader;
  if (!reader.info) failRead(path, "libpng does not start");
  Layout layout;
  if (!readHeader(reader, file.get(), layout)) failRead(path, reader.message.data());
  checkReadSize(path, layout.width, layout.height);
  // Deflate makes at most 1032 bytes out of one: a header that promises more is corrupt, and isn't worth the memory.
  const uint64_t fileBytes = std::filesystem::file_size(path, ignored);
  if (!ignored && layout.storedRowBytes * layout.height / 1032 > fileBytes) {
    failRead(path, fmt::format("{}x{} pixels cannot be in {} bytes", layout.width, layout.height, fileBytes));
  }

  Picture picture;
  picture.width = layout.width;
  picture.height = layout.height;
  picture.rgba.reserve(4 * size_t{layout.width} * layout.height);
  // An interlaced picture is complete only after its last pass, so all its rows are kept; otherwise one is enough.
  const bool interlaced = layout.passes > 1;
  std::vector<unsigned char> rows(layout.rowBytes * (interlaced ? layout.height : 1));
  for (int pass = 0; pass < layout.passes; ++pass) {
    for (uint32_t y = 0; y < layout.height; ++y) {
      unsigned char* row = rows.data() + (interlaced ? layout.rowBytes * y : 0);
      if (!readRow(reader, row)) failRead(path, reader.message.data());
      if (!interlaced) appendRow(picture.rgba, row, layout);
    }
  }
  for (uint32_t y = 0; interlaced && y < layout.height; ++y) {
    appendRow(picture.rgba, rows.data() + layout.rowBytes * y, layout);
  }
  if (!readEnd(reader)) failRead(path, reader.message.data());
  return picture;
}

}  // namespace weir::image
