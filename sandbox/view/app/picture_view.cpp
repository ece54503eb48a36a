#include "view/app/picture_view.h"

#include <weir/core/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace weir::view {
namespace {

constexpr std::string_view kPrevious = "@previous";

std::string withoutPrevious(const std::string& port) {
  return port.ends_with(kPrevious) ? port.substr(0, port.size() - kPrevious.size()) : port;
}

/// The output that is meant for a screen; else one of radiance; else the first image.
std::string pictureOf(const graph::CompiledGraph& graph) {
  std::string best;
  int rank = -1;
  for (const graph::GraphOutput& output : graph.outputs) {
    const graph::Resource& resource = graph.resources[output.resource];
    if (!resource.isImage()) continue;
    const Meaning meaning = meaningOf(graph, resource);
    const int is = meaning == Meaning::Display ? 2 : meaning == Meaning::Radiance ? 1 : 0;
    if (is > rank) {
      rank = is;
      best = resource.name + (output.previous ? std::string(kPrevious) : std::string());
    }
  }
  return best;
}

PictureMode modeOf(const Channel& channel) {
  PictureMode mode;
  mode.low = channel.low;
  mode.high = channel.high;
  mode.logarithmic = channel.logarithmic;
  return mode;
}

const graph::Resource* find(const graph::CompiledGraph& graph, const std::string& port) {
  const auto at = std::ranges::find(graph.resources, withoutPrevious(port), &graph::Resource::name);
  return at == graph.resources.end() ? nullptr : &*at;
}

}  // namespace

PictureView::PictureView(const gpu::Device& device, shader::Compiler& compiler)
    : pictures_(device, compiler, kSlots), probe_(device, kSlots), meter_(device, compiler, kSlots) {}

std::string PictureView::radiancePort(const graph::CompiledGraph& graph) {
  for (const graph::GraphOutput& output : graph.outputs) {
    const graph::Resource& resource = graph.resources[output.resource];
    if (resource.isImage() && meaningOf(graph, resource) == Meaning::Radiance) return resource.name;
  }
  return {};
}

void PictureView::list() {
  const graph::CompiledGraph& graph = *graph_;
  a_.ports.clear();
  const auto add = [&](const std::string& name) {
    if (std::ranges::count(a_.ports, name) == 0) a_.ports.push_back(name);
  };
  for (const graph::GraphOutput& output : graph.outputs) add(graph.resources[output.resource].name);
  for (const graph::Resource& resource : graph.resources) {
    if (resource.scratch || resource.depth || resource.external) continue;
    add(resource.name);
    if (resource.history) add(resource.name + std::string(kPrevious));
  }
}

/// Whether the port is there, and is shown now.
bool PictureView::take(Engine& engine, const std::string& port) {
  if (port.empty() || find(engine.graph(), port) == nullptr) return false;
  engine.keep({withoutPrevious(port)});
  graph_ = &engine.graph();
  const graph::Resource* resource = find(*graph_, port);
  if (resource == nullptr) return false;
  const std::string channel = a_.channels.empty() ? "" : a_.channels[a_.channel].name;
  const bool same = port == a_.port;
  a_.port = port;
  a_.channels = channelsOf(*resource, meaningOf(*graph_, *resource), engine.stage().prepared.traits.f90);
  a_.extent = extentOf(*resource);
  a_.elements = std::max(resource->perPixel, 1u);
  a_.what = fmt::format("{}, {}x{}, {:.2f} MB", weir::describe(resource->type), a_.extent.width, a_.extent.height,
                        static_cast<double>(resource->bytes) * 1e-6);
  a_.problem.clear();
  const Channel* before = same ? findChannel(a_.channels, channel) : nullptr;
  a_.channel = before != nullptr ? static_cast<size_t>(before - a_.channels.data()) : 0;
  if (before == nullptr) resetMode();
  a_.mode.element = std::min(a_.mode.element, a_.elements - 1);
  return true;
}

void PictureView::follow(Engine& engine) {
  graph_ = &engine.graph();
  if (!take(engine, wanted_) && !take(engine, pictureOf(engine.graph()))) {
    a_ = {};
    a_.problem = "the graph has no picture among its outputs; choose a port";
  } else if (!wanted_.empty() && a_.port != wanted_) {
    a_.problem = fmt::format("'{}' is not there now", wanted_);
  }
  list();
}

void PictureView::show(Engine& engine, const std::string& port) {
  if (find(engine.graph(), port) == nullptr)
    throw InputError(fmt::format("there is no port '{}' now: its pass does not run", port));
  wanted_ = port;
  follow(engine);
}

void PictureView::setChannel(size_t channel) {
  if (channel >= a_.channels.size()) return;
  a_.channel = channel;
  resetMode();
}

void PictureView::setMode(const PictureMode& mode) {
  a_.mode = mode;
}

void PictureView::resetMode() {
  if (a_.channels.empty()) return;
  const uint32_t element = a_.mode.element;
  a_.mode = modeOf(a_.channels[a_.channel]);
  a_.mode.element = element;
  a_.measured.reset();
  if (a_.channels[a_.channel].guessed) measureWanted_ = true;
}

void PictureView::showNothingBeside() {
  kind_ = Beside::Nothing;
  besideName_.clear();
  uploaded_.reset();
  source_ = {};
  split = false;
}

void PictureView::showSecond(Engine& engine) {
  showNothingBeside();
  if (engine.second() == nullptr) return;
  kind_ = Beside::Second;
  besideName_ = engine.secondFile();
  split = true;
}

void PictureView::showPicture(const gpu::Device& device, const image::Picture& picture, const std::string& name) {
  auto uploaded = std::make_unique<UploadedPicture>(device, picture, name);
  showNothingBeside();
  uploaded_ = std::move(uploaded);
  besideChannels_ = channelsOf(uploaded_->resource(), Meaning::Radiance);
  kind_ = Beside::Picture;
  besideName_ = name;
  split = true;
}

void PictureView::showSource(Source source, const std::string& name) {
  showNothingBeside();
  source_ = std::move(source);
  besideChannels_.clear();
  kind_ = Beside::Source;
  besideName_ = name;
  split = true;
}

void PictureView::setZoom(float zoom) {
  fitted_ = zoom <= 0.0f;
  centredScale_ = zoom;
}

void PictureView::zoomAbout(glm::vec2 canvasPoint, float factor) {
  placement_ = zoomed(placement_, canvasPoint.x, canvasPoint.y, factor);
  fitted_ = false;
  centredScale_ = 0.0f;
}

void PictureView::move(glm::vec2 canvasPixels) {
  placement_.x += canvasPixels.x;
  placement_.y += canvasPixels.y;
  fitted_ = false;
  centredScale_ = 0.0f;
}

std::optional<PixelPlace> PictureView::pixelAt(glm::vec2 canvasPoint) const {
  if (a_.port.empty()) return std::nullopt;
  return view::pixelAt(placement_, a_.extent, static_cast<int32_t>(canvasPoint.x), static_cast<int32_t>(canvasPoint.y));
}

void PictureView::compose(VkCommandBuffer commands, uint32_t slot, const gpu::Image& canvas, const Rect& rect,
                          Engine& engine, std::optional<PixelPlace> probe) {
  collect(slot, engine.stage().prepared.lights);
  pictures_.begin(slot);
  if (fitted_) placement_ = fit(a_.extent, rect);
  if (!fitted_ && centredScale_ > 0.0f) {
    placement_ = centred(a_.extent, rect, centredScale_);
    centredScale_ = 0.0f;
  }
  Target target{{canvas.view(), canvas.desc().width, canvas.desc().height}, placement_, rect};
  const auto left = static_cast<uint32_t>(static_cast<float>(rect.width) * std::clamp(splitAt, 0.0f, 1.0f));
  const bool two = split && beside();
  if (two) target.clip.width = left;
  bool drawn = false;
  if (!a_.channels.empty() && engine.executor().runtime().recorded()) {
    const execute::Executor::Located at = engine.executor().locate(a_.port);
    const scene::Camera& camera = engine.lastInput().camera;
    const glm::uvec2 size = engine.size();
    const Shown shown{
        {*at.storage, *at.resource, execute::toGpu(camera, size.x, size.y), engine.stage().prepared.traits.f90},
        a_.channels[a_.channel]};
    pictures_.draw(commands, shown, a_.mode, target);
    drawn = true;
    if (measureWanted_) {
      meter_.record(commands, slot, shown, a_.mode.element);
      measureWanted_ = false;
      rangeWanted_ = true;
    }
    if (probe) probe_.record(commands, slot, shown, *probe);
  }
  if (!drawn) {
    // Nothing to show yet: the ground alone.
    const VkClearColorValue ground{{0.11f, 0.11f, 0.11f, 1.0f}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, canvas.handle(), VK_IMAGE_LAYOUT_GENERAL, &ground, 1, &all);
  }
  if (two)
    drawBeside(commands, canvas, {rect.x + static_cast<int32_t>(left), rect.y, rect.width - left, rect.height}, engine);
}

void PictureView::drawBeside(VkCommandBuffer commands, const gpu::Image& canvas, const Rect& clip, Engine& engine) {
  const execute::Storage* storage = nullptr;
  const graph::Resource* resource = nullptr;
  Meaning meaning = Meaning::Radiance;
  if (kind_ == Beside::Second && engine.second() != nullptr && engine.second()->runtime().recorded()) {
    execute::Executor& executor = *engine.second();
    const graph::Resource* same = find(executor.graph(), a_.port);
    const std::string port = same != nullptr && (same->graphOutput || same->kept || !same->transient())
                                 ? a_.port
                                 : pictureOf(executor.graph());
    if (port.empty()) return;
    const execute::Executor::Located at = executor.locate(port);
    storage = at.storage;
    resource = at.resource;
    meaning = meaningOf(executor.graph(), *resource);
  } else if (kind_ == Beside::Picture) {
    storage = &uploaded_->storage();
    resource = &uploaded_->resource();
  } else if (kind_ == Beside::Source && source_) {
    if (const auto at = source_()) {
      storage = at->storage;
      resource = at->resource;
    }
  }
  if (resource == nullptr) return;
  const auto type = std::tuple(resource->type.kind, resource->type.layout.hash, resource->type.format, meaning);
  if (besideChannels_.empty() || type != besideType_)
    besideChannels_ = channelsOf(*resource, meaning, engine.stage().prepared.traits.f90);
  besideType_ = type;
  if (besideChannels_.empty()) return;
  const Channel* channel = a_.channels.empty() ? nullptr : findChannel(besideChannels_, a_.channels[a_.channel].name);
  if (channel == nullptr) channel = besideChannels_.data();
  const scene::Camera& camera = engine.lastInput().camera;
  const glm::uvec2 size = engine.size();
  const Shown shown{{*storage, *resource, execute::toGpu(camera, size.x, size.y), engine.stage().prepared.traits.f90},
                    *channel};
  const Target target{{canvas.view(), canvas.desc().width, canvas.desc().height},
                      sameArea(placement_, a_.extent, extentOf(*resource)),
                      clip};
  PictureMode mode = a_.mode;
  mode.element = std::min(mode.element, std::max(resource->perPixel, 1u) - 1);
  pictures_.draw(commands, shown, mode, target);
}

void PictureView::collect(uint32_t slot, const std::vector<scene::GpuLight>& lights) {
  if (const Probed* probed = probe_.collect(slot)) words_ = wordsOf(*probed, lights);
  if (std::optional<Measurement> measured = meter_.collect(slot)) {
    if (!a_.channels.empty() && measured->channel == a_.channels[a_.channel].name && rangeWanted_) {
      const Range range = rangeFor(*measured, a_.channels[a_.channel], a_.mode);
      a_.mode.low = range.low;
      a_.mode.high = range.high;
      rangeWanted_ = false;
    }
    a_.measured = std::move(measured);
  }
}

}  // namespace weir::view
