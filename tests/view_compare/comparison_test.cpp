// The whole of it, driven as a window drives it: a graph is shown, its pictures are measured against a reference that
// grows, a knob is turned, the camera moves.
#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/image/metrics.h>

#include <cmath>

#include "view/compare/comparison.h"
#include "view/compare/file_reference.h"
#include "view_compare/theatre.h"

namespace weir::test {
namespace {

using view::Comparison;

/// Fails when it is told to.
class Failing final : public view::Reference {
 public:
  void restart(const execute::FrameInput& /*shown*/, uint32_t /*width*/, uint32_t /*height*/) override {
    if (failsToRestart) throw InputError("another size? never");
  }
  uint32_t step(double /*budget*/) override { throw RuntimeError("the device is lost"); }
  std::optional<execute::Executor::Located> image() const override { return std::nullopt; }
  std::shared_ptr<const view::ReferencePicture> latest() const override { return nullptr; }
  uint64_t view() const override { return 1; }
  std::string words() const override { return "words"; }
  std::string warning() const override { return ""; }
  bool failsToRestart = false;
};

class ComparisonTest : public Theatre {
 protected:
  ComparisonTest() { comparison_.setBudget(1.0); }

  /// A frame of the window.
  void frame(bool isNew = true) {
    view::ComparedFrame compared;
    if (isNew) {
      shown_.seed = 1;
      executor_->frame(shown_);
      ++shown_.index;
    }
    compared.input = shown_;
    compared.size = {kSide, kSide};
    compared.scene = scene_number_;
    compared.picture = executor_->locate("shade.color");
    compared.isNew = isNew;
    const std::vector<execute::FrameTimes> times = executor_->takeTimes();
    compared.times = times;
    comparison_.frame(compared);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  bool framesUntil(const std::function<bool()>& holds, bool isNew = true) {
    // However busy the machine is.
    for (const auto until = Clock::now() + std::chrono::seconds(120); Clock::now() < until;) {
      if (holds()) return true;
      frame(isNew);
    }
    return false;
  }
  void compareWith(const std::string& name) {
    comparison_.setReference(
        std::make_unique<view::BackgroundReference>(services(), graph(name, 1), shown_, kSide, kSide));
  }

  std::unique_ptr<execute::Executor> executor_ = executor("restir_di.json");
  Comparison comparison_{*device_, {.window = 16, .fewest = 3, .old = 8}};
  uint64_t scene_number_ = 1;
};

TEST_F(ComparisonTest, MeasuresWhatIsShown) {
  // A reference that stays what it is, and a window that stands still: one picture, one figure.
  const TemporaryFolder folder;
  const image::Picture truth = frames("all_lights.json", 77, 1)[0];
  const std::string file = folder.path() + "/truth.exr";
  image::writeExr(file, truth);
  comparison_.setReference(std::make_unique<view::FileReference>(*device_, file, stage_, "none", kSide, kSide));
  frame();
  ASSERT_TRUE(framesUntil([&] { return comparison_.error() && comparison_.flip(); }, false));
  const image::Metrics expected = image::measure(executor_->read("radiance"), image::readExr(file));
  EXPECT_EQ(comparison_.error()->relMse, expected.relMse);
  EXPECT_EQ(comparison_.error()->relMseTrimmed, expected.relMseTrimmed);
  EXPECT_EQ(comparison_.error()->relativeBias, expected.relativeBias);
  EXPECT_EQ(comparison_.flip()->mean, expected.flipMean);
  EXPECT_EQ(comparison_.problem(), "");
  const view::ComparisonState state = comparison_.state();
  EXPECT_TRUE(state.compares);
  EXPECT_TRUE(std::isnan(state.referenceRelMse));
  EXPECT_FALSE(state.hasCurrent) << "one picture is no point";
}

TEST_F(ComparisonTest, APointForEachSetting) {
  compareWith("all_lights.json");
  comparison_.setFlip(false);
  ASSERT_TRUE(framesUntil([&] { return comparison_.trail().current().has_value(); })) << comparison_.state().trailWords;
  EXPECT_EQ(comparison_.trail().current()->label, "start");
  EXPECT_GT(comparison_.trail().current()->relMse.median, 0.0);

  comparison_.turned({"spatial.radius", "6", "12"}, executor_->graph());
  EXPECT_FALSE(comparison_.trail().current()) << "it begins anew";
  frame();
  // Of restir_di: twice temporal.confidenceCap, which is 20.
  EXPECT_NE(comparison_.trail().words().find("of 40 frames left out"), std::string::npos)
      << comparison_.trail().words();
  EXPECT_TRUE(framesUntil([&] { return comparison_.trail().current().has_value(); }));
  const view::ComparisonState state = comparison_.state();
  ASSERT_EQ(state.points.size(), 2u);
  EXPECT_TRUE(state.hasCurrent);
  EXPECT_EQ(state.points[0].label, "start");
  EXPECT_EQ(state.points[1].label, "spatial.radius 6 → 12");
  EXPECT_FALSE(state.front.empty());
  EXPECT_FALSE(state.flip);
  EXPECT_GT(state.referenceRelMse, 0.0);
}

TEST_F(ComparisonTest, StartsOverWhenSomethingElseIsShown) {
  compareWith("all_lights.json");
  EXPECT_TRUE(framesUntil([&] { return comparison_.trail().current().has_value(); }));
  const uint64_t view = comparison_.reference()->view();
  frame();
  EXPECT_EQ(comparison_.reference()->view(), view) << "nothing has changed";
  shown_.camera.eye.y += 0.1f;
  frame();
  EXPECT_NE(comparison_.reference()->view(), view);
  EXPECT_FALSE(comparison_.error());
  EXPECT_TRUE(comparison_.state().points.empty());
  ASSERT_TRUE(framesUntil([&] { return comparison_.error().has_value(); }));
  EXPECT_EQ(comparison_.error()->view, comparison_.reference()->view());
  // Pictures of the other camera would be far off.
  EXPECT_LT(comparison_.error()->relMse, 0.5);
  const uint64_t second = comparison_.reference()->view();
  ++scene_number_;  // a light was moved
  frame();
  EXPECT_NE(comparison_.reference()->view(), second);
}

TEST_F(ComparisonTest, AReferenceThatFailsIsGoneAndSaid) {
  comparison_.setReference(std::make_unique<Failing>());
  EXPECT_NO_THROW(frame());
  EXPECT_EQ(comparison_.problem(), "the device is lost");
  EXPECT_EQ(comparison_.reference(), nullptr);
  EXPECT_FALSE(comparison_.state().compares);
  EXPECT_NO_THROW(frame());
  auto failing = std::make_unique<Failing>();
  failing->failsToRestart = true;
  comparison_.setReference(std::move(failing));
  EXPECT_EQ(comparison_.problem(), "");
  EXPECT_NO_THROW(frame());
  EXPECT_EQ(comparison_.problem(), "another size? never");
  compareWith("all_lights.json");
  EXPECT_EQ(comparison_.problem(), "");
  EXPECT_TRUE(framesUntil([&] { return comparison_.error().has_value(); })) << "the next one works";
}

TEST_F(ComparisonTest, WithoutAReferenceOrAPictureThereIsNothingToSay) {
  for (int i = 0; i < 5; ++i) frame();
  EXPECT_FALSE(comparison_.error());
  EXPECT_FALSE(comparison_.flip());
  EXPECT_TRUE(comparison_.state().points.empty());
  compareWith("all_lights.json");
  view::ComparedFrame without;
  without.input = shown_;
  without.size = {kSide, kSide};
  without.scene = scene_number_;
  for (int i = 0; i < 20; ++i) EXPECT_NO_THROW(comparison_.frame(without));
  EXPECT_FALSE(comparison_.error());
  comparison_.setReference(nullptr);
  EXPECT_NO_THROW(frame());
}

}  // namespace
}  // namespace weir::test
