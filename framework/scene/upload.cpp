#include <weir/core/error.h>
#include <weir/scene/light_tree.h>
#include <weir/scene/upload.h>
#include <weir/scene/upload_light_tree.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

namespace weir::scene {
namespace {

constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr uint32_t kMostSets = 64;  // executors over one scene at a time

float longestSide(const PreparedScene& prepared) {
  std::vector<float> ofRange;
  for (const TriangleRange& range : prepared.ranges) {
    float longest = 0.0f;
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      const auto& v = prepared.triangles[t].v;
      for (int k = 0; k < 3; ++k) {
        longest = std::max(longest, glm::distance(prepared.positions[v[k]], prepared.positions[v[(k + 1) % 3]]));
      }
    }
    ofRange.push_back(longest);
  }
  float longest = 0.0f;
  for (const PreparedInstance& instance : prepared.instances) {
    float squares = 0.0f;  // of all columns: no direction is stretched further
    for (int c = 0; c < 3; ++c) squares += glm::dot(glm::vec3(instance.toWorld[c]), glm::vec3(instance.toWorld[c]));
    const bool identity = instance.toWorld == glm::mat4(1.0f);
    longest = std::max(longest, ofRange[instance.range] * (identity ? 1.0f : std::sqrt(squares)));
  }
  return longest;
}

/// First triangle, number of entries, entries; nothing where no triangle is a light.
std::vector<uint32_t> packLightOfTriangle(const PreparedScene& prepared) {
  if (prepared.lightOfTriangle.empty()) return {};
  std::vector<uint32_t> words{prepared.firstLitTriangle, static_cast<uint32_t>(prepared.lightOfTriangle.size())};
  words.insert(words.end(), prepared.lightOfTriangle.begin(), prepared.lightOfTriangle.end());
  return words;
}

}  // namespace

std::vector<GpuInstance> packInstances(const PreparedScene& prepared, std::vector<SceneGpu::Draw>& draws) {
  std::vector<GpuInstance> result;
  uint32_t first = 0;
  for (const PreparedInstance& source : prepared.instances) {
    const TriangleRange& range = prepared.ranges[source.range];
    GpuInstance g;
    for (int c = 0; c < 4; ++c) g.columns[c] = source.toWorld[c];
    g.firstTriangle = range.first;
    g.opaqueTriangles = range.opaque;
    g.flipsWinding = source.flipsWinding ? 1 : 0;
    g.firstDrawn = first;
    draws.push_back({range.opaque + range.masked, range.doubleSided, source.flipsWinding});
    first += draws.back().triangles;
    result.push_back(g);
  }
  return result;
}

float diameterOf(const Bounds& bounds) {
  return std::max(2.0f * bounds.radius(), glm::length(bounds.centre()) * 0x1p-20f);
}

SceneGpu::SceneGpu(const gpu::Device& device, const Scene& scene, const PreparedScene& prepared, bool withAcceleration)
    : device_(&device), scene_(&scene), prepared_(&prepared), withAcceleration_(withAcceleration) {
  const VkBufferUsageFlags build = withAcceleration
                                       ? VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                                             VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT
                                       : 0;
  positions_ = gpu::uploadBuffer(device, prepared.positions, kStorage | build, "scene positions");
  vertices_ = gpu::uploadBuffer(device, prepared.vertices, kStorage, "scene vertices");
  triangles_ = gpu::uploadBuffer(device, prepared.triangles, kStorage, "scene triangles");
  instances_ = gpu::uploadBuffer(device, packInstances(prepared, draws), kStorage, "scene instances");
  materials_ = gpu::uploadBuffer(device, prepared.materials, kStorage, "scene materials");
  lights_ = gpu::uploadBuffer(device, prepared.lights, kStorage, "scene lights");
  alias_ = gpu::uploadBuffer(device, prepared.aliasTable, kStorage, "scene alias table");
  lightOfTriangle_ = gpu::uploadBuffer(device, packLightOfTriangle(prepared), kStorage, "scene lights of triangles");
  colors_ = gpu::uploadBuffer(device, prepared.colors, kStorage, "scene vertex colours");
  uvs1_ = gpu::uploadBuffer(device, prepared.uvs1, kStorage, "scene texture coordinates 1");
  speculars_ = gpu::uploadBuffer(device, prepared.speculars, kStorage, "scene specular materials");
  specularAlbedo_ = gpu::uploadBuffer(device, prepared.specularAlbedo, kStorage, "scene specular albedo");
  uploadTextures(scene, prepared);
  if (prepared.traits.environment) environment_ = EnvironmentGpu(device, scene.environment, prepared.environment);
  const auto start = std::chrono::steady_clock::now();
  if (withAcceleration) acceleration_ = trace::Acceleration(device, prepared, positions_);
  accelerationSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  traits = prepared.traits;
  makeLayout();

  lightCount = static_cast<uint32_t>(prepared.lights.size());
  placedLights = static_cast<uint32_t>(std::ranges::count_if(prepared.lights, hasPlace));
  instanceCount = static_cast<uint32_t>(prepared.instances.size());
  largestSide = longestSide(prepared);
  Bounds bounds = prepared.bounds;
  for (const PunctualLight& light : scene.lights) {
    if (light.kind != LightKind::Directional) bounds.add(light.position);
  }
  diameter = diameterOf(bounds);
}

SceneGpu::~SceneGpu() {
  for (const auto& [texture, sampler] : samplers_) vkDestroySampler(device_->handle(), sampler, nullptr);
  vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
  vkDestroyDescriptorSetLayout(device_->handle(), layout_, nullptr);
}

void SceneGpu::updateLights(const PreparedScene& prepared) {
  if (prepared.lights.size() != lightCount)
    throw InputError("lights can be moved and coloured, but none can come or go");
  if (lightCount == 0) return;
  const gpu::Buffer lights = gpu::uploadBuffer(*device_, prepared.lights, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "lights"),
                    alias = gpu::uploadBuffer(*device_, prepared.aliasTable, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "alias");
  device_->submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    const VkBufferCopy lightBytes{0, 0, prepared.lights.size() * sizeof(GpuLight)};
    vkCmdCopyBuffer(commands, lights.handle(), lights_.handle(), 1, &lightBytes);
    const VkBufferCopy aliasBytes{0, 0, prepared.aliasTable.size() * sizeof(AliasCell)};
    vkCmdCopyBuffer(commands, alias.handle(), alias_.handle(), 1, &aliasBytes);
    gpu::fullBarrier(commands);
  });
  const std::lock_guard lock(treeMutex_);
  if (lightTree_) lightTree_->update(*device_, prepared);
}

const LightTreeGpu& SceneGpu::lightTree() const {
  const std::lock_guard lock(treeMutex_);
  if (!lightTree_) lightTree_ = std::make_unique<LightTreeGpu>(*device_, *prepared_);
  return *lightTree_;
}

uint64_t SceneGpu::bytes() const {
  uint64_t sum = acceleration_.bytes() + environment_.bytes();
  {
    const std::lock_guard lock(treeMutex_);
    if (lightTree_) sum += lightTree_->bytes();
  }
  for (const gpu::Buffer* b : {&positions_, &vertices_, &triangles_, &instances_, &materials_, &lights_, &alias_,
                               &lightOfTriangle_, &colors_, &uvs1_, &speculars_, &textureUses_, &specularAlbedo_}) {
    sum += b->size();
  }
  for (const gpu::Image& image : images_) sum += image.bytes();
  return sum;
}

void SceneGpu::makeLayout() {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  auto bind = [&](uint32_t binding, VkDescriptorType type, uint32_t count) {
    bindings.push_back({binding, type, count, VK_SHADER_STAGE_ALL, nullptr});
  };
  bind(kBindFrame, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1);
  for (uint32_t b = kBindPositions; b <= kBindRays; ++b) bind(b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1);
  if (withAcceleration_) bind(kBindAcceleration, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1);
  if (environment_) {
    bind(kBindEnvironment, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1);
    bind(kBindEnvironmentMap, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1);
  }
  if (traits.animated) {
    for (uint32_t b = kBindPreviousPositions; b <= kBindPreviousLights; ++b)
      bind(b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1);
    if (withAcceleration_) bind(kBindPreviousAcceleration, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1);
  }
  bind(kBindTextures, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, textureCount());
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.bindingCount = static_cast<uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(device_->handle(), &info, nullptr, &layout_), "vkCreateDescriptorSetLayout");

  std::vector<VkDescriptorPoolSize> sizes = {
      {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, kMostSets},
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kMostSets * (kBindRays - kBindPositions + 5)},
      {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kMostSets * (textureCount() + 1)}};
  if (withAcceleration_) sizes.push_back({VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 2 * kMostSets});
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool.maxSets = kMostSets;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  gpu::check(vkCreateDescriptorPool(device_->handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");
}

VkDescriptorSet SceneGpu::makeSet(const gpu::Buffer& frameConstants, uint64_t slotBytes, const gpu::Buffer& rayCounter,
                                  const MovingBindings* moving) const {
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout_;
  VkDescriptorSet set = VK_NULL_HANDLE;
  gpu::check(vkAllocateDescriptorSets(device_->handle(), &allocate, &set), "vkAllocateDescriptorSets");

  const VkDescriptorBufferInfo frame{frameConstants.handle(), 0, slotBytes};
  constexpr uint32_t kOwn = kBindRays - kBindPositions + 1;
  std::array<VkBuffer, kOwn + 3> handles = {
      positions_.handle(), vertices_.handle(),    triangles_.handle(),       instances_.handle(), materials_.handle(),
      lights_.handle(),    alias_.handle(),       lightOfTriangle_.handle(), colors_.handle(),    uvs1_.handle(),
      speculars_.handle(), textureUses_.handle(), specularAlbedo_.handle(),  rayCounter.handle()};
  VkAccelerationStructureKHR top = acceleration_.top();
  uint32_t count = kOwn;
  if (moving != nullptr) {
    handles[0] = moving->positions;
    handles[1] = moving->vertices;
    handles[3] = moving->instances;
    handles[5] = moving->lights;
    handles[6] = moving->alias;
    handles[kOwn] = moving->previousPositions;
    handles[kOwn + 1] = moving->previousInstances;
    handles[kOwn + 2] = moving->previousLights;
    top = moving->top;
    count = kOwn + 3;
  }
  std::array<VkDescriptorBufferInfo, handles.size()> buffers{};
  std::vector<VkWriteDescriptorSet> writes;
  auto write = [&](uint32_t binding, VkDescriptorType type, uint32_t many) -> VkWriteDescriptorSet& {
    VkWriteDescriptorSet w{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    w.dstSet = set;
    w.dstBinding = binding;
    w.descriptorType = type;
    w.descriptorCount = many;
    writes.push_back(w);
    return writes.back();
  };
  write(kBindFrame, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1).pBufferInfo = &frame;
  for (uint32_t i = 0; i < count; ++i) {
    buffers[i] = {handles[i], 0, VK_WHOLE_SIZE};
    const uint32_t binding = i < kOwn ? kBindPositions + i : kBindPreviousPositions + i - kOwn;
    write(binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1).pBufferInfo = &buffers[i];
  }
  VkWriteDescriptorSetAccelerationStructureKHR acceleration{
      VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR};
  acceleration.accelerationStructureCount = 1;
  acceleration.pAccelerationStructures = &top;
  VkWriteDescriptorSetAccelerationStructureKHR previous = acceleration;
  if (moving != nullptr) previous.pAccelerationStructures = &moving->previousTop;
  if (withAcceleration_ && moving != nullptr)
    write(kBindPreviousAcceleration, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1).pNext = &previous;
  if (withAcceleration_)
    write(kBindAcceleration, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1).pNext = &acceleration;
  const VkDescriptorBufferInfo environmentTable{environment_.table(), 0, VK_WHOLE_SIZE};
  const VkDescriptorImageInfo environmentMap = environment_.map();
  if (environment_) {
    write(kBindEnvironment, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1).pBufferInfo = &environmentTable;
    write(kBindEnvironmentMap, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1).pImageInfo = &environmentMap;
  }
  std::vector<VkDescriptorImageInfo> images;
  for (const Texture& t : textures_) {
    images.push_back({t.sampler, images_[t.image].view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
  }
  write(kBindTextures, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, textureCount()).pImageInfo = images.data();
  vkUpdateDescriptorSets(device_->handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
  return set;
}

void SceneGpu::freeSet(VkDescriptorSet set) const {
  if (set != VK_NULL_HANDLE) vkFreeDescriptorSets(device_->handle(), pool_, 1, &set);
}

}  // namespace weir::scene
