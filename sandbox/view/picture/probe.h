// What a port holds at one pixel: a small copy in the frame's own commands, read when the frame is over.
#pragma once

#include <weir/gpu/memory.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "view/picture/channels.h"
#include "view/picture/placement.h"
#include "view/picture/port.h"

namespace weir::view {

/// A pixel's bytes: the texel, or its elements one behind the other.
struct Probed {
  PixelPlace pixel;
  std::vector<std::byte> bytes;  ///< Probe::kBytes at most: of what is longer the beginning
  graph::Resource resource;      ///< what they are of, as it was then
  execute::GpuCamera camera;
  bool f90 = false;
};

class Probe {
 public:
  static constexpr uint32_t kBytes = 4096;
  explicit Probe(const gpu::Device& device, uint32_t slots = 2);

  /// Records the copy, with barriers before and after it, into commands of a slot whose last ones are done on the
  /// device. False, and nothing recorded, where the port has no such pixel or element. InputError for ports without
  /// memory.
  bool record(VkCommandBuffer commands, uint32_t slot, const Port& port, PixelPlace pixel);
  /// What the last copy of a slot brought, once; its commands must be done on the device. Valid until the next
  /// record() with the slot.
  const Probed* collect(uint32_t slot);

 private:
  struct Slot {
    gpu::Buffer buffer;
    Probed probed;
    bool pending = false;
  };
  std::vector<Slot> slots_;
};

}  // namespace weir::view
