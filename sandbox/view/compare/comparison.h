// Everything that is compared live, for an engine that calls it once a frame: the reference goes on, the shown picture
// is measured now and then, the trail grows. What goes wrong is told and ends nothing.
#pragma once

#include <weir/execute/executor.h>

#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "view/compare/live_error.h"
#include "view/compare/picture_ring.h"
#include "view/compare/reference.h"
#include "view/compare/trail.h"
#include "view/compare/warm_up.h"

namespace weir::view {

/// The frame that the window shows.
struct ComparedFrame {
  execute::FrameInput input;  ///< camera and state of the scene
  glm::uvec2 size{0};         ///< pixels
  double seconds = 0.0;       ///< of the clip; 0 where nothing moves
  /// Another number for another scene or other lights, but not for another graph: that would throw the reference away
  /// with each knob that is turned.
  uint64_t scene = 0;
  /// The picture that is measured, radiance, as Executor::locate gives it; none: the graph has none.
  std::optional<execute::Executor::Located> picture;
  bool isNew = true;                           ///< false: the window is paused, and shows what it did
  std::span<const execute::FrameTimes> times;  ///< that Executor::takeTimes gave after it
};

/// All that there is to show of it, as plain data.
struct ComparisonState {
  bool compares = false;                ///< there is a reference
  std::string words, warning, problem;  ///< of the reference; empty: nothing to say
  std::optional<ErrorFigures> error;
  std::optional<FlipFigures> flip;
  double referenceRelMse = 0.0;  ///< its own: points below can't be told apart; NaN: unknown
  bool flips = true;
  double budget = 0.0;
  std::vector<TrailPoint> points;  ///< the present setting is the last one, if it has a point
  bool hasCurrent = false;
  std::vector<size_t> front;  ///< of points, from the fastest on
  std::string trailWords;
};

class Comparison {
 public:
  /// The device must outlive it.
  explicit Comparison(const gpu::Device& device, const TrailOptions& trail = {});
  ~Comparison();

  /// Compares with this from now on; null: with nothing, as before the scene that it is of goes. Errors so far are
  /// forgotten.
  void setReference(std::unique_ptr<Reference> reference);
  const Reference* reference() const { return reference_.get(); }
  Reference* reference() { return reference_.get(); }

  /// A knob was turned, so that the next frame has another setting. `graph` as it is from then on.
  void turned(const KnobChange& change, const graph::CompiledGraph& graph);
  /// Another graph is shown from the next frame on, or history starts anew: the trail does too.
  void restarted(const graph::CompiledGraph& graph);

  /// After each frame was submitted, and also while paused. The reference starts over by itself when camera, moment,
  /// scene or size are others than in the last frame. Never throws for what goes wrong with the reference: problem()
  /// then says it, and the reference is gone.
  void frame(const ComparedFrame& frame);

  /// Milliseconds of the device's time that a frame of the window spares for the reference; 0: it rests.
  void setBudget(double milliseconds) { budget_ = milliseconds; }
  double budget() const { return budget_; }
  /// Whether FLIP is worked out; it keeps the other cores busy.
  void setFlip(bool flip) { flip_ = flip; }
  bool flips() const { return flip_; }

  /// The newest figures of what is shown now; none before the first.
  const std::optional<ErrorFigures>& error() const { return error_; }
  std::optional<FlipFigures> flip() const;
  Trail& trail() { return trail_; }
  const Trail& trail() const { return trail_; }
  const std::string& problem() const { return problem_; }  ///< or empty
  ComparisonState state() const;

 private:
  /// What pictures of two frames can have in common.
  struct Shown {
    glm::vec3 eye{0.0f}, forward{0.0f}, up{0.0f};
    float verticalFov = 0.0f;
    glm::uvec2 size{0};
    double seconds = 0.0;
    uint64_t scene = 0;
    bool operator==(const Shown&) const = default;
  };
  struct Captured {
    uint64_t number, frame, view;
  };
  static Shown shownOf(const ComparedFrame& frame);
  void follow(const ComparedFrame& frame);
  void startTrail(uint64_t since);
  void capture(const ComparedFrame& frame);
  void measureCaptured();
  void takeFigures();
  void lose(const std::string& why);

  std::unique_ptr<Reference> reference_;
  PictureRing ring_;
  LiveError live_;
  Trail trail_;
  Shown shown_;
  bool fresh_ = true;  ///< the reference has not been told what is shown
  double budget_ = 4.0;
  bool flip_ = true;
  uint64_t frame_ = 0;  ///< counts frames of the window, whatever the engine does
  uint64_t since_ = 0;  ///< the first frame that shows what is shown now
  uint64_t captured_ = 0;
  std::deque<Captured> onTheWay_;
  std::optional<ErrorFigures> error_;
  std::string problem_;
};

}  // namespace weir::view
