// How long something took on the host.
#pragma once

#include <chrono>

namespace weir {

using Clock = std::chrono::steady_clock;

inline double millisecondsSince(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

}  // namespace weir
