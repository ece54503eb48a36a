// KHR_draco_mesh_compression: primitives that libdraco decodes.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop

#include <weir/scene/gltf_compression.h>

#include <algorithm>

namespace weir::scene {
namespace {

/// glTF's component type, 0 where it has none.
int componentType(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 5120;
    case draco::DT_UINT8:
      return 5121;
    case draco::DT_INT16:
      return 5122;
    case draco::DT_UINT16:
      return 5123;
    case draco::DT_UINT32:
      return 5125;
    case draco::DT_FLOAT32:
      return 5126;
    default:
      return 0;
  }
}

/// The larger of the numbers of triangles and of vertices that the data announces, before anything is allocated for
/// them. Draco bitstream specification, sections 3 (header), 4 (metadata), 5 (connectivity). False when it is no mesh
/// of a version with this layout.
bool announcedSize(std::span<const uint8_t> data, uint64_t& size) {
  constexpr size_t kHeader = 11;
  constexpr uint16_t kMetadata = 0x8000;
  if (data.size() < kHeader || data[7] != draco::TRIANGULAR_MESH) return false;
  const uint32_t version = data[5] * 256u + data[6], method = data[8];
  if (version < 0x202 || version > 0x2ff) return false;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(data.data()), data.size(), static_cast<uint16_t>(version));
  buffer.Advance(kHeader);
  if ((data[9] | data[10] << 8) & kMetadata) {
    draco::GeometryMetadata ignored;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &ignored)) return false;
  }
  uint8_t traversal = 0;
  if (method == draco::MESH_EDGEBREAKER_ENCODING && !buffer.Decode(&traversal)) return false;
  uint32_t first = 0, second = 0;  // vertices and faces, or faces and points
  if (!draco::DecodeVarint(&first, &buffer) || !draco::DecodeVarint(&second, &buffer)) return false;
  size = std::max(first, second);
  return true;
}

std::string copyAttribute(const draco::Mesh& mesh, uint32_t id, DracoGeometry::Attribute& to) {
  const draco::PointAttribute* from = mesh.GetAttributeByUniqueId(id);
  if (from == nullptr) return "the data has no attribute " + std::to_string(id);
  to.componentType = componentType(from->data_type());
  if (to.componentType == 0) return "attribute " + std::to_string(id) + " has a type that glTF doesn't know";
  to.components = from->num_components();
  const auto size = static_cast<size_t>(to.components) * draco::DataTypeLength(from->data_type());
  to.bytes.resize(mesh.num_points() * size);
  for (uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = from->mapped_index(draco::PointIndex(i));
    if (value.value() >= from->size()) return "attribute " + std::to_string(id) + " lacks values";
    from->GetValue(value, to.bytes.data() + i * size);
  }
  return {};
}

}  // namespace

DracoGeometry decodeDraco(std::span<const uint8_t> compressed, const std::map<std::string, uint32_t>& attributes,
                          uint64_t maxTriangles, std::string& reason) {
  DracoGeometry geometry;
  uint64_t announced = 0;
  if (!announcedSize(compressed, announced)) {
    reason = "no Draco mesh of version 2.2 or later";
    return geometry;
  }
  if (announced > maxTriangles) {
    reason = "announces " + std::to_string(announced) + " triangles or vertices; " + std::to_string(maxTriangles) +
             " are as many as its size allows";
    return geometry;
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    reason = "Draco: " + decoded.status().error_msg_string();
    return geometry;
  }
  const draco::Mesh& mesh = *decoded.value();
  geometry.vertices = mesh.num_points();
  geometry.indices.reserve(3 * size_t{mesh.num_faces()});
  for (uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) {
      if (point.value() >= mesh.num_points()) {
        reason = "Draco: a triangle refers to a vertex that isn't there";
        return geometry;
      }
      geometry.indices.push_back(point.value());
    }
  for (const auto& [name, id] : attributes)
    if (reason = copyAttribute(mesh, id, geometry.attributes[name]); !reason.empty()) return geometry;
  return geometry;
}

}  // namespace weir::scene
