#include <fmt/format.h>
#include <weir/image/exr_guard.h>
#include <weir/image/limits.h>

#include <array>
#include <cstdint>

namespace weir::image {
namespace {

constexpr uint32_t kDeep = 0x800, kMultiPart = 0x1000;
constexpr size_t kMaxName = 255;
constexpr uint64_t kMaxTilePixels = uint64_t{1} << 26;

class Walker {
 public:
  Walker(const std::string& path, std::FILE* file) : path_(path), file_(file) {
    ::fseeko(file_, 0, SEEK_END);
    end_ = ::ftello(file_);
    std::rewind(file_);
  }

  uint32_t u32() {
    std::array<unsigned char, 4> b{};
    if (std::fread(b.data(), 1, 4, file_) != 4) failRead(path_, "its header ends too early");
    return b[0] | b[1] << 8 | b[2] << 16 | uint32_t{b[3]} << 24;
  }
  int64_t i32() { return static_cast<int32_t>(u32()); }

  std::string name() {
    std::string text;
    for (int c = std::getc(file_); c != 0; c = std::getc(file_)) {
      if (c == EOF) failRead(path_, "its header ends too early");
      if (text.size() == kMaxName) failRead(path_, "its header holds an attribute name that is too long");
      text += static_cast<char>(c);
    }
    return text;
  }

  /// False when there is no further header.
  bool header() {
    std::string attribute = name();
    if (attribute.empty()) return false;
    for (; !attribute.empty(); attribute = name()) {
      const std::string type = name();
      const int64_t size = i32(), start = ::ftello(file_);
      if (size < 0 || size > end_ - start) {
        failRead(path_, fmt::format("attribute '{}' reaches beyond the end of the file", attribute));
      }
      if (attribute == "dataWindow" && size == 16) checkWindow();
      if (attribute == "tiles" && size == 9) checkTiles();
      ::fseeko(file_, start + size, SEEK_SET);
    }
    return true;
  }

 private:
  void checkWindow() {
    const int64_t x0 = i32(), y0 = i32(), x1 = i32(), y1 = i32();
    if (x1 < x0 || y1 < y0) failRead(path_, fmt::format("its data window ({},{})-({},{}) is empty", x0, y0, x1, y1));
    checkReadSize(path_, static_cast<uint64_t>(x1 - x0 + 1), static_cast<uint64_t>(y1 - y0 + 1));
  }
  void checkTiles() {
    const uint64_t width = u32(), height = u32();
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide || width * height > kMaxTilePixels) {
      failRead(path_, fmt::format("its tiles of {}x{} are beyond the limit", width, height));
    }
  }

  const std::string& path_;
  std::FILE* file_;
  int64_t end_ = 0;
};

}  // namespace

void checkExrHeaders(const std::string& path, std::FILE* file) {
  Walker walker(path, file);
  walker.u32();  // the magic number, already seen by fileKind()
  const uint32_t flags = walker.u32();
  if (flags & kDeep) failRead(path, "it holds deep data, which has no single colour a pixel");
  if (!walker.header()) failRead(path, "its header is empty");
  while ((flags & kMultiPart) && walker.header()) {
  }
}

}  // namespace weir::image
