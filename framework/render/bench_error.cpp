#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/image/correlation_time.h>
#include <weir/image/flip.h>
#include <weir/image/metrics.h>
#include <weir/image/statistics.h>
#include <weir/render/bench_error.h>
#include <weir/render/mean.h>
#include <weir/render/reference_picture.h>
#include <weir/render/render.h>
#include <weir/render/statistics.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <numeric>

namespace weir::render {
namespace {

/// Of one repeat.
struct Repeat {
  std::vector<double> frames, trimmed;     ///< relMSE of each compared frame
  std::vector<image::PictureError> means;  ///< by meanLengths()
  double flip = 0;
};

/// FLIP of a frame; a pixel that is not finite adds no difference.
std::vector<float> flipOf(image::Picture frame, const image::Picture& reference) {
  for (size_t i = 0; i < frame.rgba.size(); ++i)
    if (!std::isfinite(frame.rgba[i])) frame.rgba[i] = reference.rgba[i];
  return image::hdrFlip(frame, reference, image::kDefaultPixelsPerDegree);
}

double meanOf(const auto& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// NaN where a value is not finite, which has no place in an order.
double medianOf(const std::vector<double>& values) {
  if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
    return std::numeric_limits<double>::quiet_NaN();
  return quantiles(values).median;
}

/// Receives the frames of one repeat after the other.
class FrameErrors {
 public:
  FrameErrors(const BenchSettings& settings, image::RelativeErrorMeter& meter)
      : settings_(settings), meter_(meter), lengths_(meanLengths(settings.errorFrames)) {}

  void begin() {
    repeats.emplace_back();
    sequences.emplace_back();
    mean_ = {};
    errors_.assign(meter_.pixels().size(), 0.0f);
    seen_ = compared_ = 0;
  }

  void take(const image::Picture& picture) {
    Repeat& r = repeats.back();
    if (seen_ % settings_.errorEvery == 0) {
      const image::PictureError e = meter_.measure(picture);
      r.frames.push_back(e.relMse);
      r.trimmed.push_back(e.trimmed);
      nonFinite += e.nonFinite;
      addErrors();
    }
    mean_.add(picture);
    if (std::ranges::count(lengths_, ++seen_) > 0) r.means.push_back(meter_.measure(mean_.mean()));
    if (seen_ < settings_.errorFrames) return;
    last = picture;
    end();
  }

  std::vector<Repeat> repeats;
  std::vector<image::SequenceErrors> sequences;
  image::Picture last;
  uint64_t nonFinite = 0;

 private:
  /// Running mean in float: a few hundred terms of one size.
  void addErrors() {
    const float share = 1.0f / static_cast<float>(++compared_);
    constexpr size_t kPiece = size_t{1} << 17;
    parallelFor((errors_.size() + kPiece - 1) / kPiece, [&](size_t piece) {
      for (size_t i = piece * kPiece; i < std::min(errors_.size(), (piece + 1) * kPiece); ++i)
        errors_[i] += (meter_.pixels()[i] - errors_[i]) * share;
    });
  }
  void end() {
    sequences.back().mean = mean_.mean();
    sequences.back().errors = std::move(errors_);
  }

  const BenchSettings& settings_;
  image::RelativeErrorMeter& meter_;
  std::vector<uint32_t> lengths_;
  FrameMean mean_;
  std::vector<float> errors_;
  uint32_t seen_ = 0, compared_ = 0;
};

/// Student's interval over repeats of what `value` says of each.
template <typename Value>
image::Interval overRepeats(const std::vector<Repeat>& repeats, const Value& value) {
  std::vector<double> values;
  for (const Repeat& r : repeats) values.push_back(value(r));
  return image::meanInterval(values);
}

ReferencePicture renderReference(Laboratory& laboratory, const BenchReference& options,
                                 const graph::CompiledGraph& graph, const BenchSettings& settings) {
  // Seeds of its own: of the same graph the reference is another sample, not the same one again.
  const RestartOptions r{"radiance", options.frames, settings.firstFrame, restartSeed(settings.seed, ~0u), false, 0};
  Restarts restarts(laboratory, graph, r);
  image::RestartAccumulator sum;
  restarts.run(options.restarts, [&](std::span<const image::Picture> pictures) { sum.add(pictures); });
  if (sum.nonFinite() > 0)
    throw RuntimeError(
        fmt::format("the reference {} has {} pixels that are not finite", options.graph, sum.nonFinite()));
  ReferencePicture result;
  result.picture = sum.mean();
  result.what =
      fmt::format("{}, {} restart{} of {} frame{}", std::filesystem::path(options.graph).filename().string(),
                  options.restarts, options.restarts == 1 ? "" : "s", options.frames, options.frames == 1 ? "" : "s");
  result.relMse = std::numeric_limits<double>::quiet_NaN();
  if (options.restarts < 2) return result;
  const image::Picture error = sum.standardError();
  double squares = 0;
  for (size_t i = 0; i < error.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    const double e = error.rgba[i], b = result.picture.rgba[i];
    squares += e * e / (b * b + image::kRelMseEpsilon);
  }
  result.relMse = squares / (0.75 * static_cast<double>(error.rgba.size()));
  // Restarts that agree to a float's rounding have no noise to speak of.
  constexpr double kRounding = 1e-11;
  result.exact = result.relMse < kRounding;
  return result;
}

}  // namespace

std::vector<uint32_t> meanLengths(uint32_t errorFrames) {
  std::vector<uint32_t> lengths;
  for (const uint32_t n : {64u, 256u})
    if (n < errorFrames) lengths.push_back(n);
  lengths.push_back(errorFrames);
  return lengths;
}

ReferencePicture makeReference(Laboratory& laboratory, const BenchReference& options, const graph::CompiledGraph& graph,
                               const BenchSettings& settings, uint32_t width, uint32_t height) {
  ReferencePicture result;
  if (options.file.empty()) {
    result = renderReference(laboratory, options, graph, settings);
  } else {
    result.picture = readRadiance(options.file, width, height);
    requireSameSubject(laboratory.stage(), "none", options.file, result.picture);
    result.what = std::filesystem::path(options.file).filename().string();
    result.relMse = std::numeric_limits<double>::quiet_NaN();
  }
  if (options.exact) {
    result.exact = true;
    result.relMse = 0;
  }
  return result;
}

ErrorResult measureErrors(execute::Executor& executor, const Stage& stage, const BenchSettings& settings,
                          const ReferencePicture& reference, image::RelativeErrorMeter& meter) {
  ErrorResult result;
  FrameErrors errors(settings, meter);
  Player player(stage);
  std::future<std::vector<float>> flip;
  const auto collectFlip = [&] {
    if (!flip.valid()) return;
    result.flipMap = flip.get();
    errors.repeats[errors.repeats.size() - 1].flip = meanOf(result.flipMap);
  };
  executor.captureTo({settings.output}, [&](const std::string&, const image::Picture& p) { errors.take(p); });
  for (uint32_t repeat = 0; repeat < settings.repeats; ++repeat) {
    const uint32_t seed = restartSeed(settings.seed, repeat);
    uint32_t number = settings.firstFrame;
    executor.resetHistory();
    for (uint32_t f = 0; f < settings.warmup; ++f) executor.frame(player.frame(number++, seed));
    // FLIP of the repeat before takes as long as many frames: it goes on beside this one's warm-up.
    collectFlip();
    errors.begin();
    for (uint32_t f = 0; f < settings.errorFrames; ++f) executor.frame(player.frame(number++, seed), true);
    executor.finish();
    executor.takeTimes();
    if (settings.flip)
      flip = std::async(std::launch::async,
                        [frame = errors.last, &reference] { return flipOf(frame, reference.picture); });
  }
  collectFlip();
  executor.captureTo({}, {});

  ErrorMeasure& m = result.measure;
  const std::vector<Repeat>& repeats = errors.repeats;
  m.repeats = settings.repeats;
  m.frames = settings.errorFrames;
  m.every = settings.errorEvery;
  m.reference = reference.what;
  m.exact = reference.exact;
  m.referenceRelMse = reference.relMse;
  m.frameMedian = overRepeats(repeats, [](const Repeat& r) { return medianOf(r.frames); });
  m.frameMean = overRepeats(repeats, [](const Repeat& r) { return meanOf(r.frames); });
  m.frameTrimmed = overRepeats(repeats, [](const Repeat& r) { return medianOf(r.trimmed); });
  const std::vector<uint32_t> lengths = meanLengths(settings.errorFrames);
  for (size_t i = 0; i < lengths.size(); ++i) {
    m.means.emplace_back(lengths[i], overRepeats(repeats, [&](const Repeat& r) { return r.means[i].relMse; }));
    m.trimmedMeans.emplace_back(lengths[i], overRepeats(repeats, [&](const Repeat& r) { return r.means[i].trimmed; }));
  }
  m.bias = overRepeats(repeats, [](const Repeat& r) { return r.means.back().relativeBias; });
  if (settings.flip) m.flip = overRepeats(repeats, [](const Repeat& r) { return r.flip; });
  m.correlationTime = image::correlationTime(errors.sequences, reference.picture, settings.errorFrames);
  m.nonFinite = errors.nonFinite;
  result.lastFrame = std::move(errors.last);
  return result;
}

}  // namespace weir::render
