// A pass: what it does with its ports once the graph is compiled. It asks for kernels by shader file and launches them;
// ports, parameters, scene and frame data are bound by name (shaders see in_<port>, out_<port>, scratch_<name>,
// param_<name>).
#pragma once

#include <weir/pass/description.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace weir {

/// A prepared kernel; belongs to the pass that prepared it.
struct Kernel {
  uint32_t index = 0xffffffffu;
};

/// The workgroups of a compute kernel, `side` × `side` invocations.
struct Group {
  uint32_t side = 8;
  /// run() is called by every invocation of a group, those beyond the launch's size too: the shader may share memory
  /// and wait with barrier(), and must itself look at launchSize before it touches a pixel's data.
  bool whole = false;
};

struct KernelOptions {
  /// What this kernel sees in place of a port: {"in_reservoirs", "scratch_ping"}; both sides name the pass's own ports
  /// or scratch.
  std::vector<std::pair<std::string, std::string>> bind;
  std::vector<std::pair<std::string, std::string>> defines;
  /// Shader files that exist only in memory, found by #include "name".
  std::vector<std::pair<std::string, std::string>> sources;
  Group group;  ///< compute kernels only
  /// The launch is a row of `width` ids (x, 0), `height` 1, and ids next to each other run together, whatever the
  /// device; rays too.
  bool linear = false;
};

/// A constant texture of the pass's own, sampled by the shader as `texture_<name>`. RGBA float, clamped.
struct TextureData {
  uint32_t width = 1, height = 1, depth = 0;  ///< depth 0: a 2D texture, else 3D
  bool linear = true;
  std::vector<float> rgba;
};

/// What there is of light in the scene. How it shines may change from frame to frame, this doesn't.
struct LightSummary {
  uint32_t count = 0;       ///< entries of the shader's sceneLights
  bool pointsOnly = false;  ///< all of them are point lights without a range
  uint32_t placed = 0;      ///< how many have a place: all but directional ones and the environment
  bool moves = false;       ///< a clip moves some of them
};

/// Answers about the compiled pass. Asking for what the description doesn't declare throws InputError naming pass and
/// name.
class PassContext {
 public:
  virtual ~PassContext() = default;
  virtual bool boolean(std::string_view param) const = 0;
  virtual int integer(std::string_view param) const = 0;
  virtual float number(std::string_view param) const = 0;
  virtual std::string text(std::string_view param) const = 0;  ///< String, or an Enum's choice
  virtual bool connected(std::string_view input) const = 0;
  virtual uint32_t width() const = 0;  ///< of the frame
  virtual uint32_t height() const = 0;
  virtual std::string sceneFolder() const = 0;
  virtual LightSummary lights() const = 0;  ///< of passes that need scene.lights
};

/// Called when the graph is compiled, and again when a parameter changes that specialises.
class PrepareContext : public PassContext {
 public:
  /// A buffer or image of the pass's own, alive within a frame.
  virtual void scratch(const std::string& name, const PortType& type) = 0;
  virtual void texture(const std::string& name, TextureData data) = 0;
  /// Lets the pass's kernels pick lights by where surfaces are (shaders/common/light_tree.glsl), of passes that need
  /// scene.lights. The tree is built when the first pass of all asks for it. InputError where lights move.
  virtual void lightTree() = 0;
  /// A compute kernel: the file defines `void run(uvec2 id)`, called once for each id below the launch's size. The
  /// device's limits hold for larger groups than 8 × 8 (InputError).
  virtual Kernel kernel(const std::string& file, const KernelOptions& options = {}) = 0;
  /// The same, and it may trace rays (needs scene.acceleration): a ray generation shader or compute with ray queries.
  virtual Kernel rayKernel(const std::string& file, const KernelOptions& options = {}) = 0;
  /// Draws every triangle of the scene that faces the camera or is double-sided, depth-tested, into an R32U scratch
  /// image cleared to ~0. The file defines `vec4 vertex(uint instance, uint triangle, uint corner)` (clip position) and
  /// `uint fragment(...)`: see shaders/gbuffer/raster.glsl.
  virtual Kernel rasterKernel(const std::string& file, const std::string& target,
                              const KernelOptions& options = {}) = 0;
};

/// Called every frame. Launches run in order; each sees what the ones before it wrote.
class RecordContext : public PassContext {
 public:
  /// Over the frame's size. `index` is the shader's launchIndex.
  virtual void launch(Kernel kernel, uint32_t index = 0) = 0;
  virtual void launch(Kernel kernel, uint32_t width, uint32_t height, uint32_t index) = 0;
  virtual void draw(Kernel kernel) = 0;
};

class Pass {
 public:
  virtual ~Pass() = default;
  virtual void prepare(PrepareContext& context) = 0;
  virtual void record(RecordContext& context) = 0;
};

}  // namespace weir
