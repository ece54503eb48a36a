// How far a configuration's pictures are from the reference: of single frames and of their means, from independent
// restarts. The metrics run on the host's cores while the GPU goes on.
#pragma once

#include <weir/execute/executor.h>
#include <weir/image/image.h>
#include <weir/image/relative_error.h>
#include <weir/render/bench_options.h>
#include <weir/render/bench_record.h>
#include <weir/render/laboratory.h>

#include <cstdint>
#include <string>
#include <vector>

namespace weir::render {

/// A reference and what is known of its own error.
struct ReferencePicture {
  image::Picture picture;
  std::string what;
  bool exact = false;
  double relMse = 0;  ///< its own, which adds to each that is measured against it; NaN: unknown
};

/// From its file, or rendered by `graph` (compiled from BenchReference::graph). The laboratory must be open. Throws
/// InputError, RuntimeError.
ReferencePicture makeReference(Laboratory& laboratory, const BenchReference& options, const graph::CompiledGraph& graph,
                               const BenchSettings& settings, uint32_t width, uint32_t height);

struct ErrorResult {
  ErrorMeasure measure;
  image::Picture lastFrame;    ///< of the last repeat
  std::vector<float> flipMap;  ///< of that frame; empty without FLIP
};

/// `repeats` restarts with seeds of their own; each: `warmup` frames from cleared history, then `errorFrames` that are
/// captured. Memory: about 120 bytes a pixel, and 20 more a repeat, whatever the number of frames.
ErrorResult measureErrors(execute::Executor& executor, const Stage& stage, const BenchSettings& settings,
                          const ReferencePicture& reference, image::RelativeErrorMeter& meter);

/// The lengths N of means whose error is quoted: 64 and 256 where there are as many frames, and all of them.
std::vector<uint32_t> meanLengths(uint32_t errorFrames);

}  // namespace weir::render
