// The crops that the page shows, read and put into text.
#pragma once

#include <weir/chart/bench_file.h>

#include <array>
#include <string>
#include <vector>

namespace weir::chart {

struct EmbeddedPictures {
  std::vector<std::string> base64;  ///< PNG files, each content once
  /// Of each configuration: indices of frame, reference and FLIP map in base64, −1 where there is none.
  std::vector<std::array<int, 3>> of;
  size_t leftOut = 0;  ///< configurations that lack a picture because of the limit
};

/// Reads pictures in `order` (indices of configurations) until `mostBytes` of them (as files) are taken; those of one
/// configuration come together or not at all. A file that is no PNG, larger than 8 MiB or unreadable is left out with a
/// warning.
EmbeddedPictures embedPictures(const Bench& bench, const std::vector<size_t>& order, size_t mostBytes,
                               std::vector<std::string>& warnings);

std::string base64(const std::string& bytes);

}  // namespace weir::chart
