// The pictures of a bench: a crop of a frame, of its reference, and a heat map of their difference, as display PNGs.
#pragma once

#include <weir/image/image.h>
#include <weir/render/bench_options.h>

#include <optional>
#include <span>

namespace weir::render {

/// 256×256 in the middle, or the whole of what is smaller; else what was asked for. InputError where that is empty or
/// leaves the picture.
Crop cropOf(const std::optional<Crop>& asked, uint32_t width, uint32_t height);

image::Picture cropped(const image::Picture& picture, const Crop& crop);

/// What radiance is multiplied by before it is clamped and sRGB-encoded, so that 98 % of the reference's pixels aren't
/// clamped; 1 for a black one. One factor for the reference and all that is compared with it.
float displayScale(const image::Picture& reference);

/// Radiance times `scale`, for writePng as Encoding::Radiance.
image::Picture scaled(image::Picture picture, float scale);

/// FLIP values in [0,1] of a picture of that width in the colours of "magma", from black to pale yellow: display
/// values.
image::Picture heatMap(std::span<const float> values, uint32_t width, const Crop& crop);

}  // namespace weir::render
