// What the importer's parts share. Internal to scene/import.
#pragma once

#include <weir/scene/gltf_compression.h>
#include <weir/scene/gltf_file.h>
#include <weir/scene/scene.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace weir::scene {

/// Extensions that give a texture another kind of image; the plain source, if there is one, is used instead.
inline constexpr std::array<const char*, 4> kOtherImageFormats = {"KHR_texture_basisu", "EXT_texture_webp",
                                                                  "MSFT_texture_dds", "EXT_texture_avif"};

/// State of one import. The parts below fill `scene` in the order: materials, meshes, animation, nodes, images.
struct GltfImport {
  GltfFile& file;
  const tinygltf::Model& model;
  const ImportLimits& limits;
  Scene& scene;
  /// Per material: the file's UV sets that become uv0 and uv1, -1: none.
  std::vector<std::array<int, 2>> materialUvSets;
  uint64_t animationValues = 0;  ///< numbers read so far for morph targets and animations

  /// Counts such numbers. A file that refers to the same bytes over and over must not fill the memory.
  void countValues(uint64_t count, const std::string& place);

  /// Adds a warning unless it was given already.
  void warn(const std::string& text);
};

/// The file's structure as tinygltf reads it. It gets neither bytes nor paths nor extras: buffers and images go
/// through GltfFile's guards instead. Expects a file that passed checkGltfSchema.
tinygltf::Model parseStructure(const GltfFile& file);

/// One accessor, checked: every element can be read. Sparse substitution included. Values are copied out one
/// by one, so alignment does not matter.
class AccessorView {
 public:
  AccessorView(GltfImport& import, int accessor);
  /// What Draco holds in the accessor's place; `attribute` must outlive the view.
  AccessorView(const DracoGeometry::Attribute& attribute, uint64_t count, bool normalized);

  uint64_t count() const { return count_; }
  int components() const { return components_; }
  int componentType() const { return componentType_; }
  bool normalized() const { return normalized_; }
  /// Component c of element i; normalised integers are scaled as glTF 2.0, section 3.6.2.2 says.
  float value(uint64_t i, int c) const;
  /// An unsigned scalar.
  uint32_t index(uint64_t i) const;

 private:
  void dropNormalizedWhereMeaningless();
  const uint8_t* element(uint64_t i) const;

  std::span<const uint8_t> bytes_;  // empty: all zeros
  uint64_t stride_ = 0, count_ = 0;
  int components_ = 0, componentType_ = 0;
  bool normalized_ = false;
  std::vector<uint32_t> sparseIndices_;  // strictly increasing
  std::span<const uint8_t> sparseValues_;
  uint64_t elementSize_ = 0;
};

/// A primitive's attribute of that name, four components; none where it has no such attribute.
using AttributeReader = std::function<std::optional<AccessorView>(const std::string&)>;

/// Influences (JOINTS_n, WEIGHTS_n) and morph targets of a primitive's vertices; `used` says which of the file's
/// `vertices` those are, `place` where in the JSON the primitive is.
void importInfluences(GltfImport& import, const AttributeReader& attribute, const std::vector<uint32_t>& used,
                      uint64_t vertices, const std::string& place, Primitive& to);
void importTargets(GltfImport& import, const std::vector<uint32_t>& used, uint64_t vertices, const std::string& place,
                   Primitive& to);

void importMaterials(GltfImport& import);
void importMeshes(GltfImport& import);
/// Scene::nodes as the file lists them, its skins and clips; instances, lights and cameras come with importNodes.
void importAnimation(GltfImport& import);
void importNodes(GltfImport& import);
/// Decodes, on several threads, the images that some material uses; the others stay empty (width 0).
void importImages(GltfImport& import);

/// Decodes PNG or JPEG to RGBA. The size is read and checked before anything is decoded. On failure `reason` says why.
std::optional<Image> decodeImage(std::span<const uint8_t> bytes, const ImportLimits& limits, std::string& reason);
/// Width and height from the header alone, and whether the file's bytes can hold so many texels at all.
bool checkImageHeader(std::span<const uint8_t> bytes, const ImportLimits& limits, uint32_t& width, uint32_t& height,
                      std::string& reason);

}  // namespace weir::scene
