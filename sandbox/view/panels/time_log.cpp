#include "view/panels/time_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weir::view {
namespace {

TimeLog::Figures figuresOf(std::vector<float>& values) {
  if (values.empty()) return {};
  const auto at = [&](double share) {
    const auto place = static_cast<size_t>(std::lround(share * static_cast<double>(values.size() - 1)));
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(place));
    return values[place];
  };
  TimeLog::Figures figures;
  figures.median = at(0.5);
  figures.p95 = at(0.95);
  return figures;
}

}  // namespace

void TimeLog::setPasses(const std::vector<std::string>& names) {
  if (names == passes_ && !gpu_.empty()) return;
  passes_ = names;
  gpu_.assign(kFrames * (passes_.size() + 1), 0.0f);
  passFigures_.assign(passes_.size() + 1, {});
  gpuFigures_ = cpuFigures_ = {};
  next_ = size_ = sinceWork_ = 0;
}

void TimeLog::add(const execute::FrameTimes& times) {
  if (times.cpu.size() != passes_.size()) return;  // of the graph before
  hasGpu_ = !times.gpu.empty();
  float* row = &gpu_[next_ * (passes_.size() + 1)];
  for (size_t p = 0; p < passes_.size(); ++p) row[p] = hasGpu_ ? static_cast<float>(times.gpu[p]) : 0.0f;
  row[passes_.size()] = static_cast<float>(times.gpuScene);
  gpuFrame_[next_] = static_cast<float>(times.gpuFrame);
  cpuFrame_[next_] = static_cast<float>(times.cpuFrame);
  next_ = (next_ + 1) % kFrames;
  size_ = std::min(size_ + 1, kFrames);
  if (++sinceWork_ >= 15 || size_ < 15) work();
}

void TimeLog::addUi(double milliseconds) {
  // What nobody fetches is bounded.
  if (ui_.size() >= 100000) ui_.erase(ui_.begin(), ui_.begin() + 50000);
  ui_.push_back(milliseconds);
}

std::vector<double> TimeLog::takeUi() {
  return std::exchange(ui_, {});
}

float TimeLog::gpu(size_t back, size_t pass) const {
  return gpu_[(next_ + kFrames - 1 - back) % kFrames * (passes_.size() + 1) + pass];
}

float TimeLog::gpuFrame(size_t back) const {
  return gpuFrame_[(next_ + kFrames - 1 - back) % kFrames];
}

float TimeLog::cpuFrame(size_t back) const {
  return cpuFrame_[(next_ + kFrames - 1 - back) % kFrames];
}

void TimeLog::work() {
  sinceWork_ = 0;
  const auto over = [&](auto value) {
    scratch_.clear();
    for (size_t back = 0; back < size_; ++back) scratch_.push_back(value(back));
    return figuresOf(scratch_);
  };
  for (size_t p = 0; p < passFigures_.size(); ++p) passFigures_[p] = over([&](size_t back) { return gpu(back, p); });
  gpuFigures_ = over([&](size_t back) { return gpuFrame(back); });
  cpuFigures_ = over([&](size_t back) { return cpuFrame(back); });
  scratch_.clear();
  for (size_t i = ui_.size() > kFrames ? ui_.size() - kFrames : 0; i < ui_.size(); ++i)
    scratch_.push_back(static_cast<float>(ui_[i]));
  uiFigures_ = figuresOf(scratch_);
  longest_ = std::max(gpuFigures_.p95 * 1.3f, 0.01f);
}

}  // namespace weir::view
