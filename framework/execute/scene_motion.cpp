#include <weir/core/paths.h>
#include <weir/execute/scene_motion.h>
#include <weir/gpu/barrier.h>
#include <weir/scene/gather_lights.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace weir::execute {
namespace {

constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr VkBufferUsageFlags kWritten = kStorage | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
constexpr VkBufferUsageFlags kRead = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;  // by tests

/// As shaders/common/deform.glsl reads it.
struct DeformPush {
  uint32_t flatNormals = 0, count = 0;
  uint32_t firstVertex = 0, influencesPerVertex = 0, firstInfluence = 0, firstJoint = 0;
  uint32_t targets = 0, firstWeight = 0, kinds = 0, firstDelta = 0, firstFlat = 0;
  float side = 1.0f;
};
constexpr uint32_t kDeformGroup = 64, kMostGroups = 65535;

}  // namespace

SceneMotion::SceneMotion(const gpu::Device& device, shader::Compiler& compiler, const scene::SceneGpu& scene,
                         bool tableOnDevice)
    : device_(device),
      scene_(scene),
      prepared_(scene.prepared()),
      tableOnDevice_(tableOnDevice && LightTable::supported(device)) {
  state_ = scene::StateMaker(scene.source(), prepared_).at(scene::restPose(scene.source()), false);
  packed_ = scene::packInstances(prepared_, draws_);
  topInstances_.resize(packed_.size());
  layOut();
  staging_ = gpu::Buffer(device, kSlots * slotBytes_, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Residency::Upload,
                         "scene motion staging");
  for (uint32_t h = 0; h < 2; ++h)
    instances_[h] = gpu::Buffer(device, instancesPart_.size, kWritten, gpu::Residency::Device, "moving instances");
  makeLights(compiler);
  const bool traces = scene.hasAcceleration();
  std::array<VkDeviceAddress, 2> addresses{};
  if (prepared_.traits.deforms) {
    const VkBufferUsageFlags build = traces ? trace::kBuildInput : 0;
    for (uint32_t h = 0; h < 2; ++h) {
      positions_[h] = gpu::uploadBuffer(device, prepared_.positions, kStorage | build, "deformed positions");
      addresses[h] = positions_[h].address();
    }
    vertices_ = gpu::uploadBuffer(device, prepared_.vertices, kStorage, "deformed vertices");
    influences_ = gpu::uploadBuffer(device, prepared_.influences, kStorage, "influences");
    deltas_ = gpu::uploadBuffer(device, prepared_.morphDeltas, kStorage, "morph targets");
    flat_ = gpu::uploadBuffer(device, prepared_.flatTriangles, kStorage, "triangles without normals");
    joints_ = gpu::Buffer(device, jointsPart_.size, kWritten, gpu::Residency::Device, "joint matrices");
    weights_ = gpu::Buffer(device, weightsPart_.size, kWritten, gpu::Residency::Device, "morph weights");
    makeKernel(compiler);
  }
  if (traces) acceleration_.emplace(device, prepared_, scene.acceleration(), addresses);
}

SceneMotion::~SceneMotion() {
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  vkDestroyPipelineLayout(device_.handle(), pipelineLayout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), setLayout_, nullptr);
}

void SceneMotion::layOut() {
  const auto part = [&](uint64_t size) {
    const Part p{slotBytes_, size};
    slotBytes_ += (size + 15) / 16 * 16;
    return p;
  };
  instancesPart_ = part(packed_.size() * sizeof(scene::GpuInstance));
  if (!prepared_.movingLights.empty()) {
    lightsPart_ = part(prepared_.lights.size() * sizeof(scene::GpuLight));
    if (prepared_.lightPowerChanges()) {
      if (tableOnDevice_)
        powersPart_ = part(prepared_.lights.size() * sizeof(float));
      else
        aliasPart_ = part(prepared_.lights.size() * sizeof(scene::AliasCell));
    }
  }
  jointsPart_ = part(state_.joints.size() * sizeof(glm::mat4));
  weightsPart_ = part(state_.weights.size() * sizeof(float));
  if (scene_.hasAcceleration())
    for (Part& p : topPart_) p = part(packed_.size() * sizeof(VkAccelerationStructureInstanceKHR));
}

void SceneMotion::makeLights(shader::Compiler& compiler) {
  if (lightsPart_.size == 0) return;
  for (gpu::Buffer& lights : lights_)
    lights = gpu::Buffer(device_, lightsPart_.size, kWritten | kRead, gpu::Residency::Device, "moving lights");
  if (!prepared_.lightPowerChanges()) return;
  const auto count = static_cast<uint32_t>(prepared_.lights.size());
  alias_ = gpu::Buffer(device_, count * sizeof(scene::AliasCell), kWritten | kRead, gpu::Residency::Device,
                       "moving lights' alias table");
  if (powersPart_.size == 0) return;
  powers_ = gpu::Buffer(device_, powersPart_.size, kWritten, gpu::Residency::Device, "moving lights' powers");
  constexpr uint32_t kStride = sizeof(scene::GpuLight) / sizeof(float), kPdf = offsetof(scene::GpuLight, pdf) / 4;
  table_.emplace(
      device_, compiler, count, powers_.handle(), alias_.handle(),
      std::vector<LightProbabilities>{{lights_[0].handle(), kStride, kPdf}, {lights_[1].handle(), kStride, kPdf}});
}

void SceneMotion::makeKernel(shader::Compiler& compiler) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t b = 0; b < 9; ++b)
    bindings.push_back({b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  layout.bindingCount = static_cast<uint32_t>(bindings.size());
  layout.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(device_.handle(), &layout, nullptr, &setLayout_),
             "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(DeformPush)};
  VkPipelineLayoutCreateInfo pipeline{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  pipeline.setLayoutCount = 1;
  pipeline.pSetLayouts = &setLayout_;
  pipeline.pushConstantRangeCount = 1;
  pipeline.pPushConstantRanges = &range;
  gpu::check(vkCreatePipelineLayout(device_.handle(), &pipeline, nullptr, &pipelineLayout_), "vkCreatePipelineLayout");
  shader::CompileRequest request;
  request.name = "deform.glsl";
  request.source = "#version 460\n#include \"deform.glsl\"\n";
  request.stage = shader::Stage::Compute;
  request.includeFolders.push_back(commonShaderFolder().string());
  kernel_ = Pipeline::compute(device_, pipelineLayout_, compiler.compile(request).spirv, {}, 8, "deform");

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 18};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 2;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  gpu::check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  const std::array layouts = {setLayout_, setLayout_};
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 2;
  allocate.pSetLayouts = layouts.data();
  gpu::check(vkAllocateDescriptorSets(device_.handle(), &allocate, sets_.data()), "vkAllocateDescriptorSets");
  for (uint32_t h = 0; h < 2; ++h) {
    const std::array buffers = {scene_.positions(), scene_.vertices(),      influences_.handle(),
                                deltas_.handle(),   joints_.handle(),       weights_.handle(),
                                flat_.handle(),     positions_[h].handle(), vertices_.handle()};
    std::array<VkDescriptorBufferInfo, 9> infos{};
    std::array<VkWriteDescriptorSet, 9> writes{};
    for (uint32_t b = 0; b < 9; ++b) {
      infos[b] = {buffers[b], 0, VK_WHOLE_SIZE};
      writes[b].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      writes[b].dstSet = sets_[h];
      writes[b].dstBinding = b;
      writes[b].descriptorCount = 1;
      writes[b].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      writes[b].pBufferInfo = &infos[b];
    }
    vkUpdateDescriptorSets(device_.handle(), 9, writes.data(), 0, nullptr);
  }
}

scene::MovingBindings SceneMotion::bindings(uint32_t half) const {
  const uint32_t past = 1 - half;
  const bool deforms = prepared_.traits.deforms, lit = lightsPart_.size > 0;
  scene::MovingBindings b;
  b.positions = deforms ? positions_[half].handle() : scene_.positions();
  b.previousPositions = deforms ? positions_[past].handle() : scene_.positions();
  b.vertices = deforms ? vertices_.handle() : scene_.vertices();
  b.instances = instances_[half].handle();
  b.previousInstances = instances_[past].handle();
  b.lights = lit ? lights_[half].handle() : scene_.lights();
  b.previousLights = lit ? lights_[past].handle() : scene_.lights();
  b.alias = alias_ ? alias_.handle() : scene_.alias();
  if (acceleration_) {
    b.top = acceleration_->top(half);
    b.previousTop = acceleration_->top(past);
  }
  return b;
}

template <typename T>
void SceneMotion::stage(uint32_t slot, const Part& part, const std::vector<T>& values) {
  if (part.size > 0) std::memcpy(staging_.mapped() + slot * slotBytes_ + part.offset, values.data(), part.size);
}

void SceneMotion::copy(VkCommandBuffer commands, uint32_t slot, const Part& part, VkBuffer to) const {
  if (part.size == 0) return;
  const VkBufferCopy region{slot * slotBytes_ + part.offset, 0, part.size};
  vkCmdCopyBuffer(commands, staging_.handle(), to, 1, &region);
}

void SceneMotion::upload(VkCommandBuffer commands, uint32_t slot, uint32_t half, bool fresh) {
  for (size_t i = 0; i < packed_.size(); ++i) {
    for (int c = 0; c < 4; ++c) packed_[i].columns[c] = state_.toWorld[i][c];
    packed_[i].flipsWinding = state_.flipsWinding[i] != 0 ? 1 : 0;
    draws_[i].flipsWinding = state_.flipsWinding[i] != 0;
  }
  stage(slot, instancesPart_, packed_);
  if (powersPart_.size > 0) {
    // Any common factor will do, and this one keeps them within what floats hold.
    const double largest = std::ranges::max(state_.power);
    relativePowers_.resize(state_.power.size());
    for (size_t i = 0; i < state_.power.size(); ++i)
      relativePowers_[i] = largest > 0.0 ? static_cast<float>(state_.power[i] / largest) : 0.0f;
    stage(slot, powersPart_, relativePowers_);
  }
  if (aliasPart_.size > 0 && state_.aliasTable.empty())
    state_.aliasTable = scene::buildLightTable(state_.power, state_.lights);
  stage(slot, lightsPart_, state_.lights);
  stage(slot, aliasPart_, state_.aliasTable);
  stage(slot, jointsPart_, state_.joints);
  stage(slot, weightsPart_, state_.weights);
  for (uint32_t h = 0; h < 2; ++h) {
    if (!acceleration_ || (h != half && !fresh)) continue;
    acceleration_->packInstances(state_, h, topInstances_);
    stage(slot, topPart_[h], topInstances_);
  }
  staging_.flush();

  for (uint32_t h = 0; h < 2; ++h) {
    if (h != half && !fresh) continue;
    copy(commands, slot, instancesPart_, instances_[h].handle());
    copy(commands, slot, lightsPart_, lights_[h].handle());
    if (acceleration_) copy(commands, slot, topPart_[h], acceleration_->instances(h));
  }
  copy(commands, slot, aliasPart_, alias_.handle());
  copy(commands, slot, powersPart_, powers_.handle());
  copy(commands, slot, jointsPart_, joints_.handle());
  copy(commands, slot, weightsPart_, weights_.handle());
}

/// Beside the deformation: neither waits for the other.
void SceneMotion::tabulate(VkCommandBuffer commands, uint32_t half, bool fresh) const {
  if (!table_) return;
  table_->record(commands, half);
  if (!fresh) return;
  // The past has the same probabilities.
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                     VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                     VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT);
  table_->record(commands, 1 - half);
}

void SceneMotion::deform(VkCommandBuffer commands, uint32_t half) const {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel_.handle());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelineLayout_, 0, 1, &sets_[half], 0, nullptr);
  const auto launch = [&](DeformPush push, bool flatNormals, uint32_t count) {
    if (count == 0) return;
    push.flatNormals = flatNormals ? 1 : 0;
    push.count = count;
    vkCmdPushConstants(commands, pipelineLayout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    const uint32_t groups = (count + kDeformGroup - 1) / kDeformGroup, rows = (groups + kMostGroups - 1) / kMostGroups;
    vkCmdDispatch(commands, std::min(groups, kMostGroups), rows, 1);
  };
  const auto pushOf = [](const scene::Deformation& d) {
    return DeformPush{0,
                      0,
                      d.firstVertex,
                      d.influencesPerVertex,
                      d.firstInfluence,
                      d.firstJoint,
                      d.targets,
                      d.firstWeight,
                      d.kinds,
                      d.firstDelta,
                      d.firstFlat,
                      d.mirrors ? -1.0f : 1.0f};
  };
  for (const scene::Deformation& d : prepared_.deformations) launch(pushOf(d), false, d.vertices);
  if (prepared_.flatTriangles.empty()) return;
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                     VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT);
  for (const scene::Deformation& d : prepared_.deformations) launch(pushOf(d), true, d.flats);
}

void SceneMotion::record(VkCommandBuffer commands, uint32_t slot, uint32_t half, const scene::SceneState* state,
                         bool fresh) {
  previousDiameter_ = scene::diameterOf(state_.bounds);
  previousLargestSide_ = state_.largestSide;
  if (state != nullptr) state_ = *state;
  if (fresh) {
    previousDiameter_ = 0.0f;
    previousLargestSide_ = 0.0f;
  }
  const VkAccessFlags2 any = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, any);
  upload(commands, slot, half, fresh);
  const VkPipelineStageFlags2 build =
      acceleration_ ? VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR : VkPipelineStageFlags2{0};
  const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, compute | build,
                     VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT);
  tabulate(commands, half, fresh);
  for (uint32_t h = 0; h < 2; ++h) {
    if (prepared_.traits.deforms && (h == half || fresh)) deform(commands, h);
    // Both halves write the normals, alike.
    if (prepared_.traits.deforms && fresh && h == 0)
      gpu::memoryBarrier(commands, compute, VK_ACCESS_2_SHADER_WRITE_BIT, compute, VK_ACCESS_2_SHADER_WRITE_BIT);
  }
  if (acceleration_) {
    gpu::memoryBarrier(commands, compute, VK_ACCESS_2_SHADER_WRITE_BIT, build, VK_ACCESS_2_SHADER_READ_BIT);
    for (uint32_t h = 0; h < 2; ++h)
      if (h == half || fresh) acceleration_->record(commands, h, fresh);
  }
  VkAccessFlags2 written = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
  if (acceleration_) written |= VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT | compute | build, written,
                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT);
}

float SceneMotion::diameter() const {
  return std::max({scene_.diameter, previousDiameter_, scene::diameterOf(state_.bounds)});
}

float SceneMotion::largestSide() const {
  return std::max(previousLargestSide_, state_.largestSide);
}

uint64_t SceneMotion::bytes() const {
  uint64_t sum = acceleration_ ? acceleration_->bytes() : 0;
  for (uint32_t h = 0; h < 2; ++h) sum += instances_[h].size() + lights_[h].size() + positions_[h].size();
  if (table_) sum += table_->bytes();
  for (const gpu::Buffer* b :
       {&alias_, &powers_, &vertices_, &influences_, &deltas_, &flat_, &joints_, &weights_, &staging_})
    sum += b->size();
  return sum;
}

}  // namespace weir::execute
