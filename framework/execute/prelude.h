// The GLSL that stands before a pass's shader: ports, parameters, and just those parts of scene and frame that the pass
// declared. Plain text from plain data, so that it can be read and tested without a GPU.
#pragma once

#include <weir/graph/compile.h>
#include <weir/pass/pass.h>
#include <weir/scene/traits.h>
#include <weir/trace/acceleration.h>

#include <string>
#include <vector>

namespace weir::execute {

/// A buffer or image of the pass's own.
struct Scratch {
  std::string name;
  PortType type;
  uint32_t perPixel = 1;
};

/// Everything that a kernel of a pass can see; binding numbers in set 1 count through inputs, outputs, scratch,
/// textures, and the light tree's buffers.
struct KernelInterface {
  const graph::CompiledGraph* graph = nullptr;
  const graph::CompiledPass* pass = nullptr;
  std::vector<Scratch> scratch;
  std::vector<std::pair<std::string, bool>> textures;  ///< name, 3D
  bool countRays = false;
  uint32_t sceneTextures = 1;
  scene::SceneTraits traits;
  bool lightTree = false;
};

enum class KernelKind : uint8_t { Compute, RayPipeline, RayQuery, Vertex, Fragment };

/// Full source of a kernel: prelude, #include of `file`, main(). Of the options, how it is launched counts.
std::string kernelSource(const KernelInterface& interface, KernelKind kind, const std::string& file,
                         const KernelOptions& options = {});

/// Full source of one of the tracing interface's own hit and miss shaders: the scene, no ports.
std::string hitShaderSource(const std::string& file, uint32_t sceneTextures, const scene::SceneTraits& traits);

/// Parameters in push-constant order after the launch's four words; bools and enums take 4 bytes like numbers, texts
/// none.
struct PushParam {
  const ParamDescription* description;
  uint32_t offset;
};
std::vector<PushParam> pushParams(const PassDescription& description);
uint32_t pushBytes(const PassDescription& description);
/// Parameters that specialise, in the order of their constant ids.
std::vector<const ParamDescription*> specialParams(const PassDescription& description);
/// A parameter's 32 bits as the shader reads them (an Enum's index, a bool's 0 or 1).
uint32_t paramBits(const ParamDescription& description, const ParamValue& value);

inline constexpr uint32_t kRowGroup = 256;    ///< invocations of a workgroup in linear launches
inline constexpr uint32_t kLaunchBytes = 16;  ///< size, index, stream
inline constexpr uint32_t kPushLimit = 128;   ///< what every Vulkan device has

}  // namespace weir::execute
