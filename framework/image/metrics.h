// How far a picture is from a reference, in figures. a: the test picture, b: the reference, both R, G, B per pixel.
//
// Radiance (EXR) is compared linear and unclamped; display values (PNG) as they are in the file.
// MSE, relMSE and MAPE as renderers' papers use them (Rousselle et al. 2011, "Adaptive Sampling and Reconstruction
// using Greedy Error Minimization", section 5, has relMSE with eps = 0.01). FLIP: flip.h.
#pragma once

#include <weir/image/image.h>
#include <weir/image/tiles.h>

#include <stop_token>
#include <string>
#include <vector>

namespace weir::image {

constexpr double kRelMseEpsilon = 0.01;                        ///< in relMSE = mean (a-b)² / (b² + eps)
constexpr double kMapeEpsilon = 0.01;                          ///< in MAPE = mean |a-b| / (|b| + eps)
constexpr double kDefaultPixelsPerDegree = 67.02064327658226;  ///< 0.7 m from a 0.7 m wide screen of 3840 pixels

/// All means run over the counted pixels (inside the mask, finite in both pictures) and, unless said otherwise, over
/// their three channels. NaN when no pixel is counted.
struct Metrics {
  double mse = 0;     ///< mean (a - b)²
  double relMse = 0;  ///< mean (a - b)² / (b² + 0.01)
  double relMseTrimmed =
      0;  ///< relMse without the floor(n/1000) pixels whose own relMSE (mean of 3 channels) is largest
  double relMseMedian = 0;                 ///< median over pixels of a pixel's relMSE (the lower one of an even number)
  double mape = 0;                         ///< mean |a - b| / (|b| + 0.01)
  double flipMean = 0;                     ///< mean over pixels of FLIP, in [0,1]
  double flipP99 = 0;                      ///< 99th percentile over pixels of FLIP, by nearest rank
  double biasR = 0, biasG = 0, biasB = 0;  ///< mean of a - b per channel, signed, in the pictures' unit
  double relativeBias = 0;  ///< (mean luminance of a - that of b) / that of b; NaN unless that is above 0
  uint64_t nonFinite = 0;   ///< pixels inside the mask where a or b has a NaN or an infinity: left out of all else
  uint64_t pixels = 0;      ///< pixels that were counted
};

struct MetricOptions {
  const Picture* mask = nullptr;  ///< counts where the largest of R, G, B is above 0.5; null counts all
  bool hdr = true;                ///< HDR-FLIP on linear radiance; otherwise LDR-FLIP on sRGB-encoded values
  bool flip = true;               ///< off: flipMean and flipP99 are NaN, and the rest is quick
  double pixelsPerDegree = kDefaultPixelsPerDegree;
  std::stop_token stop = {};  ///< ends HDR-FLIP early: its figures are NaN then
};

/// Throws InputError if sizes differ or the mask counts nothing. For FLIP, which looks at neighbours too, a non-finite
/// pixel is replaced in both pictures by the reference's value (black if that is not finite), so that it adds no
/// difference.
Metrics measure(const Picture& test, const Picture& reference, const MetricOptions& options = {});

struct TileDifference {
  uint32_t x = 0, y = 0;                                     ///< top left pixel
  uint64_t pixels = 0;                                       ///< that were counted; the figures are 0 where none was
  double differenceR = 0, differenceG = 0, differenceB = 0;  ///< mean of a - b
  double difference = 0;                                     ///< of luminance
  double reference = 0;                                      ///< mean luminance of b
  /// difference / max(reference, 1 % of the whole picture's mean reference luminance); NaN where there is a difference
  /// and neither is above 0.
  double relative = 0;
};

struct TileSummary {
  TileGrid grid;
  std::vector<TileDifference> tiles;  ///< row by row
  std::vector<size_t> worst;          ///< up to 5 tiles with the largest |relative|, worst first
  double rmsRelative = 0;             ///< sqrt of the mean over counted tiles of relative²; NaN if one is
  double maxRelative = 0;             ///< largest |relative|; NaN if one is, which counts as the worst
};

/// Per-tile mean differences. The floor under a tile's reference keeps tiles that are as good as black from
/// dominating. Throws InputError as measure() does, and for side 0.
TileSummary compareTiles(const Picture& test, const Picture& reference, uint32_t side, const Picture* mask = nullptr);

/// Where both pictures have one of the attributes weir.scene, .animation, .camera, .lights, .shading and its values
/// differ: one line each with the name and both values. Such pictures show different things, and their difference says
/// nothing.
std::vector<std::string> attributeConflicts(const Picture& test, const Picture& reference);

}  // namespace weir::image
