#include <fmt/format.h>
#include <weir/core/cache_folder.h>
#include <weir/shader/digest.h>

#include <bit>
#include <cstring>

namespace weir::shader {
namespace {

/// Two independent 64-bit lanes over 8 bytes at a time: a shader with all its includes takes microseconds. Not for
/// security.
class Hasher {
 public:
  /// The length goes in too, so that "ab" + "c" and "a" + "bc" differ.
  void add(std::string_view text) {
    word(text.size());
    while (text.size() >= 8) {
      uint64_t value;
      std::memcpy(&value, text.data(), 8);
      word(value);
      text.remove_prefix(8);
    }
    uint64_t rest = 0;
    std::memcpy(&rest, text.data(), text.size());
    word(rest);
  }

  Digest digest() const { return {finish(first_), finish(second_)}; }

 private:
  void word(uint64_t value) {
    first_ = (first_ ^ value) * 0x9e3779b97f4a7c15ull;
    first_ ^= first_ >> 29;
    second_ = std::rotl(second_ + value * 0xc2b2ae3d27d4eb4full, 31) * 0xd6e8feb86659fd93ull;
  }

  static uint64_t finish(uint64_t value) {
    value = (value ^ (value >> 32)) * 0xd6e8feb86659fd93ull;
    return value ^ (value >> 32);
  }

  uint64_t first_ = 0x243f6a8885a308d3ull, second_ = 0x13198a2e03707344ull;
};

/// The head of a cache file; SPIR-V words follow.
struct Header {
  char magic[8] = {'W', 'E', 'I', 'R', 'S', 'P', 'V', '1'};
  Digest key;
  uint64_t words = 0;
  Digest checksum;
};

Digest checksumOf(const char* data, size_t size) {
  Hasher hasher;
  hasher.add({data, size});
  return hasher.digest();
}

/// Two letters of folder, so that no folder gets thousands of files.
std::string filePath(const std::string& folder, const Digest& key) {
  const std::string name = key.hex();
  return fmt::format("{}/spirv/{}/{}.spv", folder, name.substr(0, 2), name.substr(2));
}

}  // namespace

std::string Digest::hex() const {
  return fmt::format("{:016x}{:016x}", high, low);
}

Digest digestOf(const CompileRequest& request, const Sources& sources) {
  static const std::string version = compilerVersion();
  Hasher hasher;
  hasher.add(version);
  hasher.add(std::to_string(static_cast<int>(request.stage)));
  hasher.add(request.name);
  hasher.add(std::to_string(request.defines.size()));
  for (const auto& [name, value] : request.defines) {
    hasher.add(name);
    hasher.add(value);
  }
  hasher.add(request.source);
  for (const auto& [path, file] : sources.files()) {
    if (!file) continue;
    hasher.add(path);
    hasher.add(file->text);
  }
  return hasher.digest();
}

std::vector<uint32_t> readCached(const std::string& folder, const Digest& key) {
  const std::vector<char> bytes = readCacheFile(filePath(folder, key));
  Header header;
  if (bytes.size() < sizeof(Header)) return {};
  std::memcpy(&header, bytes.data(), sizeof(Header));
  const size_t size = bytes.size() - sizeof(Header);
  const bool whole = std::memcmp(header.magic, Header().magic, sizeof header.magic) == 0 && header.key == key &&
                     size % 4 == 0 && header.words == size / 4 &&
                     header.checksum == checksumOf(bytes.data() + sizeof(Header), size);
  if (!whole) return {};
  std::vector<uint32_t> spirv(header.words);
  std::memcpy(spirv.data(), bytes.data() + sizeof(Header), size);
  return spirv;
}

void writeCached(const std::string& folder, const Digest& key, const std::vector<uint32_t>& spirv) {
  const size_t size = spirv.size() * sizeof(uint32_t);
  std::vector<char> bytes(sizeof(Header) + size);
  std::memcpy(bytes.data() + sizeof(Header), spirv.data(), size);
  Header header;
  header.key = key;
  header.words = spirv.size();
  header.checksum = checksumOf(bytes.data() + sizeof(Header), size);
  std::memcpy(bytes.data(), &header, sizeof(Header));
  writeCacheFile(filePath(folder, key), bytes);
}

}  // namespace weir::shader
