// The window's smaller parts: where panels lie, figures of times, recent files, scenes that are read beside it,
// messages.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>

#include "support/device.h"
#include "view/app/recent_files.h"
#include "view/app/scene_loader.h"
#include "view/engine/messages.h"
#include "view/panels/layout.h"
#include "view/panels/time_panel.h"

namespace weir::view {
namespace {

TEST(Layout, PanelsAndPictureFillTheWindowWithoutOverlap) {
  for (const glm::vec2 window :
       {glm::vec2(1280, 720), glm::vec2(3840, 2160), glm::vec2(320, 240), glm::vec2(500, 900)}) {
    for (const float scale : {1.0f, 2.0f}) {
      const Layout layout = layoutOf(window, 20.0f * scale, scale, LayoutState{});
      const auto area = [](const Rectangle& r) { return r.size().x * r.size().y; };
      EXPECT_NEAR(area(layout.picture) + area(layout.graph) + area(layout.side) + area(layout.times),
                  window.x * (window.y - 20.0f * scale), 1.0f);
      EXPECT_GE(layout.picture.size().x, window.x / 3.0f - 1.0f);
      EXPECT_GT(layout.picture.size().y, window.y / 3.0f);
      EXPECT_EQ(layout.graph.high.x, layout.picture.low.x);
      EXPECT_EQ(layout.side.low.x, layout.picture.high.x);
    }
  }
}

TEST(Layout, ThePictureAloneHasTheWholeWindow) {
  LayoutState state;
  state.all = false;
  const Layout layout = layoutOf({800, 600}, 20.0f, 1.0f, state);
  EXPECT_EQ(layout.picture.size(), glm::vec2(800, 600));
  EXPECT_EQ(layout.graph.size().x, 0.0f);
}

execute::FrameTimes timesOf(double a, double b) {
  execute::FrameTimes t;
  t.gpu = {a, b};
  t.cpu = {0.1, 0.2};
  t.gpuFrame = a + b;
  t.cpuFrame = 0.3;
  return t;
}

TEST(TimeLog, HasMedianAndNinetyFifthOfTheLastFrames) {
  TimeLog log;
  log.setPasses({"a", "b"});
  for (int i = 0; i < 1000; ++i) log.add(timesOf(1.0 + i % 100, 2.0));
  EXPECT_EQ(log.size(), TimeLog::kFrames);
  EXPECT_NEAR(log.passFigures()[0].median, 50.5f, 1.0f);
  EXPECT_NEAR(log.passFigures()[0].p95, 95.5f, 1.0f);
  EXPECT_FLOAT_EQ(log.passFigures()[1].median, 2.0f);
  EXPECT_FLOAT_EQ(log.gpu(0, 0), 100.0f);  // the newest
  EXPECT_FLOAT_EQ(log.gpu(1, 0), 99.0f);
  EXPECT_NEAR(log.gpuFigures().median, 52.5f, 1.0f);
}

TEST(TimeLog, ForgetsTimesOfAnotherGraph) {
  TimeLog log;
  log.setPasses({"a", "b"});
  for (int i = 0; i < 40; ++i) log.add(timesOf(1.0, 2.0));
  log.setPasses({"a", "b"});
  EXPECT_EQ(log.size(), 40u);
  log.setPasses({"a"});
  EXPECT_EQ(log.size(), 0u);
  log.add(timesOf(1.0, 2.0));  // a frame of before
  EXPECT_EQ(log.size(), 0u);
}

TEST(RecentFiles, NewestFirstOnceEachAndKept) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/state/weir/recent";
  {
    RecentFiles recent(file);
    for (int i = 0; i < 30; ++i) recent.add("/scenes/" + std::to_string(i) + ".glb");
    recent.add("/scenes/20.glb");
  }
  const RecentFiles again(file);
  ASSERT_EQ(again.all().size(), 16u);
  EXPECT_EQ(again.all()[0], "/scenes/20.glb");
  EXPECT_EQ(again.all()[1], "/scenes/29.glb");
  EXPECT_EQ(std::count(again.all().begin(), again.all().end(), "/scenes/20.glb"), 1);
}

TEST(RecentFiles, WhereNothingCanBeWrittenNothingIs) {
  RecentFiles recent("/proc/nowhere/recent");
  recent.add("a.glb");
  EXPECT_EQ(recent.all().size(), 1u);
}

SceneLoader::Loaded waitFor(SceneLoader& loader) {
  for (int i = 0; i < 3000; ++i) {
    if (std::optional<SceneLoader::Loaded> loaded = loader.take()) return std::move(*loaded);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {{}, nullptr, "nothing came"};
}

TEST(SceneLoader, ReadsBesideAndSaysWhatIsWrong) {
  SceneLoader loader;
  render::StageOptions options;
  options.scene = test::sourcePath("scenes/cornell.glb");
  loader.load(options, 1.0f);
  EXPECT_TRUE(loader.loading());
  const SceneLoader::Loaded cornell = waitFor(loader);
  ASSERT_NE(cornell.stage, nullptr) << cornell.error;
  EXPECT_FALSE(loader.loading());
  options.scene = test::sourcePath("README.md");
  loader.load(options, 1.0f);
  const SceneLoader::Loaded none = waitFor(loader);
  EXPECT_EQ(none.stage, nullptr);
  EXPECT_NE(none.error.find("README.md"), std::string::npos);
}

TEST(SceneLoader, TheLastOneAskedForIsTheOneThatComes) {
  SceneLoader loader;
  render::StageOptions options;
  for (const char* scene : {"scenes/cornell.glb", "scenes/materials.glb", "scenes/alpha-mask.glb"}) {
    options.scene = test::sourcePath(scene);
    loader.load(options, 1.0f);
  }
  EXPECT_NE(waitFor(loader).options.scene.find("alpha-mask"), std::string::npos);
}

TEST(Messages, ANewerOneOfItsTopicTakesTheOldOnesPlace) {
  Messages messages;
  messages.add(Severity::Error, "shader", "a");
  messages.add(Severity::Error, "shader", "b");
  messages.add(Severity::Error, "graph", "c");
  ASSERT_EQ(messages.all().size(), 2u);
  EXPECT_EQ(messages.all()[0].text, "b");
  messages.clear("shader");
  messages.dismiss(messages.all()[0].number);
  EXPECT_TRUE(messages.all().empty());
  messages.add(Severity::Info, "news", "x");
  messages.add(Severity::Error, "error", "x");
  messages.expire();
  EXPECT_EQ(messages.all().size(), 2u);
  messages.expire(std::chrono::steady_clock::now() + std::chrono::minutes(1));
  ASSERT_EQ(messages.all().size(), 1u);
  EXPECT_EQ(messages.all()[0].topic, "error");
  for (int i = 0; i < 100; ++i) messages.add(i == 50 ? Severity::Error : Severity::Info, std::to_string(i), "x");
  EXPECT_LE(messages.all().size(), 20u);
  EXPECT_TRUE(std::any_of(messages.all().begin(), messages.all().end(),
                          [](const Message& m) { return m.severity == Severity::Error; }));
}

}  // namespace
}  // namespace weir::view
