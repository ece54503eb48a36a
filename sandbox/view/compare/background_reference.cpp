#include "view/compare/background_reference.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/graph/description.h>
#include <weir/graph/diagnostic.h>
#include <weir/render/reference_picture.h>
#include <weir/render/render.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <mutex>
#include <utility>

namespace weir::view {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// More would not change a float's worth: their number is a float on the device.
constexpr uint32_t kMostFrames = 1u << 24;

/// The accumulator's picture, whose alpha is each pixel's own error.
ReferencePicture makeReference(const HostCopy& copy, uint64_t view, uint32_t frames) {
  ReferencePicture r;
  r.picture = copy.picture();
  r.view = view;
  r.frames = frames;
  double sum = 0.0;
  uint64_t counted = 0;
  for (size_t i = 0; i < r.picture.rgba.size(); i += 4) {
    float* p = &r.picture.rgba[i];
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) && std::isfinite(p[3])) {
      sum += static_cast<double>(p[3]);
      ++counted;
    }
    p[3] = 1.0f;
  }
  r.nonFinite = r.picture.rgba.size() / 4 - counted;
  r.relMse = frames > 1 && counted > 0 ? sum / static_cast<double>(counted) : kNaN;
  return r;
}

}  // namespace

struct BackgroundReference::Slot {
  explicit Slot(const gpu::Device& d) : device(d), submission(std::make_unique<Submission>(d, "reference")) {
    if (d.capabilities().timestampPeriod <= 0) return;
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2;
    gpu::check(vkCreateQueryPool(d.handle(), &info, nullptr, &queries), "vkCreateQueryPool");
  }
  ~Slot() {
    submission.reset();  // waits for what uses the queries
    vkDestroyQueryPool(device.handle(), queries, nullptr);
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  const gpu::Device& device;
  std::unique_ptr<Submission> submission;
  VkQueryPool queries = VK_NULL_HANDLE;
  bool timed = false;  ///< the queries hold times that nobody has read
};

struct BackgroundReference::Host {
  std::mutex mutex;
  std::shared_ptr<const ReferencePicture> latest;
  std::string problem;
};

BackgroundReference::BackgroundReference(const ReferenceServices& services, const ReferenceGraph& graph,
                                         const execute::FrameInput& shown, uint32_t width, uint32_t height)
    : services_(services),
      graph_(graph),
      seed_(render::restartSeed(graph.shownSeed, ~0u)),
      width_(width),
      height_(height),
      ring_(services.device, 2),
      host_(std::make_shared<Host>()) {
  graph::CompiledGraph compiled = compile(width, height);
  for (std::unique_ptr<Slot>& slot : slots_) slot = std::make_unique<Slot>(services.device);
  accumulator_ = makeAccumulator(compiled);
  execute::ExecutorOptions options = services.options;
  options.lanes = 1;
  options.countRays = false;
  executor_ = std::make_unique<execute::Executor>(services.device, services.compiler, services.registry, services.scene,
                                                  std::move(compiled), options);
  keepShown(shown);
  startOver();
}

BackgroundReference::~BackgroundReference() {
  services_.device.waitIdle();  // somebody may show its image still
}

/// With the one output: what only others need does not run.
graph::CompiledGraph BackgroundReference::compile(uint32_t width, uint32_t height) const {
  render::requireSize(width, height);
  std::vector<graph::Diagnostic> diagnostics;
  graph::Description description = graph::load(graph_.file, diagnostics);
  graph::apply(description, graph_.overrides, diagnostics);
  const auto wanted = [&](const graph::OutputEntry& output) { return output.name == graph_.output; };
  if (std::ranges::any_of(description.outputs, wanted))
    std::erase_if(description.outputs, [&](const graph::OutputEntry& output) { return !wanted(output); });
  graph::CompiledGraph compiled = graph::compile(description, services_.registry.catalog(), width, height, diagnostics);
  if (!diagnostics.empty()) throw graph::GraphError(diagnostics);
  render::requirePicture(compiled, graph_.file, graph_.output);
  return compiled;
}

std::unique_ptr<Accumulator> BackgroundReference::makeAccumulator(const graph::CompiledGraph& graph) const {
  const graph::Resource& output = graph.resources[graph.findOutput(graph_.output)->resource];
  return std::make_unique<Accumulator>(services_.device, services_.compiler, output.width, output.height, kSlots);
}

void BackgroundReference::keepShown(const execute::FrameInput& shown) {
  std::optional<scene::SceneState> state;
  if (shown.state != nullptr) state = *shown.state;
  camera_ = shown.camera;
  state_ = std::move(state);
}

void BackgroundReference::startOver() {
  remembers_ = std::ranges::any_of(executor_->graph().resources, &graph::Resource::history);
  ++view_;
  frames_ = 0;
  nextCopy_ = 1;
}

/// Waits for everything that uses the accumulator: frames, copies to the host, and whoever shows its image.
void BackgroundReference::drain() {
  executor_->finish();
  services_.device.waitIdle();
}

void BackgroundReference::restart(const execute::FrameInput& shown, uint32_t width, uint32_t height) {
  if (width != width_ || height != height_) {
    graph::CompiledGraph compiled = compile(width, height);
    std::unique_ptr<Accumulator> accumulator = makeAccumulator(compiled);
    drain();
    executor_->swap(std::move(compiled));
    accumulator_ = std::move(accumulator);
    width_ = width;
    height_ = height;
    pacer_.forget();
  }
  keepShown(shown);
  startOver();
}

void BackgroundReference::reload() {
  graph::CompiledGraph compiled = compile(width_, height_);
  std::unique_ptr<Accumulator> accumulator = makeAccumulator(compiled);
  drain();
  executor_->restart(std::move(compiled));
  accumulator_ = std::move(accumulator);
  pacer_.forget();
  startOver();
}

void BackgroundReference::readTimes(Slot& slot) {
  if (!std::exchange(slot.timed, false)) return;
  std::array<uint64_t, 2> ticks{};
  gpu::check(vkGetQueryPoolResults(services_.device.handle(), slot.queries, 0, 2, sizeof ticks, ticks.data(), 8,
                                   VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
             "vkGetQueryPoolResults");
  addingMilliseconds_ =
      static_cast<double>(ticks[1] - ticks[0]) * services_.device.capabilities().timestampPeriod * 1e-6;
}

void BackgroundReference::submitFrame(uint32_t slotIndex) {
  Slot& slot = *slots_[slotIndex];
  execute::FrameInput input;
  input.camera = camera_;
  input.index = frames_;
  input.seed = seed_;
  input.state = state_ ? &*state_ : nullptr;
  // Frames that know the one before are not independent, and their mean would seem better known than it is.
  input.cut = frames_ == 0 || remembers_;
  executor_->frame(input);
  for (const execute::FrameTimes& times : executor_->takeTimes())
    if (times.gpuFrame > 0.0) pacer_.measured(times.gpuFrame + addingMilliseconds_);

  const graph::GraphOutput& output = *executor_->graph().findOutput(graph_.output);
  const std::string name = executor_->graph().resources[output.resource].name + (output.previous ? "@previous" : "");
  const execute::Storage& frame = *executor_->locate(name).storage;
  VkCommandBuffer commands = slot.submission->begin();
  if (slot.queries != VK_NULL_HANDLE) {
    vkCmdResetQueryPool(commands, slot.queries, 0, 2);
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot.queries, 0);
  }
  accumulator_->record(commands, slotIndex, frame, frames_ + 1);
  if (slot.queries != VK_NULL_HANDLE)
    vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot.queries, 1);
  slot.submission->submit();
  slot.timed = slot.queries != VK_NULL_HANDLE;
  ++frames_;
}

uint32_t BackgroundReference::step(double budgetMilliseconds) {
  const Clock::time_point start = Clock::now();
  pacer_.grant(budgetMilliseconds);
  uint32_t submitted = 0;
  while (frames_ < kMostFrames && pacer_.affords()) {
    // Frames of an earlier step that still run mean that the device is behind: it gets no more.
    const double left = submitted == 0 ? 0.0 : budgetMilliseconds - millisecondsSince(start);
    if (left < 0.0) break;
    Slot& slot = *slots_[nextSlot_];
    if (!slot.submission->done(std::chrono::nanoseconds(static_cast<int64_t>(left * 1e6)))) break;
    readTimes(slot);
    pacer_.spend();  // before it learns another price
    submitFrame(nextSlot_);
    nextSlot_ = (nextSlot_ + 1) % kSlots;
    ++submitted;
  }
  bringToHost();
  return submitted;
}

/// The rarer the better it is: a tenth more frames make no other picture.
void BackgroundReference::bringToHost() {
  for (const HostCopy& copy : ring_.take()) {
    worker_.post([copy, host = host_](const std::stop_token&) {
      std::shared_ptr<const ReferencePicture> made;
      std::string problem;
      try {
        made = std::make_shared<const ReferencePicture>(
            makeReference(copy, copy.number() >> 32, static_cast<uint32_t>(copy.number())));
      } catch (const std::exception& error) {  // no memory
        problem = error.what();
      }
      const std::lock_guard lock(host->mutex);
      if (made) std::swap(host->latest, made);
      host->problem = problem;
    });
  }
  if (frames_ < nextCopy_ || ring_.pending() || !worker_.idle()) return;
  if (!ring_.capture(accumulator_->mean(), view_ << 32 | frames_)) return;
  nextCopy_ = frames_ + std::max(frames_ / 10, 1u);
}

std::optional<execute::Executor::Located> BackgroundReference::image() const {
  if (frames_ == 0) return std::nullopt;
  return accumulator_->mean();
}

std::shared_ptr<const ReferencePicture> BackgroundReference::latest() const {
  const std::lock_guard lock(host_->mutex);
  return host_->latest && host_->latest->view == view_ ? host_->latest : nullptr;
}

std::string BackgroundReference::words() const {
  const std::string name = std::filesystem::path(graph_.file).filename().string();
  const std::shared_ptr<const ReferencePicture> now = latest();
  if (!now) return name + ": no frame yet";
  return fmt::format("{}: {}", name, qualityInWords(*now));
}

std::string BackgroundReference::warning() const {
  if (remembers_)
    return "the reference reuses earlier frames: each of its frames starts anew, and is as biased as that leaves it";
  const std::lock_guard lock(host_->mutex);
  return host_->problem;
}

uint64_t BackgroundReference::bytes() const {
  return executor_->transientBytes() + executor_->historyBytes() + executor_->motionBytes() + accumulator_->bytes();
}

}  // namespace weir::view
