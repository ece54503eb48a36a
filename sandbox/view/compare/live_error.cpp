#include "view/compare/live_error.h"

#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/image/metrics.h>

#include <exception>
#include <limits>
#include <mutex>
#include <utility>

namespace weir::view {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using SharedPicture = std::shared_ptr<const image::Picture>;
using SharedReference = std::shared_ptr<const ReferencePicture>;

ErrorFigures figuresOf(uint64_t frame, const image::Picture& picture, const ReferencePicture& reference) {
  const image::Metrics m = image::measure(picture, reference.picture, {.flip = false});
  ErrorFigures f;
  f.relMse = m.relMse;
  f.relMseTrimmed = m.relMseTrimmed;
  f.relativeBias = m.relativeBias;
  f.nonFinite = m.nonFinite;
  if (m.pixels == 0) f.problem = "no pixel is finite in both pictures";
  f.frame = frame;
  return f;
}

FlipFigures flipOf(uint64_t frame, const image::Picture& picture, const ReferencePicture& reference,
                   const std::stop_token& stop) {
  const Clock::time_point start = Clock::now();
  const image::Metrics m = image::measure(picture, reference.picture, {.stop = stop});
  FlipFigures f{frame, reference.view, m.flipMean, m.flipP99, millisecondsSince(start) * 1e-3, {}};
  if (m.pixels == 0) f.problem = "no pixel is finite in both pictures";
  return f;
}

}  // namespace

struct LiveError::Results {
  std::mutex mutex;
  std::vector<ErrorFigures> figures;
  std::optional<FlipFigures> flip;

  void add(ErrorFigures f) {
    const std::lock_guard lock(mutex);
    if (figures.size() == kKept) figures.erase(figures.begin());
    figures.push_back(std::move(f));
  }
  void set(FlipFigures f) {
    const std::lock_guard lock(mutex);
    flip = std::move(f);
  }
};

LiveError::LiveError()
    : results_(std::make_unique<Results>()),
      slow_(std::make_unique<BackgroundWorker>()),
      quick_(std::make_unique<BackgroundWorker>()) {}

LiveError::~LiveError() = default;

void LiveError::measure(uint64_t frame, Source picture, SharedReference reference, bool flip) {
  if (!picture || !reference) throw InputError("an error wants a picture and a reference");
  const auto slowJob = [results = results_.get()](uint64_t number, const SharedPicture& shown,
                                                  const SharedReference& truth) {
    return [=](const std::stop_token& stop) {
      FlipFigures f{number, truth->view, kNaN, kNaN, 0.0, {}};
      try {
        f = flipOf(number, *shown, *truth, stop);
      } catch (const std::exception& error) {  // no memory: a thread must not end by it
        f.problem = error.what();
      }
      if (!stop.stop_requested()) results->set(std::move(f));
    };
  };
  quick_->post([=, source = std::move(picture), truth = std::move(reference), results = results_.get(),
                slow = slow_.get()](const std::stop_token& /*stop*/) {
    ErrorFigures f;
    f.relMse = f.relMseTrimmed = f.relativeBias = kNaN;
    SharedPicture shown;
    try {
      shown = std::make_shared<const image::Picture>(source());
      f = figuresOf(frame, *shown, *truth);
    } catch (const std::exception& error) {
      f.problem = error.what();
    }
    f.frame = frame;
    f.view = truth->view;
    f.referenceFrames = truth->frames;
    f.referenceRelMse = truth->relMse;
    const bool fine = f.problem.empty();
    results->add(std::move(f));
    if (flip && fine) slow->post(slowJob(frame, shown, truth));
  });
}

std::vector<ErrorFigures> LiveError::take() {
  const std::lock_guard lock(results_->mutex);
  return std::exchange(results_->figures, {});
}

std::optional<FlipFigures> LiveError::flip() const {
  const std::lock_guard lock(results_->mutex);
  return results_->flip;
}

}  // namespace weir::view
