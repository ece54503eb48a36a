#include "view/picture/range_meter.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace weir::view {
namespace {

static_assert(sizeof(RangeMeter::Cell) == 32);

float nthOf(std::vector<float>& values, double share) {
  const auto n = static_cast<size_t>(std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(n), values.end());
  return values[n];
}

}  // namespace

RangeMeter::RangeMeter(const gpu::Device& device, shader::Compiler& compiler, uint32_t slots)
    : kernels_(device, compiler, "measure.glsl", false, slots) {
  for (uint32_t i = 0; i < slots; ++i) {
    Slot& slot = slots_.emplace_back();
    slot.settings = gpu::Buffer(device, sizeof(Settings), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Upload,
                                "range settings");
    slot.cells = gpu::Buffer(device, sizeof(Cell) * kCells * kCells, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             gpu::Residency::Readback, "range cells");
  }
}

const RangeMeter::Slot& RangeMeter::at(uint32_t slot) const {
  if (slot >= slots_.size()) throw InputError(fmt::format("slot {}: there are {}", slot, slots_.size()));
  return slots_[slot];
}

void RangeMeter::record(VkCommandBuffer commands, uint32_t slotIndex, const Shown& shown, uint32_t element) {
  at(slotIndex);
  Slot& slot = slots_[slotIndex];
  PictureMode mode;
  mode.element = element;
  Settings s = settingsOf(shown, mode);
  const execute::ToolKernel& kernel = kernels_.of(shown.channel, shown.f90);
  slot.columns = s.clipSize[0] = std::min(s.extent[0], kCells);
  slot.rows = s.clipSize[1] = std::min(s.extent[1], kCells);
  slot.components = shown.channel.shows == Shows::Color ? 3 : 1;
  slot.channel = shown.channel.name;
  slot.pending = true;
  if (slot.columns == 0 || slot.rows == 0) return;
  std::memcpy(slot.settings.mapped(), &s, sizeof s);
  slot.settings.flush();
  constexpr VkPipelineStageFlags2 kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                  kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  gpu::memoryBarrier(commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCompute,
                     VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  const std::array<execute::ToolBinding, 3> bindings{sourceOf(shown),
                                                     execute::ToolBinding{.buffer = slot.settings.handle()},
                                                     execute::ToolBinding{.buffer = slot.cells.handle()}};
  kernel.record(commands, slotIndex, bindings, {}, slot.columns, slot.rows);
  // The host reads what was found; the next frame overwrites the port.
  gpu::memoryBarrier(commands, kCompute, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, kAll | VK_PIPELINE_STAGE_2_HOST_BIT,
                     VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

std::vector<RangeMeter::Cell> RangeMeter::cells(uint32_t slotIndex) const {
  const Slot& slot = at(slotIndex);
  std::vector<Cell> all(size_t{slot.columns} * slot.rows);
  slot.cells.invalidate();
  if (!all.empty()) std::memcpy(all.data(), slot.cells.mapped(), all.size() * sizeof(Cell));
  return all;
}

std::optional<Measurement> RangeMeter::collect(uint32_t slotIndex) {
  at(slotIndex);
  Slot& slot = slots_[slotIndex];
  if (!slot.pending) return std::nullopt;
  slot.pending = false;
  Measurement m;
  m.channel = slot.channel;
  std::vector<float> values;
  for (const Cell& cell : cells(slotIndex)) {
    m.others += cell.others;
    if (cell.finite == 0) continue;
    m.low = m.finite == 0 ? cell.low : std::min(m.low, cell.low);
    m.high = m.finite == 0 ? cell.high : std::max(m.high, cell.high);
    m.finite += cell.finite;
    values.insert(values.end(), cell.value, cell.value + slot.components);
  }
  if (values.empty()) return m;
  m.percentile1 = nthOf(values, 0.01);
  m.percentile99 = nthOf(values, 0.99);
  std::erase_if(values, [](float v) { return !(v > 0.0f); });
  if (!values.empty()) m.positive1 = nthOf(values, 0.01);
  return m;
}

Range rangeFor(const Measurement& measured, const Channel& channel, const PictureMode& mode, bool robust) {
  if (measured.finite == 0) return {mode.low, mode.high};
  constexpr float kLargest = std::numeric_limits<float>::max();
  const float gain = channel.exposed ? std::exp2(mode.exposure) : 1.0f;
  const auto scaled = [&](float v) { return std::clamp(v * gain, -kLargest, kLargest); };
  Range r{scaled(robust ? measured.percentile1 : measured.low), scaled(robust ? measured.percentile99 : measured.high)};
  if (mode.sign != Sign::Plain) {
    const float far = std::max(std::abs(r.low), std::abs(r.high));
    const float near = r.low > 0.0f ? r.low : r.high < 0.0f ? -r.high : 0.0f;
    r = {mode.sign == Sign::Split ? 0.0f : near, far};
  }
  // Logarithms begin at what is positive: zeros say nothing of how small the others get.
  if (mode.logarithmic && r.low <= 0.0f) r.low = scaled(measured.positive1);
  if (!(r.high > r.low)) {  // one value everywhere: in the middle of twice its size
    const float around = r.low != 0.0f ? 0.5f * std::abs(r.low) : 1.0f;
    r = {r.low - around, std::min(r.high + around, kLargest)};
    if (!(r.high > r.low)) r.low = 0.0f;
  }
  return r;
}

}  // namespace weir::view
