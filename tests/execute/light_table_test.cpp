// The alias table that the device builds: every light's share of its cells is its power's, for powers that are hard on
// sums; and it follows a clip as the CPU's own table does.
#include <gtest/gtest.h>
#include <weir/execute/light_table.h>
#include <weir/scene/lights.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/device.h"

namespace weir::test {
namespace {

using execute::LightTable;

struct Built {
  std::vector<scene::AliasCell> cells;
  std::vector<float> pdfs;
};

template <typename T>
std::vector<T> read(const gpu::Device& device, const gpu::Buffer& buffer, size_t count) {
  const std::vector<std::byte> bytes = gpu::readBuffer(device, buffer);
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.data(), count * sizeof(T));
  return values;
}

/// As the shader leaves it, from buffers that were full of something else. Probabilities lie seven floats apart.
Built build(const std::vector<float>& powers) {
  const std::shared_ptr<gpu::Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  const size_t n = powers.size();
  const gpu::Buffer in = gpu::uploadBuffer(*device, powers, kUsage, "powers");
  const gpu::Buffer cells = gpu::uploadBuffer(*device, std::vector<uint32_t>(2 * n, 0xcdcdcdcdu), kUsage, "cells");
  const gpu::Buffer pdfs = gpu::uploadBuffer(*device, std::vector<float>(7 * n + 2, -1.0f), kUsage, "pdfs");
  shader::Compiler compiler;
  const LightTable table(*device, compiler, static_cast<uint32_t>(n), in.handle(), cells.handle(),
                         {{pdfs.handle(), 7, 2}});
  device->submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    table.record(commands, 0);
    gpu::fullBarrier(commands);
  });
  Built b;
  b.cells = read<scene::AliasCell>(*device, cells, n);
  const std::vector<float> spread = read<float>(*device, pdfs, 7 * n + 2);
  for (size_t i = 0; i < n; ++i) b.pdfs.push_back(spread[7 * i + 2]);
  return b;
}

/// Each light's share, of the cells and as it was written, within 1e-6 of its power's; lights without power have none.
void expectExact(const std::vector<float>& powers, const std::string& what) {
  SCOPED_TRACE(what);
  const Built b = build(powers);
  const size_t n = powers.size();
  long double sum = 0.0L;
  for (const float p : powers) sum += p;
  for (const scene::AliasCell& cell : b.cells) {
    ASSERT_GE(cell.threshold, 0.0f);
    ASSERT_LE(cell.threshold, 1.0f);
    ASSERT_LT(cell.alias, n);
  }
  const std::vector<double> shares = scene::aliasProbabilities(b.cells);
  double worst = 0.0, worstWritten = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const auto wanted = static_cast<double>(powers[i] / sum);
    if (powers[i] == 0.0f) {
      ASSERT_EQ(shares[i], 0.0) << i;
      ASSERT_EQ(b.pdfs[i], 0.0f) << i;
      continue;
    }
    worst = std::max(worst, std::abs(shares[i] / wanted - 1.0));
    worstWritten = std::max(worstWritten, std::abs(b.pdfs[i] / shares[i] - 1.0));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT(worstWritten, 1e-6) << "what estimators divide by is not what the table does";
}

class LightTableTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!LightTable::supported(*validatedDevice())) GTEST_SKIP() << "no double precision in this device's shaders";
  }
};

TEST_F(LightTableTest, FewLights) {
  expectExact({3.0f}, "one");
  expectExact({3.0f, 1.0f}, "two");
  expectExact({1.0f, 0.0f, 5.0f}, "three, one dark");
  expectExact({1e-20f, 1e-20f, 1e-20f}, "alike and tiny");
  expectExact({3e38f, 3e38f, 1e38f, 2e38f}, "a sum that overflows a float");
  expectExact({1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f}, "seven");
}

// Sizes around a work group's share of 2048 and its multiples; powers of every decade and many dark ones.
TEST_F(LightTableTest, GroupsAndDecades) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (const size_t n : {255u, 2047u, 2048u, 2049u, 4099u, 10007u}) {
    std::vector<float> flat(n), decades(n), sparse(n, 0.0f);
    for (float& p : flat) p = uniform(random);
    for (float& p : decades) p = std::pow(10.0f, 20.0f * uniform(random) - 10.0f);
    for (size_t i = 0; i < n; i += 1 + random() % 50) sparse[i] = 1e-3f + uniform(random);
    expectExact(flat, "flat " + std::to_string(n));
    expectExact(decades, "decades " + std::to_string(n));
    expectExact(sparse, "sparse " + std::to_string(n));
  }
}

// Where roundings of one kind add up: a hundred thousand thresholds round the same way, and one or two lights take all
// that is left over.
TEST_F(LightTableTest, HardOnSums) {
  constexpr size_t kMany = 100003;
  expectExact(std::vector<float>(kMany, 0.7f), "all alike");
  std::vector<float> p(kMany, 1.0f);
  p[777] = 1e9f;
  expectExact(p, "one outshines all by 10⁹");
  p[777] = 1.00001f;
  expectExact(p, "one is a little brighter");
  p[777] = 3.0f;
  expectExact(p, "one is three times as bright");
  for (size_t i = 0; i < kMany; i += 2) p[i] = 0.3f;
  p.back() = 1.1f;
  expectExact(p, "dim and bright in turn");
  p.assign(kMany, 0.01f);
  for (size_t i = 0; i < 300; ++i) p[i * 331] = 100.0f + static_cast<float>(i);
  p.back() = 4.0f;
  expectExact(p, "few bright ones, the last one hardly");
}

TEST_F(LightTableTest, AllDarkAreAllAlike) {
  for (const size_t n : {1u, 3u, 3000u}) {
    const Built b = build(std::vector<float>(n, 0.0f));
    const std::vector<double> shares = scene::aliasProbabilities(b.cells);
    for (size_t i = 0; i < n; ++i) {
      ASSERT_NEAR(shares[i] * static_cast<double>(n), 1.0, 1e-6);
      ASSERT_NEAR(static_cast<double>(b.pdfs[i]) * static_cast<double>(n), 1.0, 1e-6);
    }
  }
}

TEST_F(LightTableTest, WhatIsNoPowerShinesForNothing) {
  const float infinite = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();
  const Built b = build({1.0f, infinite, -2.0f, none, 3.0f});
  const std::vector<double> shares = scene::aliasProbabilities(b.cells);
  const double expected[] = {0.25, 0.0, 0.0, 0.0, 0.75};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(shares[i], expected[i], 1e-6) << i;
    EXPECT_NEAR(b.pdfs[i], expected[i], 1e-6) << i;
  }
}

TEST_F(LightTableTest, TheSamePowersGiveTheSameTable) {
  std::mt19937 random(3);
  std::vector<float> p(5000);
  for (float& power : p) power = static_cast<float>(random() % 1000);
  const Built a = build(p), b = build(p);
  EXPECT_EQ(std::memcmp(a.cells.data(), b.cells.data(), a.cells.size() * sizeof(scene::AliasCell)), 0);
  EXPECT_EQ(a.pdfs, b.pdfs);
}

}  // namespace
}  // namespace weir::test
