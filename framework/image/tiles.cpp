#include <weir/core/parallel.h>
#include <weir/image/tiles.h>

#include <algorithm>

namespace weir::image {

void forBands(const TileGrid& grid, size_t pictures, const std::function<void(uint32_t, uint32_t)>& work) {
  // Ten times as long to work on, about, as it takes to start a thread.
  constexpr uint64_t kPixelsEach = uint64_t{1} << 14;
  const uint64_t rows = grid.rows(), pixels = uint64_t{grid.width} * grid.height * pictures;
  const uint64_t bands = std::min(rows, std::max<uint64_t>(1, pixels / kPixelsEach));
  const auto edge = [&](uint64_t band) {
    return static_cast<uint32_t>(std::min<uint64_t>(grid.height, band * rows / bands * grid.side));
  };
  parallelFor(bands, [&](size_t band) { work(edge(band), edge(band + 1)); });
}

}  // namespace weir::image
