// What is recorded in every frame, once it runs: nothing is allocated.
#include <gtest/gtest.h>
#include <weir/gpu/vulkan.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <new>
#include <vector>

#include "../../passes/common/layouts.h"
#include "easel.h"
#include "view/picture/probe.h"

namespace {

thread_local bool counting = false;
std::atomic<uint64_t> allocations{0};

#ifndef __SANITIZE_ADDRESS__
void* counted(size_t size) {
  if (counting) ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
#endif

}  // namespace

// The whole program's, the libraries' it loads included. A sanitizer has its own.
#ifndef __SANITIZE_ADDRESS__
void* operator new(size_t size) {
  return counted(size);
}
void* operator new[](size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
  std::free(memory);
}
#endif

namespace weir::test {
namespace {

TEST(PictureSteady, RecordingAllocatesNothing) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a sanitizer's own allocator can't be counted";
#endif
  allocations = 0;
  counting = true;
  std::vector<int>(1000).swap(*std::make_unique<std::vector<int>>());
  counting = false;
  ASSERT_GE(allocations, 2u) << "the counter counts";
  // Without validation, whose layer allocates in every call.
  Easel easel(std::make_shared<gpu::Device>(gpu::DeviceOptions{.choice = deviceChoice(), .cacheFolder = "-"}));
  const FilledPort image = easel.image(Format::RGBA32F, 64, 64, std::vector<float>(4 * 64 * 64, 0.5f));
  const FilledPort surfaces =
      easel.buffer(layoutOf<passes::PackedSurface>(), 8, 8, 1, std::vector<passes::PackedSurface>(64));
  const view::Channel rgb = channelNamed(image.resource, "RGB"),
                      normal = channelNamed(surfaces.resource, "shading normal");
  view::Probe first(easel.device()), second(easel.device());
  const view::Target target = easel.plainTarget();
  const auto frame = [&](VkCommandBuffer commands, uint32_t slot) {
    easel.picture().begin(slot);
    easel.picture().draw(commands, {image, rgb}, {}, target);
    easel.picture().draw(commands, {surfaces, normal}, {}, target);
    first.record(commands, slot, image, {1, 2});
    second.record(commands, slot, surfaces, {1, 2});
  };
  // Both slots once, so that everything there is to make is made.
  for (uint32_t slot = 0; slot < 2; ++slot) {
    easel.device().submitAndWait([&](VkCommandBuffer commands) { frame(commands, slot); });
    EXPECT_NE(first.collect(slot), nullptr);
    EXPECT_NE(second.collect(slot), nullptr);
  }
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t slot = i % 2;
    std::chrono::nanoseconds taken{0};
    easel.device().submitAndWait([&](VkCommandBuffer commands) {
      const auto start = std::chrono::steady_clock::now();
      allocations = 0;
      counting = true;
      frame(commands, slot);
      counting = false;
      taken = std::chrono::steady_clock::now() - start;
    });
    EXPECT_EQ(allocations, 0u);
    std::cout << "two pictures and two probes: recorded in " << 1e-3 * static_cast<double>(taken.count()) << " us\n";
    EXPECT_NE(first.collect(slot), nullptr);
    EXPECT_NE(second.collect(slot), nullptr);
  }
}

}  // namespace
}  // namespace weir::test
