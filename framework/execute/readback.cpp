// Getting pictures and raw bytes out of an executor, and (for tests) bytes into it.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/core/text.h>
#include <weir/execute/executor.h>
#include <weir/gpu/barrier.h>

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <span>
#include <utility>

namespace weir::execute {
namespace {

VkBufferImageCopy wholeImage(const gpu::Image& image) {
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {image.desc().width, image.desc().height, 1};
  return copy;
}

void unpackPixel(const std::byte* from, Format format, float* to) {
  to[0] = to[1] = to[2] = 0.0f;
  to[3] = 1.0f;
  switch (format) {
    case Format::R32F:
      std::memcpy(to, from, 4);
      to[1] = to[2] = to[0];
      break;
    case Format::RG32F:
      std::memcpy(to, from, 8);
      break;
    case Format::RGBA32F:
      std::memcpy(to, from, 16);
      break;
    case Format::RGBA16F:
      for (int c = 0; c < 4; ++c) {
        uint16_t half = 0;
        std::memcpy(&half, from + 2 * c, 2);
        to[c] = glm::unpackHalf1x16(half);
      }
      break;
    case Format::RGBA8:
      for (int c = 0; c < 4; ++c) to[c] = static_cast<float>(static_cast<uint8_t>(from[c])) / 255.0f;
      break;
    case Format::R32U: {
      uint32_t value = 0;
      std::memcpy(&value, from, 4);
      to[0] = to[1] = to[2] = static_cast<float>(value);
      break;
    }
  }
}

/// Pixels from `begin` to before `end`.
void unpackPart(std::span<const std::byte> bytes, Format format, image::Picture& picture, size_t begin, size_t end) {
  const uint32_t texel = formatBytes(format);
  if (format == Format::RGBA32F) {  // as it is
    std::memcpy(&picture.rgba[4 * begin], &bytes[begin * texel], (end - begin) * texel);
    return;
  }
  for (size_t i = begin; i < end; ++i) unpackPixel(&bytes[i * texel], format, &picture.rgba[4 * i]);
}

/// On several cores when it is the only picture: one takes as long to copy it as a GPU to make the next one.
void unpack(std::span<const std::byte> bytes, const graph::Resource& resource, image::Picture& picture,
            bool alone = false) {
  picture.width = resource.width;
  picture.height = resource.height;
  const size_t pixels = size_t{resource.width} * resource.height;
  picture.rgba.resize(4 * pixels);
  constexpr size_t kPiece = size_t{1} << 18;
  if (!alone || pixels <= kPiece) return unpackPart(bytes, resource.type.format, picture, 0, pixels);
  parallelFor((pixels + kPiece - 1) / kPiece, [&](size_t piece) {
    unpackPart(bytes, resource.type.format, picture, piece * kPiece, std::min(pixels, (piece + 1) * kPiece));
  });
}

}  // namespace

uint32_t Executor::resourceNamed(const std::string& name) const {
  std::vector<std::string> names;
  for (uint32_t i = 0; i < graph().resources.size(); ++i) {
    if (graph().resources[i].name == name) return i;
    names.push_back(graph().resources[i].name);
  }
  const std::string nearest = nearestName(name, names);
  throw InputError(fmt::format("no resource '{}' in graph '{}'{}", name, graph().name,
                               nearest.empty() ? "" : " (nearest: '" + nearest + "')"));
}

std::vector<std::byte> Executor::download(const Storage& storage) {
  if (storage.buffer) return gpu::readBuffer(device_, storage.buffer);
  const gpu::ImageDesc& desc = storage.image.desc();
  uint32_t texel = 4;
  for (Format f : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::R32U}) {
    if (vulkanFormat(f) == desc.format) texel = formatBytes(f);
  }
  const gpu::Buffer staging(device_, uint64_t{desc.width} * desc.height * texel, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            gpu::Residency::Readback, "readback");
  device_.submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    const VkBufferImageCopy copy = wholeImage(storage.image);
    vkCmdCopyImageToBuffer(commands, storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, staging.handle(), 1, &copy);
    gpu::fullBarrier(commands);
  });
  staging.invalidate();
  return {staging.mapped(), staging.mapped() + uint64_t{desc.width} * desc.height * texel};
}

const Storage& Executor::lastStorage(uint32_t resource, bool previous, uint32_t lane) const {
  if (lane >= scene_.active()) throw InputError(fmt::format("lane {}: the last frame has {}", lane, scene_.active()));
  const uint32_t parity = static_cast<uint32_t>((scene_.frames() + 1) & 1u);  // of the last frame
  return runtime_->resources(lane).at(resource, parity, previous);
}

void Executor::requireKept(const graph::Resource& r, const std::string& name) const {
  if (r.external) throw InputError(fmt::format("'{}' is the host's: ask the host for it", name));
  if (r.depth) throw InputError(fmt::format("'{}' is a depth buffer, which is not read back", name));
  if (r.transient() && r.shares && !r.graphOutput && !r.kept)
    throw InputError(fmt::format("'{}' is not kept to the frame's end: other resources use its memory", name));
  if (r.transient() && r.shares && !runtime_->recorded())
    throw InputError(fmt::format("'{}' can't be read before graph '{}' has run", name, graph().name));
}

std::vector<std::byte> Executor::readResource(const std::string& name, uint32_t lane) {
  finish();
  const uint32_t index = resourceNamed(name);
  requireKept(graph().resources[index], name);
  return download(lastStorage(index, false, lane));
}

Executor::Located Executor::locate(const std::string& name, uint32_t lane) const {
  constexpr std::string_view kPrevious = "@previous";
  const bool previous = name.ends_with(kPrevious);
  const std::string port = previous ? name.substr(0, name.size() - kPrevious.size()) : name;
  const uint32_t index = resourceNamed(port);
  const graph::Resource& resource = graph().resources[index];
  requireKept(resource, name);
  if (previous && !resource.history) throw InputError(fmt::format("'{}': nobody reads it, so it has no history", name));
  if (!runtime_->recorded())
    throw InputError(fmt::format("'{}' can't be read before graph '{}' has run", name, graph().name));
  return {&lastStorage(index, previous, lane), &resource};
}

void Executor::writeResource(const std::string& name, std::span<const std::byte> bytes) {
  finish();
  const uint32_t index = resourceNamed(name);
  const graph::Resource& resource = graph().resources[index];
  if (resource.external) throw InputError(fmt::format("'{}' is the host's: the host fills it", name));
  // Both copies: the frame to come reads this one as its own or as the one before it.
  for (uint32_t parity = 0; parity < 2; ++parity) {
    const Storage& storage = runtime_->resources().at(index, parity, false);
    const gpu::Buffer staging(device_, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Residency::Upload,
                              "upload");
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    staging.flush();
    device_.submitAndWait([&](VkCommandBuffer commands) {
      gpu::fullBarrier(commands);
      if (storage.buffer) {
        const VkBufferCopy copy{0, 0, std::min<uint64_t>(bytes.size(), storage.buffer.size())};
        vkCmdCopyBuffer(commands, staging.handle(), storage.buffer.handle(), 1, &copy);
      } else {
        const VkImageMemoryBarrier2 start = toGeneral(storage.image);
        VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        info.imageMemoryBarrierCount = 1;
        info.pImageMemoryBarriers = &start;
        vkCmdPipelineBarrier2(commands, &info);
        const VkBufferImageCopy copy = wholeImage(storage.image);
        vkCmdCopyBufferToImage(commands, staging.handle(), storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
      }
      gpu::fullBarrier(commands);
    });
  }
}

Meaning Executor::meaning(const std::string& output) const {
  const graph::GraphOutput* found = graph().findOutput(output);
  if (found == nullptr) throw InputError(fmt::format("graph '{}' has no output '{}'", graph().name, output));
  const graph::Resource& resource = graph().resources[found->resource];
  if (resource.producer == graph::kNone) return Meaning::Data;
  const graph::CompiledPass& pass = graph().passes[resource.producer];
  for (size_t i = 0; i < pass.outputs.size(); ++i) {
    if (pass.outputs[i].resource == found->resource) return pass.description->outputs[i].meaning;
  }
  return Meaning::Data;
}

const graph::GraphOutput& Executor::outputImage(const std::string& output) const {
  std::vector<std::string> names;
  for (const graph::GraphOutput& o : graph().outputs) names.push_back(o.name);
  const graph::GraphOutput* found = graph().findOutput(output);
  if (found == nullptr) {
    const std::string nearest = nearestName(output, names);
    throw InputError(fmt::format("graph '{}' has no output '{}'{}", graph().name, output,
                                 nearest.empty() ? "" : " (nearest: '" + nearest + "')"));
  }
  const graph::Resource& resource = graph().resources[found->resource];
  if (resource.type.kind != PortKind::Image) {
    throw InputError(fmt::format("output '{}' ({}) is a buffer of {}, not a picture", output, resource.name,
                                 resource.type.layout.name));
  }
  if (resource.external)
    throw InputError(fmt::format("output '{}' ({}) is the host's: ask the host for it", output, resource.name));
  return *found;
}

image::Picture Executor::read(const std::string& output, uint32_t lane) {
  const graph::GraphOutput& found = outputImage(output);
  if (!runtime_->recorded())
    throw InputError(fmt::format("output '{}' can't be read before graph '{}' has run", output, graph().name));
  finish();
  const std::vector<std::byte> bytes = download(lastStorage(found.resource, found.previous, lane));
  image::Picture picture;
  unpack(bytes, graph().resources[found.resource], picture);
  return picture;
}

void Executor::notFromSink(const char* what) const {
  if (delivering_) throw InputError(fmt::format("{} can't be called by what receives captured pictures", what));
}

void Executor::captureTo(const std::vector<std::string>& outputs, Sink sink) {
  if (!sink) return captureLanesTo(outputs, {});
  captureLanesTo(outputs, [each = std::move(sink)](const std::string& output, std::span<const image::Picture> lanes) {
    for (const image::Picture& picture : lanes) each(output, picture);
  });
}

void Executor::captureLanesTo(const std::vector<std::string>& outputs, LaneSink sink) {
  notFromSink("captureTo");
  if (!outputs.empty() && !sink) throw InputError("captured pictures need somebody to receive them");
  finish();
  // All of it first, so that a failure leaves everything as it was.
  std::vector<Captured> captured;
  std::array<std::vector<gpu::Buffer>, kSlots> buffers;
  for (const std::string& output : outputs) {
    const graph::GraphOutput& found = outputImage(output);
    captured.push_back({output, found.resource, found.previous, std::vector<image::Picture>(scene_.lanes())});
    for (std::vector<gpu::Buffer>& slot : buffers)
      for (uint32_t lane = 0; lane < scene_.lanes(); ++lane)
        slot.emplace_back(device_, graph().resources[found.resource].bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                          gpu::Residency::Readback, "captured " + output);
  }
  captured_ = std::move(captured);
  sink_ = std::move(sink);
  for (uint32_t s = 0; s < kSlots; ++s) slots_[s].captures = std::move(buffers[s]);
}

void Executor::recordCaptures(const Slot& slot, uint32_t parity) const {
  constexpr VkPipelineStageFlags2 kCopy = VK_PIPELINE_STAGE_2_COPY_BIT, kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  gpu::memoryBarrier(slot.commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCopy, VK_ACCESS_2_TRANSFER_READ_BIT);
  for (size_t i = 0; i < captured_.size(); ++i) {
    for (uint32_t lane = 0; lane < slot.captured; ++lane) {
      const gpu::Image& image =
          runtime_->resources(lane).at(captured_[i].resource, parity, captured_[i].previous).image;
      const VkBufferImageCopy copy = wholeImage(image);
      vkCmdCopyImageToBuffer(slot.commands, image.handle(), VK_IMAGE_LAYOUT_GENERAL,
                             slot.captures[i * scene_.lanes() + lane].handle(), 1, &copy);
    }
  }
  // The host reads the copies; the next frame overwrites the images.
  gpu::memoryBarrier(slot.commands, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT, kAll | VK_PIPELINE_STAGE_2_HOST_BIT,
                     VK_ACCESS_2_HOST_READ_BIT);
}

/// Hands over what a frame that is over has captured.
void Executor::deliver(Slot& slot) {
  const uint32_t lanes = std::exchange(slot.captured, 0);
  if (lanes == 0) return;
  struct Delivering {
    bool& flag;
    explicit Delivering(bool& f) : flag(f) { flag = true; }
    ~Delivering() { flag = false; }
  };
  const Delivering delivering(delivering_);
  for (size_t i = 0; i < captured_.size(); ++i) {
    const graph::Resource& resource = graph().resources[captured_[i].resource];
    const auto unpackLane = [&](size_t lane) {
      const gpu::Buffer& buffer = slot.captures[i * scene_.lanes() + lane];
      buffer.invalidate();
      unpack(std::span(buffer.mapped(), resource.bytes), resource, captured_[i].pictures[lane], lanes == 1);
    };
    parallelFor(lanes, std::cref(unpackLane));
    sink_(captured_[i].output, std::span(captured_[i].pictures).first(lanes));
  }
}

}  // namespace weir::execute
