// template.Scale against the product on the CPU.
#include <gtest/gtest.h>

#include "support/pass_test.h"

namespace weir::test {
namespace {

constexpr uint32_t kWidth = 13, kHeight = 9;  // no multiple of the workgroup's 8

/// RGBA, different in every number.
std::vector<float> ramp() {
  std::vector<float> rgba(size_t{4} * kWidth * kHeight);
  for (size_t i = 0; i < rgba.size(); ++i) rgba[i] = 0.25f * static_cast<float>(i) - 20.0f;
  return rgba;
}

TEST(Scale, MultipliesColourAndKeepsAlpha) {
  const std::vector<float> given = ramp();
  PassTest t("template.Scale");
  t.size(kWidth, kHeight).param("factor", "2.5").input("color", given);
  t.run();
  const std::vector<float> result = t.output<float>("color");
  ASSERT_EQ(result.size(), given.size());
  for (size_t i = 0; i < given.size(); ++i) EXPECT_EQ(result[i], i % 4 == 3 ? given[i] : 2.5f * given[i]) << i;
}

TEST(Scale, ChangesNothingByDefault) {
  PassTest t("template.Scale");
  t.size(kWidth, kHeight).input("color", ramp());
  t.run();
  EXPECT_EQ(t.output<float>("color"), ramp());
}

}  // namespace
}  // namespace weir::test
