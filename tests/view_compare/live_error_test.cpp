// Figures beside the window are those of weir::image, of the pictures that were handed over; nothing that goes wrong
// there ends a thread.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/flip.h>
#include <weir/image/metrics.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <thread>

#include "view/compare/live_error.h"

namespace weir::view {
namespace {

image::Picture randomPicture(uint32_t width, uint32_t height, uint32_t seed) {
  image::Picture picture{width, height, {}, {}};
  std::mt19937 random(seed);
  for (size_t i = 0; i < size_t{4} * width * height; ++i)
    picture.rgba.push_back(i % 4 == 3 ? 1.0f : static_cast<float>(random()) * 0x1p-32f);
  return picture;
}

std::shared_ptr<ReferencePicture> referenceOf(image::Picture picture) {
  auto reference = std::make_shared<ReferencePicture>();
  reference->picture = std::move(picture);
  reference->view = 3;
  reference->frames = 100;
  reference->relMse = 1e-4;
  return reference;
}

template <typename Holds>
bool eventually(const Holds& holds) {
  for (int i = 0; i < 60000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// The one figure that comes of one picture.
ErrorFigures measureOne(LiveError& live, uint64_t frame, const LiveError::Source& picture,
                        const std::shared_ptr<const ReferencePicture>& reference) {
  live.measure(frame, picture, reference);
  std::vector<ErrorFigures> all;
  EXPECT_TRUE(eventually([&] {
    for (ErrorFigures& f : live.take()) all.push_back(std::move(f));
    return !all.empty();
  }));
  EXPECT_EQ(all.size(), 1u);
  return all.at(0);
}

TEST(LiveError, IsWhatTheMetricsSay) {
  const image::Picture picture = randomPicture(64, 48, 1);
  const auto reference = referenceOf(randomPicture(64, 48, 2));
  const image::Metrics expected = image::measure(picture, reference->picture);
  LiveError live;
  EXPECT_TRUE(live.ready());
  EXPECT_FALSE(live.flip());
  const ErrorFigures f = measureOne(
      live, 42, [&] { return picture; }, reference);
  EXPECT_EQ(f.frame, 42u);
  EXPECT_EQ(f.view, 3u);
  EXPECT_EQ(f.referenceFrames, 100u);
  EXPECT_EQ(f.referenceRelMse, 1e-4);
  EXPECT_EQ(f.relMse, expected.relMse);
  EXPECT_EQ(f.relMseTrimmed, expected.relMseTrimmed);
  EXPECT_LT(f.relMseTrimmed, f.relMse);
  EXPECT_EQ(f.relativeBias, expected.relativeBias);
  EXPECT_EQ(f.nonFinite, 0u);
  EXPECT_EQ(f.problem, "");
  ASSERT_TRUE(eventually([&] { return live.flip().has_value(); }));
  EXPECT_EQ(live.flip()->frame, 42u);
  EXPECT_EQ(live.flip()->mean, expected.flipMean);
  EXPECT_EQ(live.flip()->p99, expected.flipP99);
  EXPECT_GT(live.flip()->seconds, 0.0);
  EXPECT_TRUE(eventually([&] { return live.ready(); }));
}

TEST(LiveError, PixelsThatAreNotFiniteAreCounted) {
  image::Picture picture = randomPicture(16, 16, 1), truth = randomPicture(16, 16, 2);
  picture.rgba[0] = std::numeric_limits<float>::quiet_NaN();
  truth.rgba[41] = std::numeric_limits<float>::infinity();
  LiveError live;
  const ErrorFigures f = measureOne(
      live, 1, [&] { return picture; }, referenceOf(truth));
  EXPECT_EQ(f.nonFinite, 2u);
  EXPECT_EQ(f.relMse, image::measure(picture, truth, {.flip = false}).relMse);
  for (float& v : picture.rgba) v = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(measureOne(
                live, 2, [&] { return picture; }, referenceOf(truth))
                .problem,
            "");
}

TEST(LiveError, WhatGoesWrongIsSaidAndTheNextOneIsMeasured) {
  LiveError live;
  const auto reference = referenceOf(randomPicture(16, 16, 2));
  const ErrorFigures size = measureOne(
      live, 1, [] { return randomPicture(16, 15, 1); }, reference);
  EXPECT_NE(size.problem.find("16x15"), std::string::npos) << size.problem;
  EXPECT_TRUE(std::isnan(size.relMse));
  const ErrorFigures thrown = measureOne(
      live, 2, []() -> image::Picture { throw std::runtime_error("no memory today"); }, reference);
  EXPECT_EQ(thrown.problem, "no memory today");
  EXPECT_EQ(thrown.frame, 2u);
  EXPECT_EQ(measureOne(
                live, 3, [] { return randomPicture(16, 16, 1); }, reference)
                .problem,
            "");
  EXPECT_THROW(live.measure(4, {}, reference), InputError);
  EXPECT_THROW(live.measure(
                   4, [] { return image::Picture{}; }, nullptr),
               InputError);
  EXPECT_NE(measureOne(
                live, 5, [] { return image::Picture{}; }, reference)
                .problem,
            "");
}

TEST(LiveError, TheNewestPictureReplacesTheOneThatWaits) {
  LiveError live;
  const auto reference = referenceOf(randomPicture(16, 16, 2));
  std::atomic<bool> begun{false}, go{false};
  std::atomic<int> made{0};
  live.measure(
      0,
      [&] {
        begun = true;
        while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return randomPicture(16, 16, 1);
      },
      reference, false);
  ASSERT_TRUE(eventually([&] { return begun.load(); }));
  EXPECT_FALSE(live.ready());
  for (uint64_t frame = 1; frame <= 20; ++frame)
    live.measure(
        frame,
        [&] {
          ++made;
          return randomPicture(16, 16, 1);
        },
        reference, false);
  go = true;
  std::vector<uint64_t> frames;
  ASSERT_TRUE(eventually([&] {
    for (const ErrorFigures& f : live.take()) frames.push_back(f.frame);
    return frames.size() == 2 && live.ready();
  }));
  EXPECT_EQ(frames, (std::vector<uint64_t>{0, 20}));
  EXPECT_EQ(made, 1) << "pictures that nobody measures are not made";
  EXPECT_FALSE(live.flip()) << "nobody asked for it";
}

TEST(LiveError, EndsUnderLoad) {
  const auto reference = referenceOf(randomPicture(96, 96, 2));
  const auto picture = [] { return randomPicture(96, 96, 1); };
  for (int i = 0; i < 30; ++i) {
    LiveError live;
    for (uint64_t frame = 0; frame < 20; ++frame) live.measure(frame, picture, reference);
    std::this_thread::sleep_for(std::chrono::milliseconds(i));  // at another place of the work each time
  }
}

TEST(LiveError, FlipStopsWhenItIsTold) {
  const image::Picture a = randomPicture(32, 32, 1), b = randomPicture(32, 32, 2);
  std::stop_source stop;
  EXPECT_EQ(image::hdrFlip(a, b, 67, stop.get_token()), image::hdrFlip(a, b, 67));
  stop.request_stop();
  EXPECT_TRUE(image::hdrFlip(a, b, 67, stop.get_token()).empty());
  const image::Metrics m = image::measure(a, b, {.stop = stop.get_token()});
  EXPECT_TRUE(std::isnan(m.flipMean));
  EXPECT_EQ(m.relMse, image::measure(a, b).relMse);
}

TEST(BackgroundWorker, LosesWhatIsThrownAndGoesOn) {
  std::atomic<int> done{0};
  BackgroundWorker worker;
  worker.post([](const std::stop_token&) { throw std::runtime_error("lost"); });
  ASSERT_TRUE(eventually([&] { return worker.idle(); }));
  worker.post([&](const std::stop_token&) { ++done; });
  EXPECT_TRUE(eventually([&] { return done == 1 && worker.idle(); }));
}

TEST(BackgroundWorker, TellsAJobThatItIsToEnd) {
  std::atomic<bool> begun{false}, told{false}, never{false};
  {
    BackgroundWorker worker;
    worker.post([&](const std::stop_token& stop) {
      begun = true;
      while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      told = true;
    });
    ASSERT_TRUE(eventually([&] { return begun.load(); }));
    worker.post([&](const std::stop_token&) { never = true; });
  }
  EXPECT_TRUE(told);
  EXPECT_FALSE(never) << "what waits is dropped";
}

}  // namespace
}  // namespace weir::view
