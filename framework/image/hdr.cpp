// Radiance pictures (.hdr, .pic). Format: Ward, "Real Pixels", Graphics Gems II, 1991, and "Radiance File Formats"
// (radsite.lbl.gov): text header, one line of resolution, then scan lines of RGBE texels, run-length coded by channel.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/hdr.h>
#include <weir/image/limits.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string_view>
#include <system_error>

namespace weir::image {
namespace {

// Channel-wise runs hold at most 127 values in 2 bytes, so 16 texels a byte. The older kind of run has no such bound:
// files that use it for more than this are refused, as a few bytes could ask for all memory.
constexpr uint64_t kMostTexelsAByte = 64;
constexpr uint64_t kMostHeader = 1 << 16;

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::vector<uint8_t> wholeFile(const std::string& path) {
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) failRead(path, std::generic_category().message(errno));
  std::vector<uint8_t> bytes;
  size_t got = 0;
  do {
    constexpr size_t kStep = 1 << 20;
    const size_t before = bytes.size();
    bytes.resize(before + kStep);
    got = std::fread(bytes.data() + before, 1, kStep, file.get());
    bytes.resize(before + got);
  } while (got > 0);
  if (std::ferror(file.get()) != 0) failRead(path, std::generic_category().message(errno));
  return bytes;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), bytes_(wholeFile(path)) {}

  Picture read() {
    if (!line().starts_with("#?")) fail("not a Radiance picture: it does not begin with \"#?\"");
    header();
    resolution();
    if (uint64_t{picture_.width} * picture_.height > kMostTexelsAByte * (bytes_.size() - at_)) {
      fail(fmt::format("{} bytes of data are too few for {}x{} texels", bytes_.size() - at_, picture_.width,
                       picture_.height));
    }
    picture_.rgba.resize(size_t{4} * picture_.width * picture_.height);
    scanLine_.resize(picture_.width);
    for (uint32_t y = 0; y < picture_.height; ++y) {
      readLine(y);
      store(bottomUp_ ? picture_.height - 1 - y : y);
    }
    return std::move(picture_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { failRead(path_, reason); }

  std::string_view line() {
    const size_t start = at_;
    while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
    if (at_ == bytes_.size() || at_ > kMostHeader) fail("its header has no end");
    std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + start, at_ - start);
    ++at_;
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }

  /// Positive numbers after "NAME=", as many as `count`.
  std::array<float, 3> numbers(std::string_view text, size_t count) const {
    std::array<float, 3> result{1.0f, 1.0f, 1.0f};
    const char *begin = text.data(), *end = text.data() + text.size();
    for (size_t i = 0; i < count; ++i) {
      while (begin != end && *begin == ' ') ++begin;
      const auto [rest, error] = std::from_chars(begin, end, result[i]);
      if (error != std::errc() || !std::isfinite(result[i]) || !(result[i] > 0.0f)) {
        fail(fmt::format("its header holds '{}' where a positive number should be", text.substr(0, 40)));
      }
      begin = rest;
    }
    return result;
  }

  void header() {
    for (std::string_view text = line(); !text.empty(); text = line()) {
      // Both say what the texels were multiplied by when the file was written, each occurrence once more.
      if (text.starts_with("EXPOSURE=")) {
        for (double& m : multiplied_) m *= numbers(text.substr(9), 1)[0];
      } else if (text.starts_with("COLORCORR=")) {
        const std::array<float, 3> by = numbers(text.substr(10), 3);
        for (size_t c = 0; c < 3; ++c) multiplied_[c] *= by[c];
      } else if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe") {
        fail(fmt::format("its '{}' is not supported; expected FORMAT=32-bit_rle_rgbe", text.substr(0, 40)));
      }
    }
  }

  /// "-Y height +X width": rows from the top, columns from the left; either sign may be the other way round.
  void resolution() {
    const std::string_view text = line();
    const char *p = text.data(), *end = text.data() + text.size();
    const auto axis = [&](char name, bool& negative, uint64_t& size) {
      while (p != end && *p == ' ') ++p;
      if (end - p < 2 || (*p != '-' && *p != '+') || p[1] != name) return false;
      negative = *p == '-';
      p += 2;
      while (p != end && *p == ' ') ++p;
      const auto [rest, error] = std::from_chars(p, end, size);
      p = rest;
      return error == std::errc();
    };
    bool down = false, left = false;
    uint64_t height = 0, width = 0;
    if (!axis('Y', down, height) || !axis('X', left, width)) {
      fail(fmt::format("its resolution is '{}'; expected \"-Y HEIGHT +X WIDTH\"", text.substr(0, 40)));
    }
    checkReadSize(path_, width, height);
    picture_.width = static_cast<uint32_t>(width);
    picture_.height = static_cast<uint32_t>(height);
    bottomUp_ = !down;
    rightToLeft_ = left;
  }

  uint8_t byte() {
    if (at_ == bytes_.size()) fail("the file ends too early");
    return bytes_[at_++];
  }

  void readLine(uint32_t y) {
    const uint32_t width = picture_.width;
    // Channel by channel: begins with 2, 2 and the width, which no RGBE texel of a sane writer does.
    if (width >= 8 && width < 32768 && at_ + 4 <= bytes_.size() && bytes_[at_] == 2 && bytes_[at_ + 1] == 2 &&
        bytes_[at_ + 2] < 128) {
      if ((uint32_t{bytes_[at_ + 2]} << 8 | bytes_[at_ + 3]) != width) {
        fail(fmt::format("scan line {} is not as long as the picture is wide", y));
      }
      at_ += 4;
      for (size_t c = 0; c < 4; ++c) readChannel(c, y);
      return;
    }
    uint32_t shift = 0;  // of the length of a run that goes on
    for (uint32_t x = 0; x < width;) {
      std::array<uint8_t, 4> texel{};
      for (uint8_t& b : texel) b = byte();
      if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
        scanLine_[x++] = texel;
        shift = 0;
        continue;
      }
      const uint64_t run = shift < 32 ? uint64_t{texel[3]} << shift : UINT64_MAX;
      if (x == 0 || run > width - x) fail(fmt::format("a run leaves scan line {}", y));
      for (uint64_t i = 0; i < run; ++i, ++x) scanLine_[x] = scanLine_[x - 1];
      shift += 8;
    }
  }

  void readChannel(size_t c, uint32_t y) {
    for (uint32_t x = 0; x < picture_.width;) {
      const uint8_t code = byte();
      const uint32_t count = code > 128 ? code - 128u : code;
      if (count == 0 || count > picture_.width - x) fail(fmt::format("a run leaves scan line {}", y));
      const uint8_t repeated = code > 128 ? byte() : uint8_t{0};
      for (uint32_t i = 0; i < count; ++i) scanLine_[x++][c] = code > 128 ? repeated : byte();
    }
  }

  void store(uint32_t y) {
    for (uint32_t x = 0; x < picture_.width; ++x) {
      const std::array<uint8_t, 4>& from = scanLine_[rightToLeft_ ? picture_.width - 1 - x : x];
      float* to = picture_.at(x, y);
      for (size_t c = 0; c < 3; ++c) {
        to[c] = from[3] == 0 ? 0.0f : static_cast<float>(std::ldexp(from[c], from[3] - 136) / multiplied_[c]);
      }
      to[3] = 1.0f;
    }
  }

  const std::string& path_;
  std::vector<uint8_t> bytes_;
  size_t at_ = 0;
  Picture picture_;
  std::array<double, 3> multiplied_{1.0, 1.0, 1.0};
  bool bottomUp_ = false, rightToLeft_ = false;
  std::vector<std::array<uint8_t, 4>> scanLine_;
};

}  // namespace

Picture readHdr(const std::string& path) {
  try {
    return Reader(path).read();
  } catch (const std::bad_alloc&) {
    failRead(path, "not enough memory");
  }
}

}  // namespace weir::image
