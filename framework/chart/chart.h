// `weir chart` as a function: bench files in, a page or a still picture out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace weir::chart {

struct Options {
  std::vector<std::string> files;    ///< of `weir bench`
  std::string page, svg;             ///< where to; empty: not wanted
  std::string title;                 ///< empty: made from the scenes
  std::string time, error;           ///< keys of timeAxes and errorAxes; empty: the first one measured
  size_t pictureBytes = 64u << 20u;  ///< at most so much of PNG files goes into the page
};

struct Summary {
  size_t configurations = 0, groups = 0, pictures = 0;  ///< pictures: embedded, each content once
  std::vector<std::string> warnings;
};

/// Reads and checks everything before it writes anything; each file appears whole or not at all. Throws InputError for
/// bad input and RuntimeError when a file can't be written.
Summary makeChart(const Options& options);

}  // namespace weir::chart
