// `weir render --energy-compensation`: what it does, and that pictures with and without it aren't taken for one.
#include "cli/program.h"

namespace weir::test {
namespace {

TEST_F(Program, EnergyCompensationAddsLightAndIsNamedInTheHeader) {
  const image::Picture without = radiance(allLights, cornell, "", "without.exr"),
                       with = radiance(allLights, cornell, "--energy-compensation", "with.exr");
  ASSERT_TRUE(without.attributes.contains("weir.shading"));
  ASSERT_TRUE(with.attributes.contains("weir.shading"));
  EXPECT_EQ(without.attributes.at("weir.shading"), "glTF 2.0");
  EXPECT_EQ(with.attributes.at("weir.shading"), "glTF 2.0 with energy compensation");
  EXPECT_GT(meanOf(with), meanOf(without));
  EXPECT_LT(meanOf(with), 1.2 * meanOf(without));
  const Ran refused = weir("compare " + file("with.exr") + " " + file("without.exr"));
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_TRUE(has(refused.err, "weir.shading")) << refused.err;
  EXPECT_EQ(weir("compare --force " + file("with.exr") + " " + file("without.exr")).status, 0);
}

}  // namespace
}  // namespace weir::test
