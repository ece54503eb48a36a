// Choosing a device, hiding what it has, and hearing what the validation layer says.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/gpu/memory.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "support/device.h"

namespace weir::gpu {
namespace {

using test::deviceChoice;
using test::ExpectNoValidationMessages;
using test::validatedDevice;

std::string inputErrorOf(const DeviceOptions& options) {
  try {
    const Device device(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

TEST(ListDevices, SaysWhatEachHas) {
  const std::vector<DeviceInfo> devices = listDevices();
  ASSERT_FALSE(devices.empty());
  for (size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, i);
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_FALSE(devices[i].driver.empty());
    EXPECT_FALSE(devices[i].kind.empty());
    if (!devices[i].missing.empty()) continue;
    EXPECT_GE(devices[i].apiVersion, VK_API_VERSION_1_3);
    EXPECT_GT(devices[i].capabilities.maxStorageBufferRange, 0u);
    EXPECT_GT(devices[i].capabilities.maxTextures, 0u);
    EXPECT_GT(devices[i].capabilities.subgroupSize, 0u);
  }
}

TEST(Device, IsCreatedWithoutValidationMessages) {
  const Device device({.choice = deviceChoice(), .validation = true, .cacheFolder = "-"});
  for (const ValidationMessage& message : device.validationMessages()) {
    ADD_FAILURE() << message.id << ": " << message.text;
  }
  EXPECT_TRUE(device.info().missing.empty());
  EXPECT_NE(device.allocator(), nullptr);
  EXPECT_NE(device.pipelineCache(), VK_NULL_HANDLE);
}

TEST(Device, IsChosenByIndexKindAndPartOfItsName) {
  const std::shared_ptr<Device> known = validatedDevice();
  const DeviceInfo& info = known->info();
  EXPECT_EQ(Device({.choice = std::to_string(info.index), .cacheFolder = "-"}).info().name, info.name);
  std::string part = info.name.substr(0, info.name.size() / 2);
  std::ranges::transform(part, part.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  EXPECT_EQ(Device({.choice = part, .cacheFolder = "-"}).info().name, info.name);
  EXPECT_NO_THROW(Device({.cacheFolder = "-"}));
}

TEST(Device, WrongChoiceListsThoseThereAre) {
  const std::string name = listDevices().front().name;
  for (const char* choice : {"no such device", "99", "-1", "00000000000000000000000"}) {
    const std::string message = inputErrorOf({.choice = choice, .cacheFolder = "-"});
    EXPECT_NE(message.find(choice), std::string::npos) << message;
    EXPECT_NE(message.find("0: " + name), std::string::npos) << message;
  }
}

TEST(Device, HidesRayTracing) {
  const Device hidden({.choice = deviceChoice(), .hideRayTracing = true, .cacheFolder = "-"});
  EXPECT_FALSE(hidden.capabilities().accelerationStructure);
  EXPECT_FALSE(hidden.capabilities().rayPipeline);
  EXPECT_FALSE(hidden.capabilities().rayQuery);
  // Not only unsaid: the device is made without it.
  EXPECT_EQ(vkGetDeviceProcAddr(hidden.handle(), "vkCreateAccelerationStructureKHR"), nullptr);
}

TEST(Device, HidesOneRayBackEndAndKeepsTheOther) {
  const Capabilities has = validatedDevice()->capabilities();
  if (!has.rayPipeline || !has.rayQuery) GTEST_SKIP() << "needs a device with both";
  const Device query({.choice = deviceChoice(), .validation = true, .hideRayPipeline = true, .cacheFolder = "-"});
  EXPECT_FALSE(query.capabilities().rayPipeline);
  EXPECT_TRUE(query.capabilities().rayQuery);
  EXPECT_EQ(vkGetDeviceProcAddr(query.handle(), "vkCreateRayTracingPipelinesKHR"), nullptr);
  EXPECT_NE(vkGetDeviceProcAddr(query.handle(), "vkCreateAccelerationStructureKHR"), nullptr);
  EXPECT_TRUE(query.validationMessages().empty());
  const Device pipeline({.choice = deviceChoice(), .validation = true, .hideRayQuery = true, .cacheFolder = "-"});
  EXPECT_TRUE(pipeline.capabilities().rayPipeline);
  EXPECT_FALSE(pipeline.capabilities().rayQuery);
  EXPECT_TRUE(pipeline.validationMessages().empty());
}

void expectRoundTrip(const Device& device, uint32_t seed) {
  std::vector<uint32_t> values(1000);
  for (uint32_t i = 0; i < values.size(); ++i) values[i] = i * 2654435761u + seed;
  const Buffer buffer = uploadBuffer(device, values, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "values");
  const std::vector<std::byte> bytes = readBuffer(device, buffer);
  ASSERT_EQ(bytes.size(), values.size() * 4);
  EXPECT_EQ(std::memcmp(bytes.data(), values.data(), bytes.size()), 0);
}

TEST(Device, TwoWorkAtOnceAndOneOutlivesTheOther) {
  auto first =
      std::make_unique<Device>(DeviceOptions{.choice = deviceChoice(), .validation = true, .cacheFolder = "-"});
  const Device second({.choice = deviceChoice(), .validation = false, .hideRayTracing = true, .cacheFolder = "-"});
  expectRoundTrip(*first, 1);
  expectRoundTrip(second, 2);
  EXPECT_TRUE(first->validationMessages().empty());
  first.reset();
  expectRoundTrip(second, 3);
}

TEST(Device, ThreadsMayEachHaveTheirOwn) {
  std::vector<std::jthread> threads;
  for (uint32_t i = 0; i < 4; ++i) {
    threads.emplace_back([i] {
      const Device device({.choice = deviceChoice(), .cacheFolder = "-"});
      expectRoundTrip(device, i);
    });
  }
}

TEST(Device, SubmitsFromSeveralThreads) {
  const std::shared_ptr<Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  std::vector<std::jthread> threads;
  for (uint32_t i = 0; i < 4; ++i) threads.emplace_back([&device, i] { expectRoundTrip(*device, i); });
}

TEST(Device, KeepsWorkingAfterARecordingThatThrows) {
  const std::shared_ptr<Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  EXPECT_THROW(device->submitAndWait([](VkCommandBuffer) { throw RuntimeError("while recording"); }), RuntimeError);
  expectRoundTrip(*device, 7);
}

TEST(Device, LabelsAndNamesAreAccepted) {
  const std::shared_ptr<Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  device->name(VK_OBJECT_TYPE_QUEUE, reinterpret_cast<uint64_t>(device->queue()), "the queue");
  device->name(VK_OBJECT_TYPE_BUFFER, 0, "nothing");
  device->submitAndWait([&](VkCommandBuffer commands) {
    device->beginLabel(commands, "outer");
    device->beginLabel(commands, "inner");
    device->endLabel(commands);
    device->endLabel(commands);
  });
}

TEST(Validation, HearsAWrongUsage) {
  const std::shared_ptr<Device> device = validatedDevice();
  device->clearValidationMessages();
  // A copy out of a buffer that was not made for it.
  const Buffer from(*device, 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Residency::Device, "not a source");
  const Buffer to(*device, 64, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residency::Device, "goal");
  device->submitAndWait([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.size = 64};
    vkCmdCopyBuffer(commands, from.handle(), to.handle(), 1, &region);
  });
  ASSERT_FALSE(device->validationMessages().empty());
  const ValidationMessage message = device->validationMessages().front();
  EXPECT_TRUE(message.error);
  EXPECT_NE(message.id.find("VUID-vkCmdCopyBuffer"), std::string::npos) << message.id;
  EXPECT_NE(message.text.find("not a source"), std::string::npos) << "the object's name is missing: " << message.text;
  device->clearValidationMessages();
  EXPECT_TRUE(device->validationMessages().empty());
}

TEST(Validation, HearsAMissingBarrierBetweenCopies) {
  const std::shared_ptr<Device> device = validatedDevice();
  device->clearValidationMessages();
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const Buffer a(*device, 64, usage, Residency::Device, "a"), b(*device, 64, usage, Residency::Device, "b");
  device->submitAndWait([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.size = 64};
    vkCmdCopyBuffer(commands, a.handle(), b.handle(), 1, &region);
    vkCmdCopyBuffer(commands, b.handle(), a.handle(), 1, &region);
  });
  ASSERT_FALSE(device->validationMessages().empty());
  EXPECT_NE(device->validationMessages().front().id.find("SYNC-HAZARD"), std::string::npos);
  device->clearValidationMessages();
}

TEST(Result, HasItsNameAndTheCall) {
  EXPECT_STREQ(resultName(VK_ERROR_DEVICE_LOST), "VK_ERROR_DEVICE_LOST");
  EXPECT_NO_THROW(check(VK_SUCCESS, "vkNothing"));
  try {
    check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2");
    FAIL();
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("vkQueueSubmit2"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("VK_ERROR_DEVICE_LOST"), std::string::npos);
  }
}

}  // namespace
}  // namespace weir::gpu
