// The bytes of a glTF asset: container, buffers and images, each read once, on demand, from inside the asset's folder
// only. Internal to scene/import.
#pragma once

#include <weir/scene/import.h>

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace weir::scene {

using Bytes = std::vector<uint8_t>;

/// A file's JSON part, parsed, and what its buffers and images hold. All functions throw InputError.
class GltfFile {
 public:
  GltfFile(const std::string& path, const ImportLimits& limits);

  const std::string& path() const { return path_; }
  const nlohmann::json& json() const { return json_; }
  nlohmann::json& json() { return json_; }

  /// `byteLength` bytes of buffer `index`.
  std::span<const uint8_t> buffer(size_t index);
  /// A buffer view's bytes, checked against its buffer; decoded where EXT_meshopt_compression says so.
  std::span<const uint8_t> bufferView(size_t index);
  /// An image's encoded bytes, from wherever the file keeps them.
  std::span<const uint8_t> image(size_t index);
  /// Bytes of the file itself, of all that was loaded beside it and decompressed: what a decoded size can be compared
  /// with.
  uint64_t loadedBytes() const { return loadedBytes_ + expandedBytes_; }

  /// Throws InputError: "<file>: <place>: <reason>".
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const;

 private:
  void splitContainer();
  void parseJson(std::span<const uint8_t> text);
  std::span<const uint8_t> resolve(const std::string& uri, const std::string& place);
  /// Bytes that an object with buffer, byteOffset and byteLength points at.
  std::span<const uint8_t> slice(const nlohmann::json& entry, const std::string& place);

  std::string path_;
  ImportLimits limits_;
  std::shared_ptr<const Bytes> file_;
  std::span<const uint8_t> binary_;  // the GLB's BIN chunk
  nlohmann::json json_;
  // By canonical path, or by place of a data URI or of a compressed view.
  std::map<std::string, std::shared_ptr<const Bytes>> loaded_;
  uint64_t loadedBytes_ = 0, expandedBytes_ = 0;
};

/// Whole regular file, at most `limit` bytes. Throws InputError.
Bytes readWholeFile(const std::string& path, uint64_t limit);

/// Throws InputError unless every property that the importer (or tinygltf) reads has the type, length and range that
/// glTF 2.0 gives it, and every index points at something. After this the structure can be trusted.
void checkGltfSchema(const GltfFile& file);

}  // namespace weir::scene
