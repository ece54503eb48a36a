// OpenEXR behind the two functions of image.h.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <weir/image/atomic_file.h>
#include <weir/image/exr_guard.h>
#include <weir/image/limits.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <string_view>
#include <system_error>

namespace weir::image {
namespace {

constexpr size_t kPixelBytes = 4 * sizeof(float);

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// OpenEXR's own file streams do not notice a failed write until much later, if at all; stdio's error flag does.
class WriteStream final : public Imf::OStream {
 public:
  WriteStream(std::FILE* file, const std::string& path) : Imf::OStream(path.c_str()), file_(file) {}
  void write(const char bytes[], int count) override {
    if (std::fwrite(bytes, 1, static_cast<size_t>(count), file_) != static_cast<size_t>(count)) {
      throw std::system_error(errno, std::generic_category());
    }
  }
  uint64_t tellp() override { return static_cast<uint64_t>(::ftello(file_)); }
  void seekp(uint64_t position) override { ::fseeko(file_, static_cast<off_t>(position), SEEK_SET); }

 private:
  std::FILE* file_;
};

/// Shares the FILE that the guard has walked, so that what was checked is what is read.
class ReadStream final : public Imf::IStream {
 public:
  ReadStream(std::FILE* file, const std::string& path) : Imf::IStream(path.c_str()), file_(file) {}
  bool read(char bytes[], int count) override {
    if (count < 0 || std::fread(bytes, 1, static_cast<size_t>(count), file_) != static_cast<size_t>(count)) {
      throw std::runtime_error("the file ends too early");
    }
    const int next = std::getc(file_);
    if (next == EOF) return false;
    std::ungetc(next, file_);
    return true;
  }
  uint64_t tellg() override { return static_cast<uint64_t>(::ftello(file_)); }
  void seekg(uint64_t position) override {
    // Positions come from the file's own tables; beyond the sign bit they would be negative offsets.
    if (position > static_cast<uint64_t>(INT64_MAX) || ::fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) {
      throw std::runtime_error("a chunk lies outside the file");
    }
  }
  void clear() override { std::clearerr(file_); }

 private:
  std::FILE* file_;
};

std::string channelNames(const Imf::ChannelList& channels) {
  std::string names;
  int count = 0;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    if (++count > 16) return names + ", …";
    names += (names.empty() ? "" : ", ") + std::string(c.name());
  }
  return names.empty() ? "none" : names;
}

/// Source channel of each of R, G, B; throws if the file has no picture in the sense of image.h.
std::array<const char*, 3> colourChannels(const std::string& path, const Imf::ChannelList& channels) {
  const bool r = channels.findChannel("R"), g = channels.findChannel("G"), b = channels.findChannel("B");
  if (r && g && b) return {"R", "G", "B"};
  const bool chroma = channels.findChannel("RY") || channels.findChannel("BY");
  if (!r && !g && !b && channels.findChannel("Y") && !chroma) return {"Y", "Y", "Y"};
  // A missing colour is not made up: filled with zeros it would only show as a wrong error figure later.
  failRead(path, fmt::format("it needs the channels R, G, B or a single Y; it has: {}", channelNames(channels)));
}

Imf::FrameBuffer frameBuffer(const std::array<const char*, 3>& colours, bool alpha, const Imath::Box2i& window,
                             float* rgba, size_t rowBytes) {
  // Slices address absolute pixel coordinates: the base is where pixel (0,0) would lie. Slice::Make computes it without
  // forming an out-of-range pointer.
  Imf::FrameBuffer buffer;
  const auto add = [&](const char* name, size_t offset, double fill) {
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, rgba + offset, window, kPixelBytes, rowBytes, 1, 1, fill));
  };
  const bool grey = std::string_view(colours[0]) == "Y";
  for (size_t c = 0; c < (grey ? 1u : 3u); ++c) add(colours[c], c, 0.0);
  if (alpha) add("A", 3, 1.0);
  return buffer;
}

Picture read(const std::string& path, std::FILE* file) {
  ReadStream stream(file, path);
  Imf::InputFile input(stream, 0);
  const Imf::Header& header = input.header();
  const Imath::Box2i window = header.dataWindow();
  Picture picture;
  picture.width = static_cast<uint32_t>(int64_t{window.max.x} - window.min.x + 1);
  picture.height = static_cast<uint32_t>(int64_t{window.max.y} - window.min.y + 1);
  checkReadSize(path, picture.width, picture.height);

  const auto colours = colourChannels(path, header.channels());
  const bool alpha = header.channels().findChannel("A") != nullptr;
  const size_t rowFloats = 4 * size_t{picture.width};
  // Reserved whole but filled band by band: a header that promises pixels that aren't there fails in the first band,
  // before memory was touched for the rest.
  picture.rgba.reserve(rowFloats * picture.height);
  picture.rgba.resize(rowFloats);
  input.setFrameBuffer(frameBuffer(colours, alpha, window, picture.rgba.data(), rowFloats * sizeof(float)));
  constexpr uint32_t kBand = 256;
  for (uint32_t first = 0; first < picture.height; first += kBand) {
    const uint32_t last = std::min(first + kBand, picture.height) - 1;
    picture.rgba.resize(rowFloats * (last + 1));
    input.readPixels(window.min.y + static_cast<int>(first), window.min.y + static_cast<int>(last));
  }
  const bool grey = std::string_view(colours[0]) == "Y";
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (grey) picture.rgba[i + 1] = picture.rgba[i + 2] = picture.rgba[i];
    if (!alpha) picture.rgba[i + 3] = 1.0f;
  }
  for (auto a = header.begin(); a != header.end(); ++a) {
    // "type" is the file's own structure (scan lines or tiles), not something that the picture says.
    if (std::string_view(a.name()) == "type") continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
      picture.attributes[a.name()] = text->value();
    }
  }
  return picture;
}

Imf::Header makeHeader(const Picture& picture, bool alpha) {
  Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  if (alpha) header.channels().insert("A", Imf::Channel(Imf::FLOAT));
  for (const auto& [name, value] : picture.attributes) header.insert(name, Imf::StringAttribute(value));
  return header;
}

}  // namespace

void writeExr(const std::string& path, const Picture& picture, bool alpha) {
  checkWritable(path, picture);
  AtomicFile file(path);
  try {
    WriteStream stream(file.stream(), path);
    Imf::OutputFile output(stream, makeHeader(picture, alpha), 0);
    Imf::FrameBuffer buffer;
    const char* names[4] = {"R", "G", "B", "A"};
    auto* base = reinterpret_cast<char*>(const_cast<float*>(picture.rgba.data()));  // OpenEXR only reads through it
    for (size_t c = 0; c < (alpha ? 4u : 3u); ++c) {
      buffer.insert(names[c],
                    Imf::Slice(Imf::FLOAT, base + c * sizeof(float), kPixelBytes, kPixelBytes * picture.width));
    }
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(picture.height));
  } catch (const std::exception& error) {
    throw RuntimeError(fmt::format("cannot write '{}': {}", path, error.what()));
  }
  file.commit();  // also reports what OutputFile's destructor could not: its chunk table goes out there
}

Picture readExr(const std::string& path) {
  if (fileKind(path) != FileKind::Exr) failRead(path, "not an OpenEXR file");
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) failRead(path, std::generic_category().message(errno));
  checkExrHeaders(path, file.get());
  std::rewind(file.get());
  try {
    return read(path, file.get());
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    failRead(path, "not enough memory");
  } catch (const std::exception& error) {
    failRead(path, error.what());
  }
}

}  // namespace weir::image
