// The filters of FLIP as separable kernels. Internal to framework/image; the papers are named in flip.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace weir::image {

struct Plane {
  uint32_t width, height;
  std::vector<float> values;
  Plane(uint32_t w, uint32_t h) : width(w), height(h), values(size_t{w} * h) {}
  Plane() : Plane(0, 0) {}
};

/// Odd number of taps, the middle one at the pixel.
using Kernel = std::vector<float>;

/// A sum of two Gaussians in the plane: each is separable, their sum isn't. `weights` includes each one's share of the
/// normalisation; the kernels themselves sum to 1. A share of 0 has no kernel.
struct Sensitivity {
  std::array<float, 2> weights{};
  std::array<Kernel, 2> kernels;
};

struct FlipKernels {
  std::array<Sensitivity, 3> sensitivity;  ///< of the three opponent channels: section 4.1.1, table 1
  Kernel smooth, first, second;            ///< Gaussian and its derivatives, for edges and points: section 4.2
};

FlipKernels makeFlipKernels(double pixelsPerDegree);

/// Lengths of the first (edges) and second (points) derivative at every pixel.
struct Features {
  Plane edges, points;
};

/// Convolutions repeat the border pixel outwards.
Plane applySensitivity(const Plane& plane, const Sensitivity& sensitivity);
Features findFeatures(const Plane& lightness, const FlipKernels& kernels);

}  // namespace weir::image
