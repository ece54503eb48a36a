// The panel: what it draws from plain figures, and what clicks in it ask for.
#include "view/panels/compare_panel.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <limits>

#include "view/panels/trail_plot.h"
#include "view/ui/platform.h"
#include "view/ui/style.h"

namespace weir::view {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TrailPoint pointAt(double milliseconds, double relMse) {
  TrailPoint p;
  p.label = "spatial.radius 6 → 12";
  p.milliseconds = {0.9 * milliseconds, milliseconds, 1.1 * milliseconds};
  p.relMse = {0.9 * relMse, relMse, 1.1 * relMse};
  p.relativeBias = 0.001;
  p.frames = 128;
  p.pictures = 40;
  return p;
}

class ComparePanel : public ::testing::Test {
 protected:
  ComparePanel() {
    model_.state = &state_;
    model_.references = {{"direct light", "/graphs/all_lights.json"}, {"all light", "/graphs/reference.json"}};
  }
  ComparePanelResult frame() {
    platform_.beginFrame({900, 900}, {1, 1}, 1.0 / 60.0);
    marks_.begin();
    Ui ui{marks_, 1.0f};
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({320, 900});
    ImGui::Begin("side");
    const ComparePanelResult result = drawComparePanel(ui, model_);
    ImGui::End();
    ImGui::Render();
    return result;
  }
  /// What a click on a widget brings, in whichever frame.
  ComparePanelResult click(const std::string& name) {
    frame();
    const auto found = marks_.find(name);
    EXPECT_TRUE(found) << name;
    if (!found) return {};
    platform_.feed(mouseMove(found->where.centre()));
    frame();
    platform_.feed(mouseButton(MouseButton::Left, true));
    ComparePanelResult result = frame();
    platform_.feed(mouseButton(MouseButton::Left, false));
    const ComparePanelResult up = frame();
    const auto add = [](auto& to, const auto& from) {
      if (from) to = from;
    };
    add(result.reference, up.reference);
    add(result.budget, up.budget);
    add(result.flip, up.flip);
    result.browse |= up.browse;
    result.startOver |= up.startOver;
    result.forgetTrail |= up.forgetTrail;
    result.copyTrail |= up.copyTrail;
    result.saveTrail |= up.saveTrail;
    return result;
  }
  bool shows(const std::string& name) { return marks_.find(name).has_value(); }

  UiPlatform platform_{1.0f, {}};
  Marks marks_{true};
  ComparisonState state_;
  ComparePanelModel model_;
};

TEST_F(ComparePanel, WithoutAReferenceItAsksForOne) {
  frame();
  EXPECT_TRUE(shows("compare/reference"));
  EXPECT_FALSE(shows("compare/relMSE"));
  EXPECT_FALSE(shows("compare/plot"));
  click("compare/reference");
  EXPECT_EQ(click("compare/reference/all light").reference, "/graphs/reference.json");
  click("compare/reference");
  EXPECT_TRUE(click("compare/reference/file").browse);
  click("compare/reference");
  EXPECT_EQ(click("compare/reference/none").reference, "");
}

TEST_F(ComparePanel, ShowsFiguresAndPoints) {
  state_.compares = true;
  state_.words = "all_lights.json: 312 frames";
  state_.budget = 4.0;
  state_.trailWords = "median of 128 frames and 40 pictures";
  frame();
  EXPECT_TRUE(shows("compare/plot"));
  EXPECT_FALSE(shows("compare/relMSE")) << "nothing is measured yet";
  state_.error = ErrorFigures{1, 1, 312, 1e-5, 0.08, 0.07, -0.001, 3, ""};
  state_.points = {pointAt(4, 0.1), pointAt(6, 0.05)};
  state_.hasCurrent = true;
  state_.front = {0, 1};
  state_.referenceRelMse = 0.06;
  model_.frameMilliseconds = 12.0;
  frame();
  for (const char* name : {"compare/relMSE", "compare/trimmed", "compare/bias", "compare/cost", "compare/budget",
                           "compare/point/0", "compare/point/1"})
    EXPECT_TRUE(shows(name)) << name;
  EXPECT_FALSE(shows("compare/FLIP"));
  // The slower and better one lies to the right and below.
  const auto first = marks_.find("compare/point/0")->where, second = marks_.find("compare/point/1")->where;
  EXPECT_LT(first.low.x, second.low.x);
  EXPECT_LT(first.low.y, second.low.y);
  state_.flip = FlipFigures{1, 1, 0.03, 0.2, 1.5, ""};
  frame();
  EXPECT_TRUE(shows("compare/FLIP"));
  EXPECT_EQ(click("compare/flip").flip, false);
  EXPECT_TRUE(click("compare/forget").forgetTrail);
  EXPECT_TRUE(click("compare/copy").copyTrail);
  EXPECT_TRUE(click("compare/save").saveTrail);
  EXPECT_TRUE(click("compare/start-over").startOver);
  EXPECT_TRUE(click("compare/budget").budget);
  state_.error->problem = "the picture is 16x15 pixels, the reference 16x16";
  frame();
  EXPECT_FALSE(shows("compare/relMSE")) << "the problem stands there instead";
}

TEST_F(ComparePanel, DrawsWhateverThereIs) {
  state_.compares = true;
  state_.points = {pointAt(0, 0), pointAt(1e-30, 1e30), pointAt(1e30, 0), pointAt(4, 1e-300)};
  state_.points[0].relativeBias = kNaN;
  state_.front = {0};
  state_.error = ErrorFigures{1, 1, 0, kNaN, kNaN, kNaN, kNaN, 0, ""};
  state_.warning = std::string(2000, 'w');
  state_.problem = "a problem";
  for (const double floor : {kNaN, 0.0, 1e-300, 1e300}) {
    state_.referenceRelMse = floor;
    EXPECT_NO_THROW(frame());
  }
  platform_.feed(mouseMove(marks_.find("compare/point/1")->where.centre()));
  frame();
  EXPECT_NO_THROW(frame()) << "with the point's words at the mouse";
}

TEST(LogAxis, HoldsItsValues) {
  const LogAxis axis({0.5, 2.0, 0.0, -1.0, kNaN});
  EXPECT_LT(axis.low(), 0.5);
  EXPECT_GT(axis.high(), 2.0);
  EXPECT_NEAR(axis.place(1.0), 0.5, 1e-12) << "halfway between 1/2 and 2";
  EXPECT_EQ(axis.place(0.0), 0.0);
  EXPECT_EQ(axis.place(kNaN), 0.0);
  EXPECT_EQ(axis.place(1e9), 1.0);
  EXPECT_EQ(axis.ticks(), (std::vector<double>{0.5, 1.0, 2.0}));
  const LogAxis one({3.0});
  EXPECT_NEAR(one.place(3.0), 0.5, 1e-12);
  EXPECT_NEAR(std::log10(one.high() / one.low()), 1.0 / 3.0, 1e-12);
  const LogAxis none({});
  EXPECT_EQ(none.low(), 1.0);
  EXPECT_EQ(none.high(), 10.0);
  // From -34.8 to 34.8: every eighth decade from -35 on, whose first lies outside.
  EXPECT_EQ(LogAxis({1e-30, 1e30}).ticks().size(), 8u) << "not all of seventy decades";
  const LogAxis all({1e-307, std::numeric_limits<double>::max()});
  EXPECT_GT(all.low(), 0.0);
  EXPECT_TRUE(std::isfinite(all.high()));
  EXPECT_LE(all.ticks().size(), 12u);
  const LogAxis tiny({std::numeric_limits<double>::denorm_min()});
  EXPECT_GT(tiny.low(), 0.0);
  EXPECT_GT(tiny.high(), tiny.low());
  EXPECT_LE(tiny.ticks().size(), 12u);
}

TEST(TrailPointWords, SayItsFigures) {
  EXPECT_EQ(inWords(pointAt(4.731, 0.0869)),
            "spatial.radius 6 → 12: 4.73 ms, relMSE 0.0869 (0.0782 … 0.0956), bias +0.1 %, of 128 frames and 40 "
            "pictures");
}

}  // namespace
}  // namespace weir::view
