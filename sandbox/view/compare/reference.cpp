#include "view/compare/reference.h"

#include <fmt/format.h>

#include <cmath>

namespace weir::view {

std::string qualityInWords(const ReferencePicture& r) {
  std::string text = r.frames == 0   ? "a picture from a file; its own error is unknown"
                     : r.frames == 1 ? "1 frame"
                                     : fmt::format("{} frames", r.frames);
  // Frames that agree to a float's rounding have no noise to speak of.
  constexpr double kRounding = 1e-11;
  if (r.frames > 1 && r.relMse < kRounding) {
    text += ", which are all alike: as good as exact";
  } else if (r.frames > 1 && std::isfinite(r.relMse)) {
    text += fmt::format("; its own relMSE is {:.2g}: smaller errors can't be told", r.relMse);
  } else if (r.frames > 0) {
    text += "; its own error is not known yet";
  }
  if (r.nonFinite > 0) text += fmt::format("; {} pixel{} not finite", r.nonFinite, r.nonFinite == 1 ? " is" : "s are");
  return text;
}

}  // namespace weir::view
