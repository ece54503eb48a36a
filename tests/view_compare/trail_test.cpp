// The live plane of error against time: medians, what is left out, labels, and the front, by hand.
#include <gtest/gtest.h>
#include <weir/graph/compile.h>

#include <cmath>
#include <limits>

#include "view/compare/trail.h"
#include "view/compare/warm_up.h"

namespace weir::view {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// So many frames of one setting from `frame` on.
void fill(Trail& trail, uint64_t& frame, double milliseconds, double relMse, int count = 10) {
  for (int i = 0; i < count; ++i, ++frame) {
    trail.addTime(frame, milliseconds);
    trail.addError(frame, relMse, 0.5 * relMse, 0.125);
  }
}

TrailPoint pointAt(double milliseconds, double relMse) {
  TrailPoint p;
  p.milliseconds = {milliseconds, milliseconds, milliseconds};
  p.relMse = {relMse, relMse, relMse};
  return p;
}

TEST(Trail, QuartilesByInterpolation) {
  const Spread odd = spreadOf({5, 1, 3, 2, 4});
  EXPECT_EQ(odd.low, 2.0);
  EXPECT_EQ(odd.median, 3.0);
  EXPECT_EQ(odd.high, 4.0);
  const Spread even = spreadOf({4, 1, 3, 2});
  EXPECT_EQ(even.low, 1.75);
  EXPECT_EQ(even.median, 2.5);
  EXPECT_EQ(even.high, 3.25);
  EXPECT_EQ(spreadOf({7}).high, 7.0);
}

TEST(Trail, TheMedianOfTheNewest) {
  Trail trail({.window = 5, .fewest = 3, .old = 4});
  EXPECT_FALSE(trail.current());
  for (uint64_t f = 0; f < 9; ++f) {
    trail.addTime(f, 1.0 + double(f));
    trail.addError(f, 0.1 * double(f), 0.05 * double(f), f % 2 == 0 ? 0.5 : -0.5);
    EXPECT_EQ(trail.current().has_value(), f >= 2);
  }
  const TrailPoint p = *trail.current();  // frames 4 … 8
  EXPECT_EQ(p.milliseconds.median, 7.0);
  EXPECT_EQ(p.milliseconds.low, 6.0);
  EXPECT_EQ(p.milliseconds.high, 8.0);
  EXPECT_DOUBLE_EQ(p.relMse.median, 0.6);
  EXPECT_DOUBLE_EQ(p.relMseTrimmed, 0.3);
  EXPECT_DOUBLE_EQ(p.relativeBias, 0.1);
  EXPECT_EQ(p.frames, 5u);
  EXPECT_EQ(p.pictures, 5u);
  EXPECT_EQ(p.label, "start");
}

TEST(Trail, WhatIsNoFigureIsIgnored) {
  Trail trail({.window = 8, .fewest = 1, .old = 4});
  for (const double none : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) trail.addTime(0, none);
  trail.addError(0, kNaN, 0, 0);
  trail.addError(0, std::numeric_limits<double>::infinity(), 0, 0);
  EXPECT_FALSE(trail.current());
  EXPECT_NE(trail.words().find("measures none"), std::string::npos) << trail.words();
  trail.addTime(1, 2.0);
  trail.addError(1, 0.0, 0.0, kNaN);
  ASSERT_TRUE(trail.current());
  EXPECT_EQ(trail.current()->relMse.median, 0.0) << "no error at all is one";
  EXPECT_TRUE(std::isnan(trail.current()->relativeBias));
}

TEST(Trail, AFrameThatIsMeasuredAgainCountsOnce) {
  Trail trail({.window = 8, .fewest = 1, .old = 4});
  trail.addTime(3, 1.0);
  for (const double relMse : {0.3, 0.2, 0.1}) trail.addError(3, relMse, relMse, 0.0);
  EXPECT_EQ(trail.current()->pictures, 1u);
  EXPECT_EQ(trail.current()->relMse.median, 0.1);
}

TEST(Trail, FramesAfterAChangeAreLeftOut) {
  Trail trail({.window = 64, .fewest = 2, .old = 4});
  trail.warmUp(10, "the history fills");
  uint64_t frame = 0;
  fill(trail, frame, 1.0, 0.5);
  trail.change(frame, {"spatial.radius", "6", "12"});
  for (int i = 0; i < 10; ++i) {
    trail.addTime(frame, 100.0);
    trail.addError(frame, 100.0, 100.0, 100.0);
    EXPECT_EQ(trail.words(), i < 9 ? std::to_string(i + 1) + " of 10 frames left out: the history fills"
                                   : "median of 0 frames and 0 pictures: at least 2 of each are wanted");
    ++frame;
  }
  EXPECT_FALSE(trail.current());
  trail.addError(frame - 1, 100.0, 100.0, 100.0);  // one that was under way
  fill(trail, frame, 2.0, 0.25, 4);
  EXPECT_EQ(trail.words(), "median of 4 frames and 4 pictures");
  EXPECT_EQ(trail.current()->milliseconds.high, 2.0);
  EXPECT_EQ(trail.current()->relMse.high, 0.25);
  EXPECT_EQ(trail.current()->label, "spatial.radius 6 → 12");
  ASSERT_EQ(trail.old().size(), 1u);
  EXPECT_EQ(trail.old()[0].label, "start");
  EXPECT_EQ(trail.old()[0].relMse.median, 0.5);
}

TEST(Trail, AKnobThatIsDraggedLeavesItsEnds) {
  Trail trail({.window = 64, .fewest = 2, .old = 8});
  uint64_t frame = 0;
  fill(trail, frame, 1.0, 0.5);
  for (int radius = 6; radius < 12; ++radius) {
    trail.change(frame, {"spatial.radius", std::to_string(radius), std::to_string(radius + 1)});
    fill(trail, frame, 1.0, 0.5, 1);  // one frame each is no point
  }
  trail.change(frame, {"spatial", "on", "off"});
  fill(trail, frame, 2.0, 0.25);
  EXPECT_EQ(trail.old().size(), 1u);
  EXPECT_EQ(trail.current()->label, "spatial.radius 6 → 12, spatial on → off");
  trail.change(frame, {"a", "1", "2"});
  trail.change(frame, {"a", "2", "1"});
  fill(trail, frame, 2.0, 0.25);
  EXPECT_EQ(trail.current()->label, "as before");
}

TEST(Trail, SomethingElseIsShown) {
  Trail trail({.window = 64, .fewest = 2, .old = 8});
  uint64_t frame = 0;
  fill(trail, frame, 1.0, 0.5);
  trail.change(frame, {"a", "1", "2"});
  fill(trail, frame, 2.0, 0.25);
  trail.restart(frame);
  EXPECT_TRUE(trail.old().empty());
  EXPECT_FALSE(trail.current());
  fill(trail, frame, 2.0, 0.25);
  EXPECT_EQ(trail.current()->label, "start");
}

TEST(Trail, TheFrontByHand) {
  const std::vector<TrailPoint> points = {pointAt(4, 1), pointAt(2, 3), pointAt(3, 3),  // beaten by the second
                                          pointAt(1, 5), pointAt(4, 2),                 // beaten by the first
                                          pointAt(2, 3), pointAt(1, 6)};                // a twin; beaten by the fourth
  EXPECT_EQ(paretoFront(points), (std::vector<size_t>{3, 1, 5, 0}));
  EXPECT_TRUE(paretoFront({}).empty());
}

TEST(Trail, OldPointsThatAreBeatenGoFirst) {
  Trail trail({.window = 64, .fewest = 2, .old = 3});
  uint64_t frame = 0;
  // The first is on the front; the second is beaten by it, and goes when there are four.
  const std::vector<std::pair<double, double>> settings = {{1, 1}, {2, 2}, {0.5, 3}, {3, 0.5}, {9, 9}};
  for (size_t i = 0; i < settings.size(); ++i) {
    if (i > 0) trail.change(frame, {"knob", std::to_string(i - 1), std::to_string(i)});
    fill(trail, frame, settings[i].first, settings[i].second);
  }
  ASSERT_EQ(trail.old().size(), 3u);
  EXPECT_EQ(trail.old()[0].relMse.median, 1.0);
  EXPECT_EQ(trail.old()[1].relMse.median, 3.0);
  EXPECT_EQ(trail.old()[2].relMse.median, 0.5);
  EXPECT_EQ(trail.front(), (std::vector<size_t>{1, 0, 2}));
  // All are on the front: the oldest goes.
  trail.change(frame, {"knob", "4", "5"});
  fill(trail, frame, 0.25, 4);
  trail.change(frame, {"knob", "5", "6"});
  ASSERT_EQ(trail.old().size(), 3u);
  EXPECT_EQ(trail.old()[0].relMse.median, 3.0);
}

TEST(Trail, AsText) {
  Trail trail({.window = 64, .fewest = 2, .old = 8});
  uint64_t frame = 0;
  fill(trail, frame, 1.5, 0.5);
  trail.change(frame, {"say \"x\"", "1", "2"});
  trail.change(frame, {"b", "1", "2"});
  fill(trail, frame, 2.0, 0.75);
  EXPECT_EQ(trail.csv(),
            "label,gpu_ms,gpu_ms_q1,gpu_ms_q3,rel_mse,rel_mse_q1,rel_mse_q3,rel_mse_trimmed,relative_bias,frames,"
            "pictures,pareto,current\n"
            "start,1.5,1.5,1.5,0.5,0.5,0.5,0.25,0.125,10,10,1,0\n"
            "\"say \"\"x\"\" 1 → 2, b 1 → 2\",2,2,2,0.75,0.75,0.75,0.375,0.125,10,10,0,1\n");
}

TEST(WarmUp, FollowsTheMemoryThatPassesState) {
  PassDescription description;
  graph::CompiledGraph graph;
  EXPECT_EQ(warmUpOf(graph).frames, 2u) << "those in flight";
  graph.resources.resize(1);
  graph.resources[0].history = true;
  EXPECT_EQ(warmUpOf(graph).frames, 40u) << "nobody says how long it remembers";
  description.param("cap", 20).unit("frames");
  description.param("radius", 300).unit("px");
  graph::CompiledPass pass;
  pass.name = "temporal";
  pass.description = &description;
  pass.params.emplace("cap", 30);
  pass.params.emplace("radius", 300);
  graph.passes.push_back(pass);
  EXPECT_EQ(warmUpOf(graph).frames, 40u) << "a pass that does not read the past has no memory";
  graph.passes[0].inputs.push_back({"history", 0, true});
  const WarmUp warmUp = warmUpOf(graph);
  EXPECT_EQ(warmUp.frames, 60u);
  EXPECT_EQ(warmUp.reason, "the history fills (temporal.cap is 30)");
  graph.passes[0].params["cap"] = 100000;
  EXPECT_EQ(warmUpOf(graph).frames, 512u);
  graph.passes[0].params["cap"] = 0;
  EXPECT_EQ(warmUpOf(graph).frames, 40u) << "0 says: for ever";
}

}  // namespace
}  // namespace weir::view
