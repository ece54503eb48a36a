// What the axes show, which configurations are compared, and the front.
#include <weir/chart/axes.h>
#include <weir/chart/log_axis.h>

#include <cmath>
#include <functional>

#include "chart/bench_text.h"

namespace weir::test {
namespace {

using chart::Bench;

std::string refusalOf(const std::function<void()>& work) {
  try {
    work();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Pareto, AsInTheCasesThatThePageSharesWithUs) {
  std::ifstream file(sourcePath("tests/chart/pareto_cases.json"));
  for (const Json& test : Json::parse(file).at("cases")) {
    std::vector<chart::Point> points;
    for (const Json& p : test.at("points")) points.push_back({0, {p[0], p[0], p[0]}, {p[1], p[1], p[1]}});
    std::vector<bool> expected(points.size(), false);
    for (const size_t i : test.at("front")) expected[i] = true;
    EXPECT_EQ(chart::paretoFront(points), expected) << test.at("name");
  }
}

TEST_F(BenchText, Times) {
  const Bench b = chart::readBench({write(bench({configuration("a", 4, 0.5)}))});
  const chart::Configuration& c = b.configurations[0];
  EXPECT_EQ(chart::timeOf(c, "frame").value, 4);
  EXPECT_EQ(chart::timeOf(c, "frame").high, 5);
  EXPECT_EQ(chart::timeOf(c, "no-gbuffer").value, 3);  // without the quarter of gbuffer.Made
  EXPECT_TRUE(std::isnan(chart::timeOf(c, "no-gbuffer").high));
  EXPECT_EQ(chart::timeOf(c, "wall").value, 6);
  EXPECT_EQ(chart::timeOf(c, "pass.pick").value, 2);
  EXPECT_TRUE(std::isnan(chart::timeOf(c, "pass.none").value));
}

TEST_F(BenchText, BiasIsShownByItsSizeAndReachesZeroWhereItMayBeNone) {
  Json sure = configuration("b", 1, 1);
  sure["error"]["bias"] = {{"value", -0.02}, {"low", -0.03}, {"high", -0.01}};
  const Bench b = chart::readBench({write(bench({configuration("a", 4, 0.5), sure}))});
  const chart::Interval maybe = chart::errorOf(b.configurations[0], "bias"),
                        yes = chart::errorOf(b.configurations[1], "bias");
  EXPECT_EQ(maybe.value, 0.01);
  EXPECT_EQ(maybe.low, 0);
  EXPECT_EQ(maybe.high, 0.03);
  EXPECT_EQ(yes.low, 0.01);
  EXPECT_EQ(yes.high, 0.03);
}

TEST_F(BenchText, AxesAreChosenByWhatWasMeasured) {
  Json c = configuration("a", 4, 0.5);
  c["frame"]["gpu_ms"] = nullptr;
  c["error"].erase("relmse");
  const Bench b = chart::readBench({write(bench({c}))});
  EXPECT_EQ(chart::chooseTime(b, "").key, "wall");
  EXPECT_EQ(chart::chooseError(b, "").key, "bias");
  EXPECT_EQ(chart::chooseTime(b, "pass.pick").key, "pass.pick");
  expectHas(refusalOf([&] { chart::chooseTime(b, "pass.pcik"); }),
            "no time is called 'pass.pcik' (nearest is 'pass.pick')");
  expectHas(refusalOf([&] { chart::chooseError(b, "relmse.medain"); }), "nearest is 'relmse.median'");
}

// A front over errors of two scenes, or times of two devices, would compare what can't be compared.
TEST_F(BenchText, GroupsAreScenesSizesAndDevices) {
  Json other = configuration("b", 1, 1), lights = configuration("c", 1, 1), size = configuration("d", 1, 1);
  other["scene"]["file"] = "folder/other.glb";
  lights["scene"]["lights"] = "3 points";
  size["size"] = {32, 32};
  Json device = bench({configuration("e", 1, 1)});
  device["device"] = "Another device";
  const Bench b =
      chart::readBench({write(bench({configuration("a", 1, 1), other, lights, size, configuration("f", 2, 2)})),
                        write(device, "device.json")});
  const std::vector<chart::Group> all = chart::groups(b);
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[0].configurations, (std::vector<size_t>{0, 4}));
  EXPECT_EQ(all[0].label, "made_up.glb, 64×48, Made-up device");
  EXPECT_EQ(all[1].label, "other.glb, 64×48, Made-up device");
  EXPECT_EQ(all[2].label, "made_up.glb, 3 points, 64×48, Made-up device");
  EXPECT_EQ(all[4].label, "made_up.glb, 64×48, Another device");
}

TEST_F(BenchText, AScenesContentTellsItApartWhereItIsKnown) {
  const auto with = [](const char* id, const char* file, const char* digest) {
    Json c = configuration(id, 1, 1);
    c["scene"] = {{"file", file}, {"digest", digest}};
    return c;
  };
  const Bench b = chart::readBench(
      {write(bench({with("a", "here/s.glb", "11"), with("b", "there/s.glb", "11"), with("c", "here/s.glb", "22")}))});
  const std::vector<chart::Group> all = chart::groups(b);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].configurations, (std::vector<size_t>{0, 1}));
  EXPECT_EQ(all[0].label, "here/s.glb");
  EXPECT_EQ(all[1].label, "here/s.glb, 22");
}

TEST_F(BenchText, OnlyWhatALogAxisCanShowIsAPoint) {
  Json none = configuration("b", 1, 1), zero = configuration("c", 1, 1), still = configuration("d", 0, 1),
       below = configuration("e", 1, 1);
  none.erase("error");
  zero["error"]["relmse"]["median"] = {{"value", 0}, {"low", 0}, {"high", 0}};
  below["error"]["relmse"]["median"]["low"] = -1;
  const Bench b = chart::readBench({write(bench({configuration("a", 1, 1), none, zero, still, below}))});
  const std::vector<chart::Point> points = chart::points(b, chart::groups(b)[0], "frame", "relmse.median");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].configuration, 4u);
  EXPECT_TRUE(std::isnan(points[1].error.low));
  EXPECT_EQ(points[1].error.high, 2);
}

TEST(LogAxis, HoldsItsValuesAndItsTicks) {
  for (const std::vector<double>& values :
       {std::vector<double>{4.1}, {4.1, 4.3}, {0.002, 700}, {1e-300, 1e300}, {5e-324}, {}}) {
    const chart::LogAxis axis(values, 100, 500);
    const std::vector<double> ticks = axis.ticks();
    EXPECT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 40u);
    for (const double tick : ticks) {
      EXPECT_GE(axis.at(tick), 99.999);
      EXPECT_LE(axis.at(tick), 500.001);
    }
    for (const double value : values) {
      EXPECT_GE(axis.clipped(value), 100);
      EXPECT_LE(axis.clipped(value), 500);
    }
  }
  const chart::LogAxis axis({1, 100}, 0, 100);
  EXPECT_NEAR(axis.at(10), 50, 1e-9);  // the middle of two decades with equal room
}

}  // namespace
}  // namespace weir::test
