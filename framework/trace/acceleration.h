// Acceleration structures of a prepared scene: one bottom-level structure a triangle range, one top-level structure.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/prepared.h>

#include <string>
#include <vector>

namespace weir::trace {

/// How rays are traced: in ray-tracing pipelines or by queries in compute shaders.
enum class Backend : uint8_t { None, Pipeline, Query };

/// From `--trace auto|pipeline|query` and what the device has; auto prefers the pipeline. Throws InputError naming what
/// is missing. Returns None for "auto" on a device without ray tracing: graphs whose passes need none still run.
Backend chooseBackend(const std::string& text, const gpu::Device& device);
const char* backendName(Backend backend);

class Acceleration {
 public:
  Acceleration() = default;
  /// Builds everything and waits. `positions` holds the scene's vertices (vec3, tightly packed) with a device address.
  Acceleration(const gpu::Device& device, const scene::PreparedScene& scene, const gpu::Buffer& positions);
  ~Acceleration();
  Acceleration(Acceleration&& other) noexcept;
  Acceleration& operator=(Acceleration&& other) noexcept;

  VkAccelerationStructureKHR top() const { return top_.handle; }
  uint64_t bytes() const;

 private:
  struct Structure {
    gpu::Buffer buffer;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
    VkDeviceAddress address = 0;
  };
  Structure build(const VkAccelerationStructureGeometryKHR* geometries, const std::vector<uint32_t>& counts, bool top,
                  const std::string& name);
  void buildBottom(const scene::PreparedScene& scene, const gpu::Buffer& positions);
  void buildTop(const scene::PreparedScene& scene);
  void destroy();

  const gpu::Device* device_ = nullptr;
  std::vector<Structure> bottom_;
  Structure top_;
};

}  // namespace weir::trace
