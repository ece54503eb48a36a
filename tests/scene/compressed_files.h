// Small compressed glTF files, written with the codecs' own encoders.
#pragma once

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#pragma GCC diagnostic pop
#include <meshoptimizer.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "scene_support.h"

namespace weir::scene::test {

/// A bumpy grid over [0,n]² with normals and texture coordinates.
struct Grid {
  explicit Grid(int n) {
    for (int y = 0; y <= n; ++y)
      for (int x = 0; x <= n; ++x) {
        const float h = std::sin(static_cast<float>(x)) * std::cos(static_cast<float>(y));
        positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), h});
        const glm::vec3 normal = glm::normalize(glm::vec3(h, 0.5f * h, 1.0f));
        normals.insert(normals.end(), {normal.x, normal.y, normal.z});
        uvs.insert(uvs.end(),
                   {static_cast<float>(x) / static_cast<float>(n), static_cast<float>(y) / static_cast<float>(n)});
      }
    const auto row = static_cast<uint32_t>(n + 1);
    for (uint32_t y = 0; y + 1 < row; ++y)
      for (uint32_t x = 0; x + 1 < row; ++x) {
        const uint32_t a = y * row + x, b = a + row;
        indices.insert(indices.end(), {a, a + 1, b, b, a + 1, b + 1});
      }
  }
  size_t vertices() const { return positions.size() / 3; }

  std::vector<float> positions, normals, uvs;
  std::vector<uint32_t> indices;
};

/// Appends bytes to the file's buffer as a view.
inline int rawView(GltfText& g, const void* data, size_t size) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  return g.view(std::vector<uint8_t>(bytes, bytes + size));
}

/// An accessor without data of its own.
inline int emptyAccessor(GltfText& g, int componentType, const char* type, size_t count) {
  g.j["accessors"].push_back({{"componentType", componentType}, {"count", count}, {"type", type}});
  return static_cast<int>(g.j["accessors"].size()) - 1;
}

/// The grid under KHR_draco_mesh_compression. `sequential`: the other of Draco's two ways to store connectivity.
inline GltfText dracoFile(const Grid& grid, bool sequential = false) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<uint32_t>(grid.vertices()));
  const auto attribute = [&](draco::GeometryAttribute::Type type, int components, const std::vector<float>& values) {
    draco::GeometryAttribute a;
    a.Init(type, nullptr, static_cast<uint8_t>(components), draco::DT_FLOAT32, false, sizeof(float) * components, 0);
    const int id = mesh.AddAttribute(a, true, static_cast<uint32_t>(grid.vertices()));
    for (uint32_t i = 0; i < grid.vertices(); ++i)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i * components]);
    return mesh.attribute(id)->unique_id();
  };
  const json ids = {{"POSITION", attribute(draco::GeometryAttribute::POSITION, 3, grid.positions)},
                    {"NORMAL", attribute(draco::GeometryAttribute::NORMAL, 3, grid.normals)},
                    {"TEXCOORD_0", attribute(draco::GeometryAttribute::TEX_COORD, 2, grid.uvs)}};
  for (size_t t = 0; t < grid.indices.size(); t += 3)
    mesh.AddFace({draco::PointIndex(grid.indices[t]), draco::PointIndex(grid.indices[t + 1]),
                  draco::PointIndex(grid.indices[t + 2])});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 12);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());

  GltfText g;
  const int view = rawView(g, buffer.data(), buffer.size());
  const int p = emptyAccessor(g, 5126, "VEC3", grid.vertices()), n = emptyAccessor(g, 5126, "VEC3", grid.vertices()),
            uv = emptyAccessor(g, 5126, "VEC2", grid.vertices()),
            indices = emptyAccessor(g, 5125, "SCALAR", grid.indices.size());
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const json primitive = {
      {"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", uv}}},
      {"indices", indices},
      {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}}}};
  g.j["meshes"] = {{{"primitives", {primitive}}}};
  return g;
}

/// A view under EXT_meshopt_compression; its uncompressed form lies in a buffer that has no bytes.
inline int meshoptView(GltfText& g, const std::vector<uint8_t>& bytes, size_t count, size_t stride, const char* mode,
                       const char* filter = "NONE") {
  const int view = rawView(g, bytes.data(), bytes.size());
  json& entry = g.j["bufferViews"][view];
  json extension = entry;
  extension.update({{"byteStride", stride}, {"count", count}, {"mode", mode}, {"filter", filter}});
  entry = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string(mode) == "ATTRIBUTES") entry["byteStride"] = stride;
  return view;
}

inline std::vector<uint8_t> meshoptVertices(const void* data, size_t count, size_t stride) {
  std::vector<uint8_t> bytes(meshopt_encodeVertexBufferBound(count, stride));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), data, count, stride));
  return bytes;
}

inline std::vector<uint8_t> meshoptIndices(const std::vector<uint32_t>& indices, size_t vertices, bool triangles) {
  std::vector<uint8_t> bytes(triangles ? meshopt_encodeIndexBufferBound(indices.size(), vertices)
                                       : meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  bytes.resize(triangles ? meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size())
                         : meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

/// The grid under EXT_meshopt_compression: positions and texture coordinates with the exponential filter, normals with
/// the octahedral one, indices as triangles (or as a sequence).
inline GltfText meshoptFile(const Grid& grid, bool triangles = true) {
  GltfText g;
  const size_t n = grid.vertices();
  std::vector<uint8_t> positions(12 * n), normals(8 * n), uvs(8 * n);
  meshopt_encodeFilterExp(positions.data(), n, 12, 20, grid.positions.data());
  std::vector<float> four;  // the filter reads four components
  for (size_t i = 0; i < n; ++i) {
    four.insert(four.end(), &grid.normals[3 * i], &grid.normals[3 * i] + 3);
    four.push_back(0.0f);
  }
  meshopt_encodeFilterOct(normals.data(), n, 8, 14, four.data());
  meshopt_encodeFilterExp(uvs.data(), n, 8, 20, grid.uvs.data());
  const auto accessor = [&](int view, int componentType, const char* type, size_t count) {
    const int index = emptyAccessor(g, componentType, type, count);
    g.j["accessors"][index]["bufferView"] = view;
    return index;
  };
  const auto attributes = [&](const std::vector<uint8_t>& data, size_t stride, const char* filter) {
    return meshoptView(g, meshoptVertices(data.data(), n, stride), n, stride, "ATTRIBUTES", filter);
  };
  const int p = accessor(attributes(positions, 12, "EXPONENTIAL"), 5126, "VEC3", n);
  const int normal = accessor(attributes(normals, 8, "OCTAHEDRAL"), 5122, "VEC3", n);
  g.j["accessors"][normal]["normalized"] = true;
  const int uv = accessor(attributes(uvs, 8, "EXPONENTIAL"), 5126, "VEC2", n);
  const int indices = accessor(meshoptView(g, meshoptIndices(grid.indices, n, triangles), grid.indices.size(), 4,
                                           triangles ? "TRIANGLES" : "INDICES"),
                               5125, "SCALAR", grid.indices.size());
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
  g.j["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", p}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}}, {"indices", indices}}}}}};
  g.j["buffers"] = {
      {{"byteLength", g.binary.size()}, {"uri", "data:application/octet-stream;base64," + GltfText::base64(g.binary)}},
      {{"byteLength", 1 << 20}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  return g;
}

}  // namespace weir::scene::test
