// FLIP: the difference that an observer sees when alternating between two pictures, per pixel in [0,1].
//
// LDR: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating
// Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. HDR: Andersson, Nilsson, Shirley, Akenine-Möller,
// "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics short papers 2021.
#pragma once

#include <weir/image/image.h>

#include <stop_token>
#include <vector>

namespace weir::image {

/// Pixels a degree of visual angle at the middle of a screen of that width, seen from that distance (metres).
double pixelsPerDegree(double distance, double screenWidth, double screenPixels);

/// FLIP of two sRGB-encoded pictures; values are clamped to [0,1]. width · height figures, row 0 at the top. Symmetric
/// in its arguments. Throws InputError if sizes differ or pixelsPerDegree isn't in [1, 1000].
std::vector<float> ldrFlip(const Picture& test, const Picture& reference, double pixelsPerDegree);

/// Exposures (in stops, `count` of them evenly from `start` to `stop`) at which the reference is looked at.
struct FlipExposures {
  double start = 0, stop = 0;
  int count = 1;
};
/// From the brightest pixel's luminance still below the tone map's shoulder (ACES value 0.85) to the same for the
/// median pixel; at least two exposures, one a stop or closer. A black reference: one exposure of 0.
FlipExposures flipExposures(const Picture& reference);

/// HDR-FLIP of two pictures of linear radiance (negative values count as 0): the maximum over exposures of FLIP after
/// the ACES fit. Not symmetric: exposures come from the reference. Throws as ldrFlip(). When `stop` says so, it ends
/// before the next exposure, and there is no map.
std::vector<float> hdrFlip(const Picture& test, const Picture& reference, double pixelsPerDegree,
                           const std::stop_token& stop = {});

}  // namespace weir::image
