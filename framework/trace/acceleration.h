// Acceleration structures of a prepared scene: one bottom-level structure a triangle range, one top-level structure.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/prepared.h>
#include <weir/trace/structure.h>

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
  /// Builds everything that keeps its shape, and waits: where a clip moves the scene, bottom-level structures of what
  /// doesn't deform, and no top (trace/moving_acceleration.h has the rest). `positions` holds the scene's vertices
  /// (vec3, tightly packed) with a device address.
  Acceleration(const gpu::Device& device, const scene::PreparedScene& scene, const gpu::Buffer& positions);

  VkAccelerationStructureKHR top() const { return top_.handle(); }
  /// Of a range that keeps its shape.
  VkDeviceAddress bottom(uint32_t range) const { return bottom_[range].address(); }
  uint64_t bytes() const;

 private:
  std::vector<Structure> bottom_;
  Structure top_;
};

}  // namespace weir::trace
