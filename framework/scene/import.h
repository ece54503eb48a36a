// glTF 2.0 files to a plain scene, behind guards: whatever the file holds, the result is a valid Scene or an
// InputError.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <string>

namespace weir::scene {

struct ImportLimits {
  uint64_t fileBytes = 2ull << 30;      ///< of any one file
  uint32_t imageSide = 16384;           ///< texels
  uint64_t imageTexels = 1ull << 29;    ///< of all images together
  uint64_t triangles = 200'000'000ull;  ///< stored and instanced alike
  uint32_t nodeDepth = 1024;
};

/// Where the time of an import went, in seconds.
struct ImportTimes {
  double read = 0.0;      ///< files, JSON and its checks, materials
  double geometry = 0.0;  ///< meshes and nodes
  double images = 0.0;    ///< decoding
};

/// Reads a .gltf or .glb. Every accessor is checked against its buffer in 64 bits, every URI stays inside the
/// scene's folder, unknown entries of `extensionsRequired` are refused by name and unknown optional ones are warned
/// about. Throws InputError with file, JSON place and reason.
/// `times`, where given, says afterwards how long it took.
Scene importGltf(const std::string& path, const ImportLimits& limits = {}, ImportTimes* times = nullptr);

}  // namespace weir::scene
