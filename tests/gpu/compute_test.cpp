// A shader compiled in process, run through bare Vulkan, its result checked; and what the validation layer sees of it.
#include <gtest/gtest.h>
#include <weir/gpu/memory.h>
#include <weir/shader/compiler.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "support/device.h"

namespace weir::gpu {
namespace {

/// One storage buffer at set 0, binding 0, and a push constant of 4 bytes.
class Kernel {
 public:
  Kernel(const Device& device, const std::string& source) : device_(device.handle()) {
    const shader::Module module = shader::Compiler("-").compile({.name = "kernel", .source = source});
    const VkDescriptorSetLayoutBinding binding{.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                               .descriptorCount = 1,
                                               .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    const VkDescriptorSetLayoutCreateInfo setInfo{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 1, .pBindings = &binding};
    check(vkCreateDescriptorSetLayout(device_, &setInfo, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
    const VkPushConstantRange range{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = 4};
    const VkPipelineLayoutCreateInfo layoutInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                .setLayoutCount = 1,
                                                .pSetLayouts = &setLayout_,
                                                .pushConstantRangeCount = 1,
                                                .pPushConstantRanges = &range};
    check(vkCreatePipelineLayout(device_, &layoutInfo, nullptr, &layout_), "vkCreatePipelineLayout");
    const VkShaderModuleCreateInfo moduleInfo{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                              .codeSize = module.spirv.size() * 4,
                                              .pCode = module.spirv.data()};
    check(vkCreateShaderModule(device_, &moduleInfo, nullptr, &module_), "vkCreateShaderModule");
    const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                           .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                     .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                     .module = module_,
                                                     .pName = "main"},
                                           .layout = layout_};
    check(vkCreateComputePipelines(device_, device.pipelineCache(), 1, &info, nullptr, &pipeline_),
          "vkCreateComputePipelines");
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    const VkDescriptorPoolCreateInfo poolInfo{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
    check(vkCreateDescriptorPool(device_, &poolInfo, nullptr, &pool_), "vkCreateDescriptorPool");
    const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = pool_,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &setLayout_};
    check(vkAllocateDescriptorSets(device_, &allocate, &set_), "vkAllocateDescriptorSets");
  }

  ~Kernel() {
    vkDestroyDescriptorPool(device_, pool_, nullptr);
    vkDestroyPipeline(device_, pipeline_, nullptr);
    vkDestroyShaderModule(device_, module_, nullptr);
    vkDestroyPipelineLayout(device_, layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_, setLayout_, nullptr);
  }

  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  void bind(const Buffer& buffer) const {
    const VkDescriptorBufferInfo info{buffer.handle(), 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set_,
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     .pBufferInfo = &info};
    vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
  }

  void dispatch(VkCommandBuffer commands, uint32_t groups, uint32_t value) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0, nullptr);
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, 4, &value);
    vkCmdDispatch(commands, groups, 1, 1);
  }

 private:
  VkDevice device_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkShaderModule module_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

const std::string kAddAndScale = R"(
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, scalar) buffer Values { uint values[]; };
layout(push_constant) uniform Push { uint amount; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < values.length()) values[i] = values[i] * 3u + amount;
}
)";

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;

TEST(Compute, ShaderGivesTheValuesThatTheHostComputes) {
  const std::shared_ptr<Device> device = test::validatedDevice();
  const test::ExpectNoValidationMessages guard(*device);
  std::vector<uint32_t> values(1000);
  for (uint32_t i = 0; i < values.size(); ++i) values[i] = i * i;
  const Kernel kernel(*device, kAddAndScale);
  const Buffer buffer = uploadBuffer(*device, values, kUsage, "values");
  kernel.bind(buffer);
  device->submitAndWait([&](VkCommandBuffer commands) {
    kernel.dispatch(commands, 16, 5);
    fullBarrier(commands);
    kernel.dispatch(commands, 16, 7);
  });
  const std::vector<std::byte> bytes = readBuffer(*device, buffer);
  for (uint32_t i = 0; i < values.size(); ++i) {
    uint32_t got;
    std::memcpy(&got, bytes.data() + 4 * i, 4);
    ASSERT_EQ(got, (values[i] * 3 + 5) * 3 + 7) << i;
  }
}

TEST(Compute, MissingBarrierBetweenDispatchesIsHeard) {
  const std::shared_ptr<Device> device = test::validatedDevice();
  const Kernel writer(*device, kAddAndScale);
  // Reads only: the layer of Debian 12 says nothing when both dispatches may write the buffer from the same stage,
  // since it can't see which elements they touch. Passes that read and write one buffer in place need tests of their
  // data.
  const Kernel reader(*device, R"(
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Values { uint values[]; };
layout(push_constant) uniform Push { uint amount; };
void main() { uint sum = values[gl_GlobalInvocationID.x] + amount; }
)");
  const Buffer buffer = uploadBuffer(*device, std::vector<uint32_t>(1024), kUsage, "values");
  writer.bind(buffer);
  reader.bind(buffer);
  for (const bool barrier : {true, false}) {
    device->clearValidationMessages();
    device->submitAndWait([&](VkCommandBuffer commands) {
      writer.dispatch(commands, 16, 5);
      if (barrier) fullBarrier(commands);
      reader.dispatch(commands, 16, 7);
    });
    const std::vector<ValidationMessage> messages = device->validationMessages();
    device->clearValidationMessages();
    ASSERT_EQ(messages.empty(), barrier);
    if (barrier) continue;
    EXPECT_EQ(messages.front().id, "SYNC-HAZARD-READ-AFTER-WRITE");
    EXPECT_TRUE(messages.front().error);
  }
}

TEST(Compute, RequiredFeaturesWorkInShaders) {
  // 64-bit integers, buffer addresses and demote's relatives compile to capabilities that the device must have enabled.
  const std::shared_ptr<Device> device = test::validatedDevice();
  const test::ExpectNoValidationMessages guard(*device);
  const Kernel kernel(*device, R"(
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(local_size_x = 1) in;
layout(buffer_reference, scalar) buffer Numbers { uint64_t numbers[]; };
layout(set = 0, binding = 0, scalar) buffer Values { uint64_t address; uint64_t sum; };
layout(push_constant) uniform Push { uint count; };
void main() {
  Numbers n = Numbers(address);
  sum = 0;
  for (uint i = 0; i < count; ++i) sum += n.numbers[i];
}
)");
  const std::vector<uint64_t> numbers = {1, 2, uint64_t{1} << 40};
  const Buffer source = uploadBuffer(
      *device, numbers, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, "numbers");
  const Buffer buffer = uploadBuffer(*device, std::vector<uint64_t>{source.address(), 0}, kUsage, "values");
  kernel.bind(buffer);
  device->submitAndWait([&](VkCommandBuffer commands) { kernel.dispatch(commands, 1, 3); });
  std::array<uint64_t, 2> got;
  std::memcpy(got.data(), readBuffer(*device, buffer).data(), sizeof got);
  EXPECT_EQ(got[1], 3 + (uint64_t{1} << 40));
}

TEST(PipelineCache, SurvivesBrokenFilesAndIsWrittenWhole) {
  const test::TemporaryFolder folder;
  const DeviceOptions options{.choice = test::deviceChoice(), .cacheFolder = folder.path()};
  const auto run = [&] {
    const Device device(options);
    const Kernel kernel(device, kAddAndScale);
    EXPECT_NE(device.pipelineCache(), VK_NULL_HANDLE);
  };
  const auto files = [&] {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      if (entry.is_regular_file()) paths.push_back(entry.path());
    }
    return paths;
  };
  run();
  if (files().empty()) GTEST_SKIP() << "this driver's pipeline cache holds nothing";
  ASSERT_EQ(files().size(), 1u) << "one file for one device, and no temporary one";
  run();
  const std::filesystem::path path = files().front();
  const auto size = std::filesystem::file_size(path);
  std::ofstream(path, std::ios::binary | std::ios::trunc) << "garbage";
  run();
  EXPECT_GT(std::filesystem::file_size(path), 7u);
  std::filesystem::resize_file(path, size / 2);
  run();
  EXPECT_GT(std::filesystem::file_size(path), size / 2);
}

}  // namespace
}  // namespace weir::gpu
