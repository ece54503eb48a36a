// Which values a channel holds, for a range that suits it: measured on the device when somebody asks, and read when the
// frame is over. No frame waits for it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "view/picture/kernels.h"

namespace weir::view {

/// Of the whole picture, before exposure. Numbers of colours count each; vectors by their length, integers as numbers.
struct Measurement {
  std::string channel;                            ///< its name
  uint64_t finite = 0, others = 0;                ///< pixels with finite values, and with NaN or infinities
  float low = 0.0f, high = 0.0f;                  ///< smallest and largest finite value, exact
  float percentile1 = 0.0f, percentile99 = 0.0f;  ///< of one value in each of at most 128 x 128 cells
  float positive1 = 0.0f;  ///< the 1st percentile of the positive ones among those; 0: there are none
};

/// The range that shows a measured channel in a mode: `robust` from the 1st to the 99th percentile, else all of it.
/// With exposure, sign and logarithm as the mode has them, and never empty. The mode's own range when nothing finite
/// was found.
struct Range {
  float low = 0.0f, high = 1.0f;
};
Range rangeFor(const Measurement& measured, const Channel& channel, const PictureMode& mode, bool robust = true);

class RangeMeter {
 public:
  RangeMeter(const gpu::Device& device, shader::Compiler& compiler, uint32_t slots = 2);

  /// Records a measurement, with barriers before and after it, into commands of a slot whose last ones are done on the
  /// device. At most one in a slot: a second one takes the first one's place. Throws as PortPicture::draw.
  void record(VkCommandBuffer commands, uint32_t slot, const Shown& shown, uint32_t element = 0);
  /// What the last measurement of a slot found, once: its commands must be done on the device.
  std::optional<Measurement> collect(uint32_t slot);

  /// One cell of the picture; of one pixel at most where the picture is no larger than kCells each way.
  struct Cell {
    float value[3];
    uint32_t word;
    float low, high;
    uint32_t finite, others;
  };
  static constexpr uint32_t kCells = 128;
  /// The cells that collect() would sum up, rows of `columns`: for tests.
  std::vector<Cell> cells(uint32_t slot) const;
  uint32_t columns(uint32_t slot) const { return slots_[slot].columns; }

 private:
  struct Slot {
    gpu::Buffer settings, cells;
    uint32_t columns = 0, rows = 0;
    uint32_t components = 1;
    bool pending = false;
    std::string channel;
  };
  const Slot& at(uint32_t slot) const;
  Kernels kernels_;
  std::vector<Slot> slots_;
};

}  // namespace weir::view
