#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/execute/contexts.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <limits>
#include <span>
#include <type_traits>

namespace weir::execute {
namespace {

std::string hint(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearestName(name, known);
  return nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest);
}

}  // namespace

template <typename Base>
template <typename T>
T Answers<Base>::get(std::string_view param) const {
  const graph::CompiledPass& pass = runtime_.compiled();
  const auto found = pass.params.find(param);
  if (found == pass.params.end()) {
    std::vector<std::string> known;
    for (const auto& [name, value] : pass.params) known.push_back(name);
    throw InputError(fmt::format("{} ({}) asks for parameter '{}', which it doesn't declare{}", pass.name, pass.type,
                                 param, hint(std::string(param), known)));
  }
  if (!std::holds_alternative<T>(found->second)) {
    throw InputError(
        fmt::format("{} ({}) asks for parameter '{}' as another type than it declares", pass.name, pass.type, param));
  }
  // What a pass looked at while it prepared, its kernels may depend on.
  if constexpr (std::is_same_v<Base, PrepareContext>) runtime_.asked_.emplace(param);
  return std::get<T>(found->second);
}

template <typename Base>
bool Answers<Base>::connected(std::string_view input) const {
  const graph::CompiledPass& pass = runtime_.compiled();
  for (const graph::Binding& b : pass.inputs) {
    if (b.port == input) return b.resource != graph::kNone;
  }
  throw InputError(fmt::format("{} ({}) asks for input '{}', which it doesn't declare", pass.name, pass.type, input));
}

template <typename Base>
LightSummary Answers<Base>::lights() const {
  const graph::CompiledPass& pass = runtime_.compiled();
  if (!pass.description->has(Need::SceneLights)) {
    throw InputError(
        fmt::format("{} ({}) asks for the scene's lights but doesn't declare scene.lights", pass.name, pass.type));
  }
  const scene::SceneGpu& scene = runtime_.shared_.frame->scene();
  const scene::SceneTraits& traits = scene.traits;
  return {scene.lightCount, !traits.triangleLights && !traits.shapedLights && !traits.environment, scene.placedLights,
          !scene.prepared().movingLights.empty()};
}

template class Answers<PrepareContext>;
template class Answers<RecordContext>;

void Preparing::beforeKernels(const std::string& what) const {
  if (!runtime_.kernels_.empty()) {
    throw InputError(fmt::format("{}: {} must be declared before the first kernel", runtime_.compiled().name, what));
  }
}

void Preparing::scratch(const std::string& name, const PortType& type) {
  beforeKernels("scratch '" + name + "'");
  const graph::CompiledPass& pass = runtime_.compiled();
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{} ({}): scratch '{}' {}", pass.name, pass.type, name, what));
  };
  for (const Scratch& s : runtime_.interface_.scratch)
    if (s.name == name) fail("is declared twice");
  const bool image = type.kind == PortKind::Image;
  if (type.scaleNumerator == 0 || type.scaleDenominator == 0) fail("has a scale of nothing");
  if (!image && type.layout.stride == 0) fail("has a layout without fields");
  if (image && type.fixedCount != 0) fail("is an image with a count of elements");
  int64_t perPixel = type.perPixel;
  if (!type.perPixelFromParam.empty()) perPixel = integer(type.perPixelFromParam);
  if (!type.perPixelFromInput.empty()) {
    if (!connected(type.perPixelFromInput))
      fail(fmt::format("takes its count from the open input '{}'", type.perPixelFromInput));
    for (const graph::Binding& b : pass.inputs) {
      if (b.port == type.perPixelFromInput) perPixel = runtime_.shared_.graph->resources[b.resource].perPixel;
    }
  }
  if (perPixel < 1) fail(fmt::format("has {} elements a pixel", perPixel));
  const auto scaled = [&](uint32_t side) {
    return (uint64_t{side} * type.scaleNumerator + type.scaleDenominator - 1) / type.scaleDenominator;
  };
  const uint64_t w = scaled(width()), h = scaled(height());
  constexpr uint64_t kMostElements = std::numeric_limits<uint32_t>::max();  // shaders index with 32 bits
  if (w > kMostElements || h > kMostElements || w * h > kMostElements / static_cast<uint64_t>(perPixel))
    fail(fmt::format("would have {} x {} pixels with {} elements each", w, h, perPixel));
  const uint64_t elements = type.fixedCount > 0 ? type.fixedCount : w * h * static_cast<uint64_t>(perPixel);
  graph::Resource r;
  r.name = pass.name + " scratch " + name;
  r.type = type;
  r.width = type.fixedCount > 0 ? 0 : static_cast<uint32_t>(w);
  r.height = type.fixedCount > 0 ? 0 : static_cast<uint32_t>(h);
  r.perPixel = static_cast<uint32_t>(perPixel);
  r.elements = image ? 0 : elements;
  r.bytes = image ? w * h * formatBytes(type.format) : elements * type.layout.stride;
  runtime_.addScratch(std::move(r));
  runtime_.interface_.scratch.push_back({name, type, static_cast<uint32_t>(perPixel)});
}

void Preparing::texture(const std::string& name, TextureData data) {
  beforeKernels("texture '" + name + "'");
  const uint64_t texels = uint64_t{data.width} * data.height * std::max(1u, data.depth);
  if (data.rgba.size() != 4 * texels) {
    throw InputError(fmt::format("{}: texture '{}' has {} numbers, not {}", runtime_.compiled().name, name,
                                 data.rgba.size(), 4 * texels));
  }
  gpu::ImageDesc desc;
  desc.width = data.width;
  desc.height = data.height;
  desc.depth = std::max(1u, data.depth);
  desc.type = data.depth > 0 ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D;
  desc.format = VK_FORMAT_R32G32B32A32_SFLOAT;
  PassRuntime::OwnTexture own;
  own.image = gpu::uploadImage(runtime_.device(), desc, std::as_bytes(std::span(data.rgba)),
                               runtime_.compiled().name + " texture " + name);
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = data.linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  gpu::check(vkCreateSampler(runtime_.device().handle(), &info, nullptr, &own.sampler), "vkCreateSampler");
  runtime_.textures_.push_back(std::move(own));
  runtime_.interface_.textures.emplace_back(name, data.depth > 0);
}

void Preparing::lightTree() {
  beforeKernels("the light tree");
  const graph::CompiledPass& pass = runtime_.compiled();
  if (lights().moves)
    throw InputError(
        fmt::format("{} ({}) picks lights by place, but the clip moves lights of this scene", pass.name, pass.type));
  runtime_.shared_.frame->scene().lightTree();  // fails here, if at all
  runtime_.interface_.lightTree = true;
}

Kernel Preparing::kernel(const std::string& file, const KernelOptions& options) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(runtime_.device().physical(), &properties);
  const VkPhysicalDeviceLimits& limits = properties.limits;
  const uint32_t side = options.group.side;
  if (side == 0 || side > std::min(limits.maxComputeWorkGroupSize[0], limits.maxComputeWorkGroupSize[1]) ||
      side * side > limits.maxComputeWorkGroupInvocations) {
    throw InputError(fmt::format("{} ({}): kernel '{}' wants workgroups of {} x {}, and {} has at most {} invocations",
                                 runtime_.compiled().name, runtime_.compiled().type, file, side, side,
                                 properties.deviceName, limits.maxComputeWorkGroupInvocations));
  }
  return runtime_.addKernel(KernelKind::Compute, file, options);
}

Kernel Preparing::rayKernel(const std::string& file, const KernelOptions& options) {
  const graph::CompiledPass& pass = runtime_.compiled();
  if (!pass.description->has(Need::SceneAcceleration)) {
    throw InputError(fmt::format("{} ({}) traces rays but doesn't declare scene.acceleration", pass.name, pass.type));
  }
  if (runtime_.shared_.backend == trace::Backend::None) {
    throw InputError(
        fmt::format("{} ({}) traces rays, and {} can't: it has neither ray-tracing pipelines nor ray queries",
                    pass.name, pass.type, runtime_.device().info().name));
  }
  const bool pipeline = runtime_.shared_.backend == trace::Backend::Pipeline;
  return runtime_.addKernel(pipeline ? KernelKind::RayPipeline : KernelKind::RayQuery, file, options);
}

Kernel Preparing::rasterKernel(const std::string& file, const std::string& target, const KernelOptions& options) {
  const graph::CompiledPass& pass = runtime_.compiled();
  if (!pass.description->draws)
    throw InputError(fmt::format("{} ({}) rasterises but doesn't declare it", pass.name, pass.type));
  if (!runtime_.device().capabilities().graphics) {
    throw InputError(fmt::format("{} ({}) rasterises, and {} has no graphics queue", pass.name, pass.type,
                                 runtime_.device().info().name));
  }
  uint32_t index = graph::kNone;
  for (const Scratch& s : runtime_.interface_.scratch) {
    if (s.name == target && s.type.kind == PortKind::Image && s.type.format == Format::R32U)
      index = runtime_.slotNamed("scratch_" + target).resource;
  }
  if (index == graph::kNone) {
    throw InputError(fmt::format("{}: rasterKernel's target '{}' is no R32U scratch image", pass.name, target));
  }
  const graph::Resource& color = runtime_.shared_.graph->resources[index];
  graph::Resource depth;
  depth.name = fmt::format("{} depth of {}", pass.name, target);
  depth.type = storageImage(Format::R32F);
  depth.depth = true;
  depth.width = color.width;
  depth.height = color.height;
  depth.bytes = uint64_t{4} * color.width * color.height;
  const uint32_t depthIndex = runtime_.addScratch(std::move(depth));
  const Kernel kernel = runtime_.addKernel(KernelKind::Vertex, file, options);
  runtime_.kernels_[kernel.index].target = index;
  runtime_.kernels_[kernel.index].depth = depthIndex;
  return kernel;
}

const PassRuntime::PreparedKernel& Recording::kernelOf(Kernel kernel) const {
  if (kernel.index >= runtime_.kernels_.size()) {
    throw InputError(fmt::format("{} ({}) launches a kernel that it never prepared", runtime_.compiled().name,
                                 runtime_.compiled().type));
  }
  return runtime_.kernels_[kernel.index];
}

void Recording::barrier(VkPipelineStageFlags2 before, VkAccessFlags2 beforeAccess, VkPipelineStageFlags2 after,
                        VkAccessFlags2 afterAccess) {
  gpu::memoryBarrier(cursor_.commands, before, beforeAccess, after, afterAccess);
}

/// What all lanes of a launch share.
void Recording::begin(const PassRuntime::PreparedKernel& kernel, uint32_t w, uint32_t h, uint32_t index) {
  // Launches of one pass see what the ones before them wrote. Between the lanes of one launch there is nothing to wait
  // for, so that they run at the same time.
  if (!first_) {
    const VkPipelineStageFlags2 stages = vulkanStages(runtime_.stages_);
    barrier(stages, writeAccess(runtime_.stages_), stages,
            readAccess(runtime_.stages_) | writeAccess(runtime_.stages_));
  }
  first_ = false;
  vkCmdBindPipeline(cursor_.commands, kernel.pipeline->bindPoint(), kernel.pipeline->handle());
  std::vector<uint32_t>& push = runtime_.push_;
  push[0] = w;
  push[1] = h;
  push[2] = index;
  vkCmdPushConstants(cursor_.commands, runtime_.pipelineLayout_, VK_SHADER_STAGE_ALL, 0,
                     static_cast<uint32_t>(push.size() * 4), push.data());
}

void Recording::bindLane(const PassRuntime::PreparedKernel& kernel, uint32_t lane) const {
  const std::array sets = {cursor_.sceneSet,
                           kernel.sets[2 * (runtime_.bySlot_ ? cursor_.slot : lane) + cursor_.parity]};
  const uint32_t offset = cursor_.frameOffset + lane * SceneFrame::kLaneStride;
  vkCmdBindDescriptorSets(cursor_.commands, kernel.pipeline->bindPoint(), runtime_.pipelineLayout_, 0,
                          static_cast<uint32_t>(sets.size()), sets.data(), 1, &offset);
}

void Recording::launch(Kernel kernel, uint32_t launchWidth, uint32_t launchHeight, uint32_t index) {
  const PassRuntime::PreparedKernel& prepared = kernelOf(kernel);
  begin(prepared, launchWidth, launchHeight, index);
  for (uint32_t lane = 0; lane < cursor_.lanes; ++lane) {
    bindLane(prepared, lane);
    prepared.pipeline->launch(cursor_.commands, launchWidth, launchHeight);
  }
}

void Recording::draw(Kernel kernel) {
  const PassRuntime::PreparedKernel& prepared = kernelOf(kernel);
  if (prepared.target == graph::kNone)
    throw InputError(fmt::format("{} ({}) draws with a kernel that is no rasterKernel", runtime_.compiled().name,
                                 runtime_.compiled().type));
  const gpu::ImageDesc& target = runtime_.lanes_[0]->at(prepared.target, 0, false).image.desc();
  begin(prepared, target.width, target.height, 0);
  for (uint32_t lane = 0; lane < cursor_.lanes; ++lane) drawLane(prepared, lane);
}

void Recording::drawLane(const PassRuntime::PreparedKernel& kernel, uint32_t lane) const {
  const Resources& resources = *runtime_.lanes_[lane];
  const gpu::Image& target = resources.at(kernel.target, 0, false).image;
  const gpu::Image& depthBuffer = resources.at(kernel.depth, 0, false).image;
  const VkExtent2D extent{target.desc().width, target.desc().height};
  bindLane(kernel, lane);
  VkRenderingAttachmentInfo color{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  color.imageView = target.view();
  color.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  color.clearValue.color.uint32[0] = 0xffffffffu;
  VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  depth.imageView = depthBuffer.view();
  depth.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea.extent = extent;
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &color;
  rendering.pDepthAttachment = &depth;
  vkCmdBeginRendering(cursor_.commands, &rendering);
  const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(cursor_.commands, 0, 1, &viewport);
  vkCmdSetScissor(cursor_.commands, 0, 1, &scissor);
  const auto& draws = runtime_.shared_.frame->draws();
  for (uint32_t i = 0; i < draws.size(); ++i) {
    vkCmdSetCullMode(cursor_.commands, draws[i].doubleSided ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
    vkCmdSetFrontFace(cursor_.commands,
                      draws[i].flipsWinding ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
    if (draws[i].triangles > 0) vkCmdDraw(cursor_.commands, draws[i].triangles * 3, 1, 0, i);
  }
  vkCmdEndRendering(cursor_.commands);
}

}  // namespace weir::execute
