// The last frames' times: stacked by pass, and in figures.
#pragma once

#include "view/panels/requests.h"
#include "view/ui/ui.h"

#include <weir/execute/executor.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace weir::view {

/// A ring of the last frames' times, and figures over it. Plain data.
class TimeLog {
 public:
  static constexpr size_t kFrames = 300;

  /// Names of the passes from now on; forgets what was there unless they are the same.
  void setPasses(const std::vector<std::string>& names);
  void add(const execute::FrameTimes& times);
  void addUi(double milliseconds);

  const std::vector<std::string>& passes() const { return passes_; }
  size_t size() const { return size_; }
  /// `back` 0: the newest. GPU milliseconds of a pass; of "scene" where index == passes().size().
  float gpu(size_t back, size_t pass) const;
  float gpuFrame(size_t back) const;
  float cpuFrame(size_t back) const;
  struct Figures {
    float median = 0.0f, p95 = 0.0f;
  };
  /// Over the frames held; sorted anew only when a quarter of a second's worth of frames came in.
  const std::vector<Figures>& passFigures() const { return passFigures_; }
  const Figures& gpuFigures() const { return gpuFigures_; }
  const Figures& cpuFigures() const { return cpuFigures_; }
  const Figures& uiFigures() const { return uiFigures_; }
  float longest() const { return longest_; }  ///< GPU milliseconds of a frame, smoothed: the plot's height
  bool hasGpu() const { return hasGpu_; }

  /// Milliseconds of the window's own work since the last measuring began, for scripts.
  std::vector<double> takeUi();

 private:
  void work();
  std::vector<std::string> passes_;
  std::vector<float> gpu_;  ///< kFrames x (passes + 1)
  std::vector<float> gpuFrame_ = std::vector<float>(kFrames), cpuFrame_ = std::vector<float>(kFrames);
  std::vector<float> scratch_;
  size_t next_ = 0, size_ = 0, sinceWork_ = 0;
  std::vector<Figures> passFigures_;
  Figures gpuFigures_, cpuFigures_, uiFigures_;
  std::vector<double> ui_;
  float longest_ = 0.1f;
  bool hasGpu_ = false;
};

struct TimePanelModel {
  const TimeLog* log = nullptr;
  uint64_t rays = 0, transientBytes = 0, historyBytes = 0, savedBytes = 0, sceneBytes = 0;
  bool countsRays = false, paused = false;
  uint32_t frames = 0;
  float framesPerSecond = 0.0f;
  std::string device;
};

Requests drawTimePanel(Ui& ui, const Rectangle& where, const TimePanelModel& model);

}  // namespace weir::view
