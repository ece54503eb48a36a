// The plane of error against time, live: a point for the setting that runs, and fainter ones for those before it. Plain
// data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace weir::view {

/// The middle half of some values, and their median; by linear interpolation between order statistics.
struct Spread {
  double low = 0.0, median = 0.0, high = 0.0;
};
/// Of at least one value, all finite.
Spread spreadOf(std::vector<double> values);

/// A setting in the plane.
struct TrailPoint {
  std::string label;                ///< the change that made it, such as "spatial.radius 6 → 12"
  Spread milliseconds;              ///< of a frame on the device
  Spread relMse;                    ///< of a frame's picture
  double relMseTrimmed = 0;         ///< median
  double relativeBias = 0;          ///< mean over pictures; NaN on a black reference
  size_t frames = 0, pictures = 0;  ///< that it is made of
};

struct TrailOptions {
  size_t window = 128;  ///< frames, and pictures, that a point is made of: the newest
  size_t fewest = 5;    ///< of each before there is a point
  size_t old = 24;      ///< points kept of earlier settings
};

/// A knob that was turned.
struct KnobChange {
  std::string knob, from, to;  ///< "spatial.radius", "6", "12"
};

class Trail {
 public:
  explicit Trail(const TrailOptions& options = {}) : options_(options) {}

  /// How many frames after a change are left out, and why, in a clause. For changes to come.
  void warmUp(uint64_t frames, std::string reason);
  /// `frame` is the first with the new setting. The point so far becomes an old one, if there is one already: a knob
  /// that is dragged leaves its ends alone, and the label then has the first value and the last.
  void change(uint64_t frame, const KnobChange& change);
  /// `frame` is the first that shows something else (camera, scene, size, reference): errors so far say nothing of it,
  /// and old points go.
  void restart(uint64_t frame);
  /// Old points go; the present one stays.
  void forgetOld() { old_.clear(); }

  /// What a frame took on the device. Ignored: not above 0 (the device measures no time), or a frame that is left out.
  void addTime(uint64_t frame, double milliseconds);
  /// What a frame's picture was measured at. Replaces the newest when that is of the same frame. Ignored: relMse not
  /// finite, or a frame that is left out.
  void addError(uint64_t frame, double relMse, double relMseTrimmed, double relativeBias);

  /// None as long as there are too few frames or pictures.
  std::optional<TrailPoint> current() const;
  const std::vector<TrailPoint>& old() const { return old_; }  ///< oldest first
  /// Which points no other one beats in time and error both: numbers in old(), old().size() for the present one; from
  /// the fastest on.
  std::vector<size_t> front() const;
  /// Where the present point is: "8 of 40 frames left out: the history fills"
  std::string words() const;
  /// One line a point with a head; numbers in full.
  std::string csv() const;

 private:
  struct Error {
    uint64_t frame;
    double relMse, trimmed, bias;
  };
  void begin(uint64_t frame);
  void keep(TrailPoint point);
  std::string label() const;
  std::vector<TrailPoint> all() const;

  TrailOptions options_;
  uint64_t warmUp_ = 0;
  std::string reason_;
  uint64_t first_ = 0, newest_ = 0;  ///< frames: the first that counts, and the newest seen
  uint64_t leftOut_ = 0;             ///< of the present setting
  bool seen_ = false;
  std::vector<KnobChange> changes_;  ///< that made the present setting
  std::vector<double> times_;        ///< newest last
  std::vector<Error> errors_;
  std::vector<TrailPoint> old_;
};

/// Numbers of the points that no other one beats in both, from the smallest x on.
std::vector<size_t> paretoFront(const std::vector<TrailPoint>& points);

}  // namespace weir::view
