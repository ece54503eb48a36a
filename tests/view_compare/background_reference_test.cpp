// The reference is the mean of independent frames of its graph, known as well as their variance says, whatever pace the
// window gives it.
#include <weir/core/error.h>
#include <weir/render/mean.h>

#include <cmath>
#include <limits>

#include "view_compare/theatre.h"

namespace weir::test {
namespace {

using view::BackgroundReference;
using view::ReferencePicture;

using BackgroundReferenceTest = Theatre;

double ulp(double value) {
  return static_cast<double>(std::nextafter(std::abs(float(value)), std::numeric_limits<float>::infinity())) -
         std::abs(double(float(value)));
}

/// Colours alone: within a float's rounding of the sum and of the quotient.
void expectMean(const image::Picture& picture, const image::Picture& mean) {
  ASSERT_EQ(picture.rgba.size(), mean.rgba.size());
  for (size_t i = 0; i < mean.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    ASSERT_NEAR(picture.rgba[i], mean.rgba[i], 3 * ulp(mean.rgba[i])) << "value " << i;
  }
}

image::Picture meanOf(const std::vector<image::Picture>& pictures) {
  render::FrameMean mean;
  for (const image::Picture& picture : pictures) mean.add(picture);
  return mean.mean();
}

TEST_F(BackgroundReferenceTest, IsTheMeanOfItsFramesAndKnowsItsOwnError) {
  constexpr uint32_t kFrames = 7;
  BackgroundReference reference = this->reference(graph("reference.json"));
  EXPECT_FALSE(reference.image()) << "there is no frame yet";
  advance(reference, kFrames);
  ASSERT_EQ(reference.frames(), kFrames);
  const image::Picture picture = read(*reference.image());
  const std::vector<image::Picture> frames = this->frames("reference.json", reference.seed(), kFrames);
  const image::Picture mean = meanOf(frames);
  expectMean(picture, mean);
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    double expected = 0;
    for (size_t c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (const image::Picture& frame : frames) sum += frame.rgba[i + c];
      const double m = sum / kFrames;
      for (const image::Picture& frame : frames) squares += (frame.rgba[i + c] - m) * (frame.rgba[i + c] - m);
      expected += squares / (kFrames * (kFrames - 1.0)) / (m * m + 0.01) / 3;
    }
    // Deviations are of means that are floats: their squares are known to some 1e-7 of the mean's.
    ASSERT_NEAR(picture.rgba[i + 3], expected, 1e-4 * expected + 1e-9) << "pixel " << i / 4;
  }
}

TEST_F(BackgroundReferenceTest, StartsOverAsIfNothingHadBeen) {
  BackgroundReference reference = this->reference(graph("reference.json"));
  advance(reference, 3);
  const uint64_t view = reference.view();
  shown_.camera.eye.x += 0.2f;
  reference.restart(shown_, kSide, kSide);
  EXPECT_NE(reference.view(), view);
  EXPECT_EQ(reference.frames(), 0u);
  EXPECT_FALSE(reference.image());
  EXPECT_EQ(reference.latest(), nullptr);
  advance(reference, 2);
  expectMean(read(*reference.image()), meanOf(frames("reference.json", reference.seed(), 2)));
  // Another size.
  reference.restart(shown_, 24, 24);
  advance(reference, 2);
  ASSERT_EQ(reference.image()->resource->width, 24u);
  expectMean(read(*reference.image()), meanOf(frames("reference.json", reference.seed(), 2, false, 24)));
  ASSERT_TRUE(eventually([&] {
    smallStep(reference);
    return reference.latest() != nullptr;
  }));
  EXPECT_EQ(reference.latest()->picture.width, 24u);
}

TEST_F(BackgroundReferenceTest, HasOtherRandomNumbersThanWhatIsShown) {
  constexpr uint32_t kShown = 5;
  BackgroundReference reference = this->reference(graph("reference.json", kShown));
  EXPECT_NE(reference.seed(), kShown);
  EXPECT_NE(reference.seed(), this->reference(graph("reference.json", kShown + 1)).seed());
  advance(reference, 1);
  const image::Picture own = read(*reference.image()), shown = frames("reference.json", kShown, 1)[0];
  size_t different = 0;
  for (size_t i = 0; i < own.rgba.size(); i += 4) different += own.rgba[i] != shown.rgba[i];
  EXPECT_GT(different, own.rgba.size() / 16) << "of the pixels that light falls on";
}

TEST_F(BackgroundReferenceTest, FramesOfAGraphThatRemembersAreIndependent) {
  BackgroundReference reference = this->reference(graph("restir_di.json"));
  EXPECT_NE(reference.warning(), "");
  advance(reference, 3);
  expectMean(read(*reference.image()), meanOf(frames("restir_di.json", reference.seed(), 3, true)));
}

TEST_F(BackgroundReferenceTest, ComesToTheHostByItself) {
  BackgroundReference reference = this->reference(graph("all_lights.json"));
  EXPECT_EQ(reference.warning(), "");
  EXPECT_NE(reference.words().find("no frame"), std::string::npos);
  ASSERT_TRUE(eventually([&] {
    smallStep(reference);
    const std::shared_ptr<const ReferencePicture> now = reference.latest();
    return now && now->frames >= 4;
  }));
  const std::shared_ptr<const ReferencePicture> now = reference.latest();
  EXPECT_EQ(now->view, reference.view());
  EXPECT_EQ(now->nonFinite, 0u);
  const std::vector<image::Picture> frames =
      this->frames("all_lights.json", reference.seed(), static_cast<uint32_t>(now->frames));
  expectMean(now->picture, meanOf(frames));
  EXPECT_EQ(now->picture.rgba[3], 1.0f);
  EXPECT_GT(now->relMse, 0.0);
  EXPECT_LT(now->relMse, 1.0);
  EXPECT_NE(reference.words().find("smaller errors can't be told"), std::string::npos) << reference.words();
}

TEST_F(BackgroundReferenceTest, KeepsToItsBudget) {
  BackgroundReference reference = this->reference(graph("reference.json"));
  EXPECT_EQ(reference.step(0.0), 0u);
  EXPECT_EQ(reference.step(-1.0), 0u);
  ASSERT_TRUE(eventually([&] {
    smallStep(reference);
    return reference.frameMilliseconds().has_value();
  }));
  const double cost = *reference.frameMilliseconds();
  device_->waitIdle();
  // A hundredth of a frame's time a step: what is left over from before makes for one frame, and then none follows.
  uint32_t frames = 0;
  for (int i = 0; i < 20; ++i) {
    frames += reference.step(0.01 * cost);
    device_->waitIdle();
  }
  EXPECT_LE(frames, 1u);
  EXPECT_EQ(reference.step(0.0), 0u);
}

TEST_F(BackgroundReferenceTest, WhatIsWrongWithAGraphIsSaid) {
  const auto problem = [&](const view::ReferenceGraph& graph) {
    try {
      reference(graph);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(problem(graph("missing.json")).find("missing.json"), std::string::npos);
  view::ReferenceGraph other = graph("reference.json");
  other.output = "radianse";
  EXPECT_NE(problem(other).find("nearest: 'radiance'"), std::string::npos) << problem(other);
  other = graph("restir_di.json");
  other.overrides.set = {"spatial.radios=3"};
  EXPECT_NE(problem(other).find("nearest: 'radius'"), std::string::npos) << problem(other);
}

TEST_F(BackgroundReferenceTest, ARestartThatFailsChangesNothing) {
  BackgroundReference reference = this->reference(graph("reference.json"));
  advance(reference, 2);
  const uint64_t view = reference.view();
  EXPECT_THROW(reference.restart(shown_, 0, kSide), InputError);
  EXPECT_THROW(reference.restart(shown_, 17000, kSide), InputError);
  EXPECT_EQ(reference.view(), view);
  advance(reference, 1);
  EXPECT_EQ(reference.frames(), 3u);
  expectMean(read(*reference.image()), meanOf(frames("reference.json", reference.seed(), 3)));
}

TEST_F(BackgroundReferenceTest, ReadsItsGraphAnew) {
  const TemporaryFolder folder;
  const std::string text = shader::readFile(sourcePath("graphs/reference.json"));
  const std::string file = folder.write("graph.json", text);
  BackgroundReference reference(services(), {.file = file}, shown_, kSide, kSide);
  advance(reference, 2);
  folder.write("graph.json", "{");
  EXPECT_THROW(reference.reload(), InputError);
  advance(reference, 1);
  EXPECT_EQ(reference.frames(), 3u) << "the old one goes on";
  folder.write("graph.json", text);
  reference.reload();
  EXPECT_EQ(reference.frames(), 0u);
  advance(reference, 2);
  expectMean(read(*reference.image()), meanOf(frames("reference.json", reference.seed(), 2)));
}

TEST_F(BackgroundReferenceTest, CanGoAtAnyTime) {
  for (uint32_t frames = 0; frames < 4; ++frames) {
    BackgroundReference reference = this->reference(graph("reference.json"));
    for (uint32_t f = 0; f < frames; ++f) reference.step(1000.0);
  }
}

TEST(QualityInWords, SaysWhatCanBeTold) {
  ReferencePicture r;
  r.frames = 312;
  r.relMse = 1.3e-5;
  EXPECT_EQ(view::qualityInWords(r), "312 frames; its own relMSE is 1.3e-05: smaller errors can't be told");
  r.relMse = 0;
  EXPECT_EQ(view::qualityInWords(r), "312 frames, which are all alike: as good as exact");
  r.nonFinite = 2;
  r.frames = 1;
  r.relMse = std::nan("");
  EXPECT_EQ(view::qualityInWords(r), "1 frame; its own error is not known yet; 2 pixels are not finite");
  r.frames = 0;
  r.nonFinite = 0;
  EXPECT_EQ(view::qualityInWords(r), "a picture from a file; its own error is unknown");
}

}  // namespace
}  // namespace weir::test
