#include "view/picture/port_picture.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace weir::view {
namespace {

/// The part of a clip that lies on the canvas, as Settings has it. False when there is none.
bool clipTo(const Canvas& canvas, const Rect& clip, Settings& s) {
  const auto part = [](int64_t start, int64_t size, int64_t whole, int32_t& first, uint32_t& count) {
    const int64_t low = std::clamp<int64_t>(start, 0, whole), high = std::clamp<int64_t>(start + size, 0, whole);
    first = static_cast<int32_t>(low);
    count = static_cast<uint32_t>(high - low);
    return high > low;
  };
  const bool across = part(clip.x, clip.width, canvas.width, s.clip[0], s.clipSize[0]);
  return part(clip.y, clip.height, canvas.height, s.clip[1], s.clipSize[1]) && across;
}

}  // namespace

PortPicture::PortPicture(const gpu::Device& device, shader::Compiler& compiler, uint32_t slots, uint32_t draws)
    : draws_(draws), kernels_(device, compiler, "draw.glsl", true, slots * draws) {
  for (uint32_t i = 0; i < slots * draws; ++i)
    settings_.emplace_back(device, sizeof(Settings), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Upload,
                           "picture settings");
}

void PortPicture::begin(uint32_t slot) {
  if ((slot + 1) * draws_ > settings_.size())
    throw InputError(fmt::format("slot {}: there are {}", slot, settings_.size() / draws_));
  slot_ = slot;
  drawn_ = 0;
}

void PortPicture::draw(VkCommandBuffer commands, const Shown& shown, const PictureMode& mode, const Target& target) {
  Settings s = settingsOf(shown, mode);
  const Placement& p = target.placement;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.scaleX) || !std::isfinite(p.scaleY) ||
      !(p.scaleX > 0.0f) || !(p.scaleY > 0.0f))
    throw InputError(fmt::format("a picture can't lie at ({}, {}) with scale ({}, {})", p.x, p.y, p.scaleX, p.scaleY));
  if (drawn_ >= draws_) throw InputError(fmt::format("a frame draws at most {} pictures", draws_));
  if (!clipTo(target.canvas, target.clip, s)) return;
  s.place[0] = p.x;
  s.place[1] = p.y;
  s.scale[0] = p.scaleX;
  s.scale[1] = p.scaleY;
  s.background = target.background;
  const execute::ToolKernel& kernel = kernels_.of(shown.channel, shown.f90);
  const uint32_t set = slot_ * draws_ + drawn_++;
  const gpu::Buffer& settings = settings_[set];
  std::memcpy(settings.mapped(), &s, sizeof s);
  settings.flush();

  constexpr VkPipelineStageFlags2 kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  gpu::memoryBarrier(commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCompute,
                     VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  const std::array<execute::ToolBinding, 3> bindings{sourceOf(shown), execute::ToolBinding{.buffer = settings.handle()},
                                                     execute::ToolBinding{.image = target.canvas.view}};
  kernel.record(commands, set, bindings, {}, s.clipSize[0], s.clipSize[1]);
  gpu::memoryBarrier(commands, kCompute, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, kAll,
                     VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

}  // namespace weir::view
