#include <weir/core/error.h>
#include <weir/scene/gltf_compression.h>
#include <weir/scene/gltf_file.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace weir::scene {
namespace {

// Deeper than any glTF needs (a material extension's texture is at 7) and shallow enough for every recursion.
constexpr int kJsonDepth = 64;
// "{}" is two bytes in a file and up to kilobytes as a parsed node or material.
constexpr uint64_t kJsonObjects = 1'000'000;

uint32_t readLittle(std::span<const uint8_t> bytes, size_t at) {
  return bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (static_cast<uint32_t>(bytes[at + 3]) << 24);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percentDecode(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
    const int low = high >= 0 ? hexDigit(text[i + 2]) : -1;
    if (low >= 0) {
      out += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

/// RFC 4648 base64, padding optional; false on any other character.
bool decodeBase64(std::string_view text, Bytes& out) {
  static const std::array<int16_t, 256> values = [] {
    std::array<int16_t, 256> t;
    t.fill(-1);
    const std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < alphabet.size(); ++i) t[static_cast<uint8_t>(alphabet[i])] = static_cast<int16_t>(i);
    return t;
  }();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int count = 0;
  for (char c : text) {
    const int value = values[static_cast<uint8_t>(c)];
    if (value < 0) return false;
    bits = (bits << 6) | static_cast<uint32_t>(value);
    if ((count += 6) >= 8) out.push_back(static_cast<uint8_t>(bits >> (count -= 8)));
  }
  return true;
}

}  // namespace

Bytes readWholeFile(const std::string& path, uint64_t limit) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(path + ": no such file");
  // A pipe or a device could block for ever.
  if (!std::filesystem::is_regular_file(status)) throw InputError(path + ": not a regular file");
  const uint64_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(path + ": " + error.message());
  if (size > limit)
    throw InputError(path + ": " + std::to_string(size) + " bytes, above the limit of " + std::to_string(limit));
  Bytes bytes(size);
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    throw InputError(path + ": can't be read");
  return bytes;
}

GltfFile::GltfFile(const std::string& path, const ImportLimits& limits) : path_(path), limits_(limits) {
  file_ = std::make_shared<const Bytes>(readWholeFile(path, limits.fileBytes));
  loadedBytes_ = file_->size();
  splitContainer();
}

void GltfFile::fail(const std::string& place, const std::string& reason) const {
  throw InputError(path_ + ": " + (place.empty() ? "" : place + ": ") + reason);
}

// glTF 2.0, section 4: a 12-byte header, then chunks of length, type and data.
void GltfFile::splitContainer() {
  const std::span<const uint8_t> bytes(*file_);
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0) return parseJson(bytes);
  if (bytes.size() < 20) fail("", "the GLB header is cut short");
  if (const uint32_t version = readLittle(bytes, 4); version != 2)
    fail("", "GLB version " + std::to_string(version) + "; only 2 is known");
  const uint64_t length = readLittle(bytes, 8);
  if (length > bytes.size())
    fail("", "the GLB header says " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()));
  std::span<const uint8_t> text;
  uint64_t at = 12;
  for (int chunk = 0; at + 8 <= length; ++chunk) {
    const uint64_t size = readLittle(bytes, at);
    const uint32_t type = readLittle(bytes, at + 4);
    if (at + 8 + size > length) fail("", "GLB chunk " + std::to_string(chunk) + " is cut short");
    const auto data = bytes.subspan(at + 8, size);
    if (chunk == 0) {
      if (type != 0x4E4F534A) fail("", "the first GLB chunk is not JSON");
      text = data;
    } else if (chunk == 1 && type == 0x004E4942) {
      binary_ = data;
    }  // other chunks belong to extensions and are to be skipped
    at += 8 + size;
  }
  if (text.empty()) fail("", "the GLB has no JSON chunk");
  parseJson(text);
}

void GltfFile::parseJson(std::span<const uint8_t> text) {
  int depth = 0;
  uint64_t objects = 0;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const uint8_t c = text[i];
    if (quoted) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kJsonDepth) fail("", "JSON nested more than " + std::to_string(kJsonDepth) + " deep");
      if (c == '{' && ++objects > kJsonObjects) fail("", "more than " + std::to_string(kJsonObjects) + " JSON objects");
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  try {
    json_ = nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::exception& e) {
    fail("", std::string("not glTF: ") + e.what());
  }
  if (!json_.is_object()) fail("", "not glTF: the JSON is not an object");
}

std::span<const uint8_t> GltfFile::resolve(const std::string& uri, const std::string& place) {
  if (uri.starts_with("data:")) {
    auto& bytes = loaded_["data:" + place];
    if (!bytes) {
      const size_t comma = uri.find(',');
      if (comma == std::string::npos) fail(place, "a data URI without data");
      Bytes decoded;
      if (std::string_view(uri).substr(0, comma).ends_with(";base64")) {
        if (!decodeBase64(std::string_view(uri).substr(comma + 1), decoded))
          fail(place, "a data URI that is not base64");
      } else {
        const std::string plain = percentDecode(uri.substr(comma + 1));
        decoded.assign(plain.begin(), plain.end());
      }
      loadedBytes_ += decoded.size();
      bytes = std::make_shared<const Bytes>(std::move(decoded));
    }
    return *bytes;
  }

  namespace fs = std::filesystem;
  const std::string name = percentDecode(uri);
  if (name.empty() || name.find('\0') != std::string::npos) fail(place, "an empty or broken URI");
  std::error_code error;
  const fs::path given(path_);
  const fs::path folder = fs::canonical(given.has_parent_path() ? given.parent_path() : fs::path("."), error);
  if (error) fail(place, "the scene's folder can't be found");
  const fs::path target = fs::weakly_canonical(folder / name, error);
  // Compared part by part after links are resolved: "../x", "/etc/x" and a link that leads out all end here.
  const auto [folderEnd, ignored] = std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
  if (error || folderEnd != folder.end()) fail(place, "\"" + uri + "\" lies outside the scene's folder");
  auto& bytes = loaded_[target.string()];
  if (!bytes) {
    try {
      bytes = std::make_shared<const Bytes>(readWholeFile(target.string(), limits_.fileBytes));
    } catch (const InputError& e) {
      fail(place, e.what());
    }
    loadedBytes_ += bytes->size();
  }
  return *bytes;
}

std::span<const uint8_t> GltfFile::buffer(size_t index) {
  const std::string place = "/buffers/" + std::to_string(index);
  const auto& entry = json_.at("buffers").at(index);
  const uint64_t length = entry.at("byteLength").get<uint64_t>();
  std::span<const uint8_t> bytes;
  if (const auto uri = entry.find("uri"); uri != entry.end()) {
    bytes = resolve(uri->get_ref<const std::string&>(), place);
  } else if (index == 0) {
    bytes = binary_;
  } else {
    fail(place, "has no uri");
  }
  if (bytes.size() < length)
    fail(place, "byteLength is " + std::to_string(length) + ", there are " + std::to_string(bytes.size()) + " bytes");
  return bytes.first(length);
}

namespace {

/// The extension's object of some object, or null.
const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return nullptr;
  const auto found = extensions->find(name);
  return found == extensions->end() ? nullptr : &*found;
}

}  // namespace

std::span<const uint8_t> GltfFile::slice(const nlohmann::json& entry, const std::string& place) {
  const auto bytes = buffer(entry.at("buffer").get<size_t>());
  const uint64_t offset = entry.value("byteOffset", uint64_t{0});
  const uint64_t length = entry.at("byteLength").get<uint64_t>();
  // Both fit in 53 bits (schema), so the sum can't wrap.
  if (offset + length > bytes.size())
    fail(place, "ends at byte " + std::to_string(offset + length) + " of a buffer of " + std::to_string(bytes.size()));
  return bytes.subspan(offset, length);
}

std::span<const uint8_t> GltfFile::bufferView(size_t index) {
  const auto& entry = json_.at("bufferViews").at(index);
  const std::string place = "/bufferViews/" + std::to_string(index);
  const auto* meshopt = extensionOf(entry, "EXT_meshopt_compression");
  if (!meshopt) return slice(entry, place);

  auto& bytes = loaded_["meshopt:" + place];
  if (!bytes) {
    const std::string inside = place + "/extensions/EXT_meshopt_compression";
    const auto compressed = slice(*meshopt, inside);
    std::string reason;
    Bytes decoded = decodeMeshopt(*meshopt, compressed, reason);
    if (!reason.empty()) fail(inside, reason);
    // Many views of the same compressed bytes would multiply them.
    if ((expandedBytes_ += decoded.size()) > kMeshoptExpansion * loadedBytes_)
      fail(inside, "all views together expand to more than " + std::to_string(kMeshoptExpansion) + " times the files");
    bytes = std::make_shared<const Bytes>(std::move(decoded));
  }
  return *bytes;
}

std::span<const uint8_t> GltfFile::image(size_t index) {
  const std::string place = "/images/" + std::to_string(index);
  const auto& entry = json_.at("images").at(index);
  if (const auto view = entry.find("bufferView"); view != entry.end()) return bufferView(view->get<size_t>());
  const auto uri = entry.find("uri");
  if (uri == entry.end()) fail(place, "has neither uri nor bufferView");
  return resolve(uri->get_ref<const std::string&>(), place);
}

}  // namespace weir::scene
