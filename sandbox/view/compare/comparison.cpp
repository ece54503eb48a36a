#include "view/compare/comparison.h"

#include <exception>
#include <limits>
#include <utility>

namespace weir::view {

Comparison::Comparison(const gpu::Device& device, const TrailOptions& trail) : ring_(device), trail_(trail) {}
Comparison::~Comparison() = default;

void Comparison::setReference(std::unique_ptr<Reference> reference) {
  reference_ = std::move(reference);
  problem_.clear();
  fresh_ = true;
  startTrail(frame_ + 1);
}

void Comparison::startTrail(uint64_t since) {
  since_ = since;
  error_.reset();
  onTheWay_.clear();
  trail_.restart(since_);
}

void Comparison::turned(const KnobChange& change, const graph::CompiledGraph& graph) {
  WarmUp warmUp = warmUpOf(graph);
  trail_.warmUp(warmUp.frames, std::move(warmUp.reason));
  trail_.change(frame_ + 1, change);
}

void Comparison::restarted(const graph::CompiledGraph& graph) {
  WarmUp warmUp = warmUpOf(graph);
  trail_.warmUp(warmUp.frames, std::move(warmUp.reason));
  startTrail(frame_ + 1);
}

Comparison::Shown Comparison::shownOf(const ComparedFrame& frame) {
  const scene::Camera& camera = frame.input.camera;
  return {camera.eye, camera.forward, camera.up, camera.verticalFov, frame.size, frame.seconds, frame.scene};
}

/// Keeps reference and trail to what is shown.
void Comparison::follow(const ComparedFrame& frame) {
  const Shown now = shownOf(frame);
  const bool same = now == shown_;
  if (same && !fresh_) return;
  shown_ = now;
  fresh_ = false;
  if (!same) startTrail(frame_);
  if (reference_) reference_->restart(frame.input, frame.size.x, frame.size.y);
}

void Comparison::frame(const ComparedFrame& frame) {
  if (frame.isNew || frame_ == 0) ++frame_;
  try {
    follow(frame);
    // Times come two frames later, when the frame's slot is used again.
    constexpr uint64_t kLater = execute::SceneFrame::kSlots;
    for (const execute::FrameTimes& times : frame.times)
      if (frame_ > kLater) trail_.addTime(frame_ - kLater, times.gpuFrame);
    if (!reference_) return;
    reference_->step(budget_);
    measureCaptured();
    capture(frame);
    takeFigures();
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

void Comparison::capture(const ComparedFrame& frame) {
  if (!frame.picture || !live_.ready() || ring_.pending() || !reference_->latest()) return;
  if (ring_.capture(*frame.picture, captured_)) onTheWay_.push_back({captured_++, frame_, reference_->view()});
}

void Comparison::measureCaptured() {
  for (const HostCopy& copy : ring_.take()) {
    while (!onTheWay_.empty() && onTheWay_.front().number < copy.number()) onTheWay_.pop_front();
    if (onTheWay_.empty() || onTheWay_.front().number != copy.number()) continue;  // of something else
    const Captured captured = onTheWay_.front();
    onTheWay_.pop_front();
    const std::shared_ptr<const ReferencePicture> latest = reference_->latest();
    if (!latest || latest->view != captured.view) continue;
    live_.measure(
        captured.frame, [copy] { return copy.picture(); }, latest, flip_);
  }
}

void Comparison::takeFigures() {
  for (ErrorFigures& figures : live_.take()) {
    if (figures.frame < since_ || figures.view != reference_->view()) continue;
    trail_.addError(figures.frame, figures.relMse, figures.relMseTrimmed, figures.relativeBias);
    error_ = std::move(figures);
  }
}

std::optional<FlipFigures> Comparison::flip() const {
  std::optional<FlipFigures> flip = live_.flip();
  if (!reference_ || !flip || flip->frame < since_ || flip->view != reference_->view()) return std::nullopt;
  return flip;
}

ComparisonState Comparison::state() const {
  ComparisonState s;
  s.compares = reference_ != nullptr;
  s.problem = problem_;
  s.referenceRelMse = std::numeric_limits<double>::quiet_NaN();
  if (reference_) {
    s.words = reference_->words();
    s.warning = reference_->warning();
    if (const std::shared_ptr<const ReferencePicture> latest = reference_->latest()) s.referenceRelMse = latest->relMse;
  }
  s.error = error_;
  s.flip = flip();
  s.flips = flip_;
  s.budget = budget_;
  s.points = trail_.old();
  if (std::optional<TrailPoint> now = trail_.current()) {
    s.points.push_back(*std::move(now));
    s.hasCurrent = true;
  }
  s.front = paretoFront(s.points);
  s.trailWords = trail_.words();
  return s;
}

void Comparison::lose(const std::string& why) {
  reference_.reset();
  startTrail(frame_ + 1);
  problem_ = why;
}

}  // namespace weir::view
