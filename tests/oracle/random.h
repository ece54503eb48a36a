// Uniform numbers by SplitMix64 (Steele, Lea, Flood 2014), from keys that say what they are for.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace weir::oracle {

constexpr uint64_t mixed(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

class Random {
 public:
  template <typename... Keys>
  explicit Random(uint64_t first, Keys... rest) : state_(mixed(first)) {
    ((state_ = mixed(state_ ^ static_cast<uint64_t>(rest))), ...);
  }
  uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15ull;
    uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  double next() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  ///< in [0, 1)
  glm::dvec2 next2() {
    const double a = next();
    return {a, next()};
  }
  glm::dvec3 next3() {
    const glm::dvec2 a = next2();
    return {a, next()};
  }

 private:
  uint64_t state_;
};

}  // namespace weir::oracle
