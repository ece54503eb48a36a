// How a picture is cut into tiles, and what one number stands for a colour. Shared by metrics and statistics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace weir::image {

/// Relative luminance Y of linear Rec.709 (ITU-R BT.709-6, item 3.2).
template <class T>
double luminance(const T* rgb) {
  return 0.2126 * double(rgb[0]) + 0.7152 * double(rgb[1]) + 0.0722 * double(rgb[2]);
}

/// Square tiles of `side` pixels from the top left, row by row; those at the right and bottom edge may be smaller.
struct TileGrid {
  uint32_t width = 0, height = 0;  ///< pixels of the picture
  uint32_t side = 1;               ///< pixels, at least 1
  uint32_t columns() const { return (width + side - 1) / side; }
  uint32_t rows() const { return (height + side - 1) / side; }
  size_t count() const { return size_t{columns()} * rows(); }
  /// The tile that holds pixel (x, y).
  size_t index(uint32_t x, uint32_t y) const { return size_t{y / side} * columns() + x / side; }
  uint32_t left(size_t tile) const { return static_cast<uint32_t>(tile % columns()) * side; }
  uint32_t top(size_t tile) const { return static_cast<uint32_t>(tile / columns()) * side; }
};

/// Calls work(first row, the row behind the last) for bands of whole rows of tiles that together are the picture: on
/// several cores where so many pictures are enough to do. What is summed by pixel or by tile comes out the same.
void forBands(const TileGrid& grid, size_t pictures, const std::function<void(uint32_t, uint32_t)>& work);

}  // namespace weir::image
