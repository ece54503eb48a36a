// The oracle's pictures: direct light and n bounces by path tracing.
#pragma once

#include <weir/image/statistics.h>

#include <functional>

#include "lights.h"
#include "model.h"
#include "tracer.h"

namespace weir::oracle {

struct Options {
  uint32_t width = 64, height = 64;
  uint32_t bounces = 0;   ///< 0: direct light alone
  uint32_t samples = 16;  ///< paths a pixel in each batch
  uint32_t batches = 16;  ///< independent ones: standard errors come from them
  uint32_t seed = 0;
  bool jitter = false;        ///< samples over the pixel's box rather than at its centre
  bool everyPunctual = true;  ///< at the first surface a shadow ray to every punctual light; else to one of them
  uint32_t tile = 16;         ///< of the statistics, pixels
  uint32_t threads = 0;       ///< 0: all cores
  std::function<void(uint32_t)> progress;  ///< called with the number of batches done
};

/// Each batch is one "restart" of the accumulator.
image::RestartAccumulator render(const Model& model, const Tracer& tracer, const Camera& camera,
                                 const Options& options);

}  // namespace weir::oracle
