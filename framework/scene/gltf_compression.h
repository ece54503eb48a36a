// Compressed geometry: KHR_draco_mesh_compression and EXT_meshopt_compression, behind guards on what the data may
// expand to. Internal to scene/import.
#pragma once

#include <weir/scene/gltf_file.h>

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace weir::scene {

/// The bytes of a buffer view that EXT_meshopt_compression describes: `extension` is its object, checked against the
/// schema, `compressed` the bytes that it points at. On failure the result is empty and `reason` says why.
Bytes decodeMeshopt(const nlohmann::json& extension, std::span<const uint8_t> compressed, std::string& reason);

/// No honest data expands further under the meshopt codecs: an attribute stream holds at least a byte for each 64
/// (2 bits a group of 16), indices at least a byte for each triangle.
inline constexpr uint64_t kMeshoptExpansion = 64;

/// A primitive as KHR_draco_mesh_compression holds it.
struct DracoGeometry {
  struct Attribute {
    Bytes bytes;  ///< tightly packed, one element a vertex
    int components = 0;
    int componentType = 0;  ///< glTF's number
  };
  uint64_t vertices = 0;
  std::vector<uint32_t> indices;                ///< three a triangle, each below `vertices`
  std::map<std::string, Attribute> attributes;  ///< by glTF's name
};

/// Decodes; `attributes` maps glTF's names to Draco's unique identifiers. More than `maxTriangles` are refused before
/// memory is taken for them. On failure `reason` says why and the result is not to be used.
DracoGeometry decodeDraco(std::span<const uint8_t> compressed, const std::map<std::string, uint32_t>& attributes,
                          uint64_t maxTriangles, std::string& reason);

}  // namespace weir::scene
