// How many frames fit into what a window can spare of the device's time, from what earlier ones took. Plain figures.
#pragma once

#include <optional>
#include <vector>

namespace weir::view {

class FramePacer {
 public:
  /// A step begins that may take so many milliseconds; 0 and less: none. What a step leaves over is kept until a frame
  /// that takes longer than a step's share fits, and no longer: nobody saves up for a burst.
  void grant(double milliseconds);
  /// Whether another frame fits. While no time is known: one a step.
  bool affords() const;
  /// A frame was submitted.
  void spend();
  /// What a finished frame took. Not above 0: the device measures no time, and it stays unknown. The first one is left
  /// out: drivers finish compiling in it, which can take a thousand times as long as the frame.
  void measured(double milliseconds);
  /// The median of the last ones, the lower one of an even number.
  std::optional<double> cost() const { return cost_; }
  /// Frames of another size or graph follow.
  void forget();

 private:
  std::vector<double> last_;  ///< a ring
  size_t next_ = 0;
  std::optional<double> cost_;
  double credit_ = 0.0;
  bool granted_ = false, spent_ = false, warm_ = false;
};

}  // namespace weir::view
