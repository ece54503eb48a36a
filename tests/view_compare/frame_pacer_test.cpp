// How many frames fit into what steps are granted, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "view/compare/frame_pacer.h"

namespace weir::view {
namespace {

int framesIn(FramePacer& pacer, double milliseconds) {
  pacer.grant(milliseconds);
  int frames = 0;
  while (pacer.affords() && frames < 1000) {
    pacer.spend();
    ++frames;
  }
  return frames;
}

/// One that knows what a frame takes.
FramePacer pacerOf(double milliseconds) {
  FramePacer pacer;
  pacer.measured(1000.0 * milliseconds);  // the first one, which does not count
  pacer.measured(milliseconds);
  return pacer;
}

TEST(FramePacer, OneAStepWhileNothingIsKnown) {
  FramePacer pacer;
  EXPECT_FALSE(pacer.affords());
  EXPECT_EQ(framesIn(pacer, 1e9), 1);
  EXPECT_EQ(framesIn(pacer, 0.001), 1);
  EXPECT_EQ(framesIn(pacer, 0.0), 0);
  EXPECT_EQ(framesIn(pacer, -5.0), 0);
  EXPECT_EQ(framesIn(pacer, std::nan("")), 0);
  for (const double nothing : {0.0, -1.0, double(NAN), double(INFINITY)}) pacer.measured(nothing);
  EXPECT_FALSE(pacer.cost());
  EXPECT_EQ(framesIn(pacer, 5.0), 1);
}

TEST(FramePacer, AsManyAsFit) {
  FramePacer pacer = pacerOf(2.0);
  EXPECT_EQ(framesIn(pacer, 8.0), 4);
  EXPECT_EQ(framesIn(pacer, 9.0), 4) << "1 ms is left over";
  EXPECT_EQ(framesIn(pacer, 9.0), 4) << "and is not saved up beyond a step's share";
  EXPECT_EQ(framesIn(pacer, 0.0), 0);
}

TEST(FramePacer, LongFramesWaitForTheirTurn) {
  FramePacer pacer = pacerOf(8.0);
  int frames = 0;
  for (int step = 0; step < 400; ++step) frames += framesIn(pacer, 2.0);
  EXPECT_EQ(frames, 100) << "a quarter of the steps, so that the share is kept";
}

TEST(FramePacer, TheFirstFrameDoesNotCount) {
  FramePacer pacer;
  pacer.measured(3000.0);
  EXPECT_FALSE(pacer.cost()) << "it would keep the next one waiting for as long";
  EXPECT_EQ(framesIn(pacer, 1.0), 1);
  pacer.measured(2.0);
  EXPECT_EQ(pacer.cost(), 2.0);
}

TEST(FramePacer, TheMedianOfTheLastNine) {
  FramePacer pacer = pacerOf(1.0);
  pacer.measured(500.0);
  EXPECT_EQ(pacer.cost(), 1.0) << "one that was held up does not count";
  for (int i = 0; i < 6; ++i) pacer.measured(4.0);
  EXPECT_EQ(pacer.cost(), 4.0);
  for (int i = 0; i < 9; ++i) pacer.measured(3.0);
  EXPECT_EQ(pacer.cost(), 3.0);
  for (int i = 0; i < 4; ++i) pacer.measured(5.0);
  EXPECT_EQ(pacer.cost(), 3.0) << "five of nine";
  pacer.measured(5.0);
  EXPECT_EQ(pacer.cost(), 5.0);
  pacer.forget();
  EXPECT_FALSE(pacer.cost());
}

}  // namespace
}  // namespace weir::view
