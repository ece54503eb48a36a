// Pictures that are brought to the host while frames go on.
#include <weir/core/error.h>

#include <optional>

#include "view_compare/theatre.h"

namespace weir::test {
namespace {

using PictureRingTest = Theatre;

TEST_F(PictureRingTest, GivesWhatTheExecutorReads) {
  const std::unique_ptr<execute::Executor> shown = executor("restir_di.json");
  shown->frame(shown_);
  for (const char* output : {"color", "radiance"}) {
    const graph::GraphOutput& found = *shown->graph().findOutput(output);
    const execute::Executor::Located image = shown->locate(shown->graph().resources[found.resource].name);
    EXPECT_EQ(read(image).rgba, shown->read(output).rgba) << output;
  }
  EXPECT_THROW(view::PictureRing(*device_).capture(shown->locate("temporal.reservoirs"), 0), InputError);
}

TEST_F(PictureRingTest, LendsSoManyAndNoMore) {
  const std::unique_ptr<execute::Executor> shown = executor("restir_di.json");
  shown->frame(shown_);
  const execute::Executor::Located image = shown->locate("shade.color");
  auto ring = std::make_unique<view::PictureRing>(*device_, 2);
  EXPECT_TRUE(ring->take().empty());
  EXPECT_FALSE(ring->pending());
  EXPECT_TRUE(ring->capture(image, 7));
  EXPECT_TRUE(ring->pending());
  shown_.index = 1;
  shown->frame(shown_);
  const execute::Executor::Located later = shown->locate("shade.color");
  EXPECT_TRUE(ring->capture(later, 8));
  EXPECT_FALSE(ring->capture(later, 9)) << "both are on their way";
  device_->waitIdle();
  std::vector<view::HostCopy> copies = ring->take();
  ASSERT_EQ(copies.size(), 2u);
  EXPECT_EQ(copies[0].number(), 7u);
  EXPECT_EQ(copies[1].number(), 8u);
  EXPECT_NE(copies[0].picture().rgba, copies[1].picture().rgba);
  EXPECT_EQ(copies[1].picture().rgba, shown->read("radiance").rgba);
  EXPECT_FALSE(ring->capture(later, 9)) << "both are lent out";
  std::optional<view::HostCopy> second = copies[1];
  copies.clear();
  EXPECT_TRUE(ring->capture(later, 9)) << "the first came back";
  EXPECT_FALSE(ring->capture(later, 10));
  ring.reset();  // while one is on its way and one is lent out
  EXPECT_EQ(second->picture().rgba, shown->read("radiance").rgba);
}

}  // namespace
}  // namespace weir::test
