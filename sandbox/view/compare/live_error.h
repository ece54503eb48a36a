// How far the shown pictures are from the reference, worked out beside the window: relMSE and bias as fast as one
// thread measures, FLIP on another at its own, slower pace.
#pragma once

#include <weir/image/image.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/compare/background_worker.h"
#include "view/compare/reference.h"

namespace weir::view {

/// Of one picture. As `weir compare` has them: over pixels that are finite in both pictures, linear and unclamped.
struct ErrorFigures {
  uint64_t frame = 0;            ///< number of the frame that was measured
  uint64_t view = 0;             ///< of the reference
  uint64_t referenceFrames = 0;  ///< behind it; 0: of a file
  double referenceRelMse = 0.0;  ///< its own, which is part of relMse; NaN: unknown
  double relMse = 0.0;           ///< image::Metrics::relMse
  double relMseTrimmed = 0.0;    ///< without the worst 0.1 % of pixels
  double relativeBias = 0.0;     ///< of the mean luminance; NaN on a black reference
  uint64_t nonFinite = 0;        ///< pixels that are left out
  std::string problem;           ///< why there are no figures (sizes that differ, …); else empty
};

struct FlipFigures {
  uint64_t frame = 0, view = 0;
  double mean = 0.0, p99 = 0.0;  ///< HDR-FLIP, in [0,1], at image::kDefaultPixelsPerDegree
  double seconds = 0.0;          ///< that it took
  std::string problem;
};

class LiveError {
 public:
  /// Makes the picture: called once, on a thread of this object's. What it throws becomes the problem.
  using Source = std::function<image::Picture()>;

  LiveError();
  /// Joins its threads; a FLIP that runs ends before its next exposure.
  ~LiveError();
  LiveError(const LiveError&) = delete;
  LiveError& operator=(const LiveError&) = delete;

  /// Hands a frame's picture over and returns at once. One that waits still is dropped for it. Both must show the same
  /// (Reference::view()); null or a source that is empty: InputError.
  void measure(uint64_t frame, Source picture, std::shared_ptr<const ReferencePicture> reference, bool flip = true);
  /// Whether a picture that is handed over now would be measured at once.
  bool ready() const { return quick_->idle(); }

  /// What was measured since the last call, oldest first; of the last kKept at most.
  std::vector<ErrorFigures> take();
  static constexpr size_t kKept = 64;
  /// The newest; none before the first.
  std::optional<FlipFigures> flip() const;

 private:
  struct Results;
  std::unique_ptr<Results> results_;
  std::unique_ptr<BackgroundWorker> slow_;   ///< FLIP
  std::unique_ptr<BackgroundWorker> quick_;  ///< last: it ends before the one that it hands pictures to
};

}  // namespace weir::view
