#include "view/picture/kernels.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>

#include <algorithm>
#include <cmath>

#include "../../../passes/common/layouts.h"

namespace weir::view {
namespace {

std::string oneLine(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

uint32_t flagsOf(const Channel& channel, const PictureMode& mode) {
  uint32_t flags = 0;
  if (mode.falseColor) flags |= kFalseColor;
  if (mode.logarithmic) flags |= kLogarithmic;
  if (channel.encoded) flags |= kEncoded;
  if (mode.markRange) flags |= kMarkRange;
  if (mode.box) flags |= kBox;
  if (mode.sign == Sign::Absolute) flags |= kAbsolute;
  if (mode.sign == Sign::Split) flags |= kSigned;
  return flags;
}

void checkMode(const Shown& shown, const PictureMode& mode) {
  if (!std::isfinite(mode.low) || !std::isfinite(mode.high))
    throw InputError(
        fmt::format("the range of '{}' is {} to {}: both must be finite", shown.channel.name, mode.low, mode.high));
  if (!(std::abs(mode.exposure) <= kMostExposure))
    throw InputError(fmt::format("exposure {} EV: from {} to {}", mode.exposure, -kMostExposure, kMostExposure));
  const uint32_t count = std::max(shown.resource.perPixel, 1u);
  if (!shown.resource.isImage() && shown.resource.type.fixedCount == 0 && mode.element >= count)
    throw InputError(
        fmt::format("'{}' has {} elements a pixel: there is no number {}", shown.resource.name, count, mode.element));
}

}  // namespace

void checkShown(const Shown& shown) {
  if (!belongs(shown.channel, shown.resource))
    throw InputError(fmt::format("'{}' is no channel of '{}', which is {}", shown.channel.name, shown.resource.name,
                                 describe(shown.resource.type)));
  const bool there =
      shown.resource.isImage() ? static_cast<bool>(shown.storage.image) : static_cast<bool>(shown.storage.buffer);
  if (!there || shown.resource.depth)
    throw InputError(fmt::format("'{}' can't be shown: it has no memory that shaders read", shown.resource.name));
}

Settings settingsOf(const Shown& shown, const PictureMode& mode) {
  checkShown(shown);
  checkMode(shown, mode);
  const graph::Resource& r = shown.resource;
  const Extent extent = extentOf(r);
  const bool perPixel = !r.isImage() && r.type.fixedCount == 0;
  Settings s{};
  s.camera = shown.camera;
  s.scale[0] = s.scale[1] = 1.0f;
  s.extent[0] = extent.width;
  s.extent[1] = extent.height;
  // Elements that the buffer doesn't have are never read, whatever the plan said.
  if (!r.isImage() && r.type.layout.stride > 0)
    s.elements = static_cast<uint32_t>(
        std::min({r.elements, shown.storage.buffer.size() / r.type.layout.stride, uint64_t{0xffffffffu}}));
  s.perPixel = perPixel ? std::max(r.perPixel, 1u) : 1;
  s.element = perPixel ? mode.element : 0;
  s.stride = r.type.layout.stride / 4;
  s.code = shown.channel.code;
  s.word = shown.channel.word;
  s.shows = static_cast<uint32_t>(shown.channel.shows);
  s.flags = flagsOf(shown.channel, mode);
  s.low = mode.low;
  s.high = mode.high;
  s.gain = shown.channel.exposed ? std::exp2(mode.exposure) : 1.0f;
  return s;
}

Kernels::Kernels(const gpu::Device& device, shader::Compiler& compiler, std::string shader, bool targetIsImage,
                 uint32_t sets)
    : device_(device), compiler_(compiler), shader_(std::move(shader)), targetIsImage_(targetIsImage), sets_(sets) {}

const execute::ToolKernel& Kernels::of(const Channel& channel, bool f90) {
  const auto reading = static_cast<size_t>(channel.reading);
  const bool wide = f90 && channel.reading == Reading::Surface;
  std::unique_ptr<execute::ToolKernel>& kernel = kernels_[wide ? kReadings : reading];
  if (kernel) return *kernel;
  execute::ToolKernelOptions options;
  options.name = fmt::format("view {} {}", shader_, reading);
  options.file = viewShader(shader_);
  options.defines = {{"READING", std::to_string(reading)}};
  if (channel.reading == Reading::Surface)
    options.defines.emplace_back("LAYOUT_STRUCT", oneLine(layoutOf<passes::PackedSurface>().glsl()));
  if (channel.reading == Reading::Reservoir)
    options.defines.emplace_back("LAYOUT_STRUCT", oneLine(layoutOf<passes::Reservoir>().glsl()));
  if (wide) options.defines.emplace_back("SCENE_F90", "1");
  options.images = {channel.reading == Reading::Image || channel.reading == Reading::Integers, false, targetIsImage_};
  options.sets = sets_;
  kernel = std::make_unique<execute::ToolKernel>(device_, compiler_, options);
  return *kernel;
}

std::set<std::string> Kernels::files() const {
  std::set<std::string> all;
  for (const auto& kernel : kernels_)
    if (kernel) all.insert(kernel->files().begin(), kernel->files().end());
  return all;
}

execute::ToolBinding sourceOf(const Shown& shown) {
  if (shown.resource.isImage()) return {.image = shown.storage.image.view()};
  return {.buffer = shown.storage.buffer.handle()};
}

std::string viewShader(const std::string& name) {
  return (commonShaderFolder().parent_path() / "view" / name).string();
}

}  // namespace weir::view
