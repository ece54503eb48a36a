// EXT_meshopt_compression: buffer views that libmeshoptimizer decodes.
#include <meshoptimizer.h>
#include <weir/scene/gltf_compression.h>

namespace weir::scene {

Bytes decodeMeshopt(const nlohmann::json& extension, std::span<const uint8_t> compressed, std::string& reason) {
  const auto count = extension.at("count").get<uint64_t>(), stride = extension.at("byteStride").get<uint64_t>();
  const auto mode = extension.at("mode").get<std::string>(), filter = extension.value("filter", "NONE");
  const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  if (!attributes && !triangles && mode != "INDICES") {
    reason = "unknown mode \"" + mode.substr(0, 20) + "\"; there are ATTRIBUTES, TRIANGLES and INDICES";
    return {};
  }
  if (attributes ? stride % 4 != 0 || stride > 256 : stride != 2 && stride != 4) {
    reason = "byteStride " + std::to_string(stride) + " doesn't go with mode " + mode;
    return {};
  }
  if (triangles && count % 3 != 0) {
    reason = std::to_string(count) + " indices are no triangles";
    return {};
  }
  if (filter != "NONE" && (!attributes || !(filter == "OCTAHEDRAL"   ? stride == 4 || stride == 8
                                            : filter == "QUATERNION" ? stride == 8
                                                                     : filter == "EXPONENTIAL"))) {
    reason = "filter \"" + filter.substr(0, 20) + "\" doesn't go with mode " + mode + " and byteStride " +
             std::to_string(stride);
    return {};
  }
  if (count > kMeshoptExpansion * compressed.size() / stride) {
    reason = std::to_string(count) + " elements of " + std::to_string(stride) + " bytes can't come from " +
             std::to_string(compressed.size()) + " bytes";
    return {};
  }
  Bytes bytes(count * stride);
  const int failed =
      attributes  ? meshopt_decodeVertexBuffer(bytes.data(), count, stride, compressed.data(), compressed.size())
      : triangles ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, compressed.data(), compressed.size())
                  : meshopt_decodeIndexSequence(bytes.data(), count, stride, compressed.data(), compressed.size());
  if (failed != 0) {
    reason = "the compressed data is broken";
    return {};
  }
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
  return bytes;
}

}  // namespace weir::scene
