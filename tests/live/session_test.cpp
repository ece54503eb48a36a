// Files are edited while a graph runs: the next frame shows it, the scene stays loaded, history goes on where it can,
// and a broken edit changes nothing but is told.
#include <weir/live/session.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "execute/graph_run.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

/// What it wrote last frame and a step more; a fixed word where it has no last frame.
class Count final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("before", perPixel<Word>()).optional();
    d.output("after", perPixel<Word>());
    d.param("step", 1);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("count.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

constexpr const char* kShader = R"(#include "step.glsl"
void run(uvec2 pixel) {
  const uint i = pixel.y * frameWidth + pixel.x;
#ifdef has_in_before
  const uint before = in_before[i].value;
#else
  const uint before = 7u;
#endif
  out_after[i].value = before + stepOf(uint(param_step));
}
)";

class Live : public ::testing::Test {
 protected:
  void SetUp() override {
    write("count.glsl", kShader);
    write("step.glsl", "uint stepOf(uint p) { return p; }\n");
    writeGraph(1);
    const std::vector<WeirPassEntry> passes = {passEntry<Count>("Count")};
    registry_.add("own", passes, folder_.path());
    compileOptions_.width = compileOptions_.height = 8;
    compileOptions_.keepAll = true;
    session_ = std::make_unique<live::Session>(*device_, compiler_, registry_, scene_, graphFile(), graph::Overrides{},
                                               compileOptions_, execute::ExecutorOptions{});
  }
  std::string graphFile() const { return folder_.path() + "/graph.json"; }
  /// As an editor saves: another file, renamed over the old one.
  void write(const std::string& name, const std::string& text) {
    const std::string temporary = folder_.write(name + ".new", text);
    fs::rename(temporary, folder_.path() + "/" + name);
  }
  void writeGraph(int step, const std::string& more = "") {
    write("graph.json",
          R"({"version": 1, "passes": {"c": {"type": "own.Count", "inputs": {"before": "c.after@previous"},
      "params": {"step": )" +
              std::to_string(step) + "}}" + more + R"(}, "outputs": {"o": "c.after"}})");
  }
  uint32_t frame(const std::string& resource = "c.after") {
    session_->executor().frame(input_);
    ++input_.index;
    uint32_t value = 0;
    std::memcpy(&value, session_->executor().readResource(resource).data(), sizeof value);
    return value;
  }
  /// The one event that there must be.
  live::Event only(live::Event::Kind kind) {
    const std::vector<live::Event> events = session_->poll();
    EXPECT_EQ(events.size(), 1u);
    if (events.size() != 1) return {};
    EXPECT_EQ(events[0].kind, kind);
    return events[0];
  }

  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_{*device_};
  TemporaryFolder folder_;
  Registry registry_;
  shader::Compiler compiler_;
  scene::Scene source_;
  scene::PreparedScene prepared_ = scene::prepareScene(source_);
  scene::SceneGpu scene_{*device_, source_, prepared_, false};
  graph::CompileOptions compileOptions_;
  std::unique_ptr<live::Session> session_;
  execute::FrameInput input_;
};

TEST_F(Live, NothingChangedIsNoEvent) {
  EXPECT_EQ(frame(), 1001u);
  EXPECT_TRUE(session_->poll().empty());
  EXPECT_EQ(frame(), 1002u);
}

TEST_F(Live, AnEditedShaderShowsInTheNextFrame) {
  frame();
  write("step.glsl", "uint stepOf(uint p) { return 10u * p; }\n");  // an included file, by the way
  const live::Event event = only(live::Event::Kind::Shader);
  EXPECT_EQ(event.error, "");
  ASSERT_EQ(event.files.size(), 1u);
  EXPECT_TRUE(event.files[0].ends_with("step.glsl")) << event.files[0];
  EXPECT_EQ(frame(), 1011u) << "history goes on";
  EXPECT_TRUE(session_->poll().empty());
}

TEST_F(Live, ABrokenShaderIsToldAndTheOldOneGoesOnUntilItIsMended) {
  frame();
  write("step.glsl", "uint stepOf(uint p) { return q; }\n");
  const live::Event broken = only(live::Event::Kind::Shader);
  EXPECT_NE(broken.error.find("step.glsl:1"), std::string::npos) << broken.error;
  EXPECT_NE(broken.error.find("'q'"), std::string::npos) << broken.error;
  EXPECT_EQ(frame(), 1002u);
  EXPECT_TRUE(session_->poll().empty()) << "it is told once";
  fs::remove(folder_.path() + "/step.glsl");
  EXPECT_NE(only(live::Event::Kind::Shader).error, "");
  EXPECT_EQ(frame(), 1003u);
  write("step.glsl", "uint stepOf(uint p) { return 100u; }\n");
  EXPECT_EQ(only(live::Event::Kind::Shader).error, "");
  EXPECT_EQ(frame(), 1103u);
}

TEST_F(Live, WhatOnlyTheBrokenVersionReadsIsLookedAtToo) {
  frame();
  write("count.glsl", std::string("#include \"extra.glsl\"\n") + kShader);
  EXPECT_NE(only(live::Event::Kind::Shader).error.find("extra.glsl"), std::string::npos);
  EXPECT_EQ(frame(), 1002u);
  write("extra.glsl", "nonsense\n");
  EXPECT_NE(only(live::Event::Kind::Shader).error.find("extra.glsl:1"), std::string::npos);
  write("extra.glsl", "// nothing\n");
  EXPECT_EQ(only(live::Event::Kind::Shader).error, "");
  EXPECT_EQ(frame(), 1003u);
}

TEST_F(Live, WhatTheBrokenVersionReadsNoMoreIsLookedAtStill) {
  frame();
  write("count.glsl", "nonsense\n");
  EXPECT_NE(only(live::Event::Kind::Shader).error, "");
  write("step.glsl", "uint stepOf(uint p) { return 5u; }\n");
  EXPECT_NE(only(live::Event::Kind::Shader).error, "") << "noticed, though nothing comes of it yet";
  write("count.glsl", kShader);
  EXPECT_EQ(only(live::Event::Kind::Shader).error, "");
  EXPECT_EQ(frame(), 1006u);
}

TEST_F(Live, AnEditedGraphIsTakenAndHistoryGoesOnWherePortsAreUnchanged) {
  frame();
  writeGraph(50);
  EXPECT_EQ(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1051u);
  writeGraph(1, R"(, "d": {"type": "own.Count", "inputs": {"before": "d.after@previous"}})");
  EXPECT_EQ(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1052u) << "a pass more, which nothing needs, changes nothing";
}

TEST_F(Live, ABrokenGraphIsToldWithItsLinesAndTheOldOneGoesOn) {
  frame();
  write("graph.json",
        "{\n\"version\": 1,\n\"passes\": {\"c\": {\"type\": \"own.Cuont\"}},\n\"outputs\": {\"o\": \"c.aftre\"}}");
  const std::string error = only(live::Event::Kind::Graph).error;
  EXPECT_NE(error.find("graph.json:3"), std::string::npos) << error;
  EXPECT_NE(error.find("own.Count"), std::string::npos) << error;
  EXPECT_EQ(frame(), 1002u);
  write("graph.json", "{ half a fi");
  EXPECT_NE(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1003u);
  writeGraph(2);
  EXPECT_EQ(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1005u);
}

TEST_F(Live, AShaderThatWasEditedWhileTheGraphWasBrokenIsNotForgotten) {
  frame();
  write("graph.json", "{ half a fi");
  write("step.glsl", "uint stepOf(uint p) { return 30u; }\n");
  for (const live::Event& event : session_->poll()) EXPECT_NE(event.error, "");
  EXPECT_EQ(frame(), 1002u);
  writeGraph(1);
  EXPECT_EQ(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1032u);
}

TEST_F(Live, OverridesStayInForceOverEdits) {
  graph::Overrides overrides;
  overrides.set = {"c.step=9"};
  session_->change(overrides, compileOptions_);
  EXPECT_EQ(frame(), 1009u);
  writeGraph(2);
  EXPECT_EQ(only(live::Event::Kind::Graph).error, "");
  EXPECT_EQ(frame(), 1018u);
  overrides.set = {"c.stpe=9"};
  EXPECT_THROW(session_->change(overrides, compileOptions_), graph::GraphError);
  EXPECT_EQ(frame(), 1027u) << "a bad change changes nothing";
  compileOptions_.width = 12;
  session_->change({}, compileOptions_);
  EXPECT_EQ(frame(), 1002u) << "another size starts anew";
}

/// The two versions of a plugin that the plugin tests are about, in a folder of our own.
class LivePlugin : public ::testing::Test {
 protected:
  void SetUp() override {
    manifest(1);
    folder_.write("graph.json",
                  R"({"version": 1, "passes": {"p": {"type": "live.Paint"}}, "outputs": {"o": "p.word"}})");
    registry_ = std::make_unique<Registry>(std::vector<fs::path>{folder_.path()});
    graph::CompileOptions options;
    options.width = options.height = 8;
    session_ = std::make_unique<live::Session>(*device_, compiler_, *registry_, scene_, folder_.path() + "/graph.json",
                                               graph::Overrides{}, options, execute::ExecutorOptions{});
  }
  /// Puts a version of the library where the manifest points, as a build does.
  void manifest(int version) {
    const fs::path library = fs::path(folder_.path()) / "libweir_live.so";
    const fs::path built =
        fs::path(WEIR_BINARY_DIR) / "tests/live/plugins" / ("libweir_live_" + std::to_string(version) + ".so");
    fs::copy_file(built, library.string() + ".new");
    fs::rename(library.string() + ".new", library);
    folder_.write("weir_live.json", R"({"name": "live", "library": "libweir_live.so", "abi": )" +
                                        std::to_string(WEIR_ABI_VERSION) + R"(, "buildTag": ")" + WEIR_BUILD_TAG +
                                        R"(", "shaders": ")" + sourcePath("tests/live/shaders") + "\"}");
  }
  uint32_t frame() {
    session_->executor().frame({});
    uint32_t value = 0;
    std::memcpy(&value, session_->executor().readResource("p.word").data(), sizeof value);
    return value;
  }

  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_{*device_};
  TemporaryFolder folder_;
  std::unique_ptr<Registry> registry_;
  shader::Compiler compiler_;
  scene::Scene source_;
  scene::PreparedScene prepared_ = scene::prepareScene(source_);
  scene::SceneGpu scene_{*device_, source_, prepared_, false};
  std::unique_ptr<live::Session> session_;
};

TEST_F(LivePlugin, ARebuiltPluginIsTakenWithItsCodeAndItsDescription) {
  EXPECT_EQ(frame(), 1u);
  EXPECT_EQ(registry_->find("live.Paint")->params.size(), 0u);
  manifest(2);
  const std::vector<live::Event> events = session_->poll();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, live::Event::Kind::Plugin);
  EXPECT_EQ(events[0].error, "");
  EXPECT_EQ(frame(), 2u) << "the code of the new library";
  EXPECT_EQ(registry_->find("live.Paint")->params.size(), 1u);
}

TEST_F(LivePlugin, AGraphOfBeforeAReloadIsNotMixedWithTheNewCode) {
  EXPECT_EQ(frame(), 1u);
  manifest(2);
  registry_->reload("live");
  EXPECT_THROW(session_->executor().reloadShaders(), RuntimeError);
  EXPECT_EQ(frame(), 1u);
}

TEST_F(LivePlugin, ALibraryThatTheGraphIsWaitingForIsLookedAt) {
  const std::string graph = folder_.path() + "/graph.json",
                    good = R"({"type": "live.Paint", "params": {"strength": 0.5}})";
  folder_.write("graph.json", R"({"version": 1, "passes": {"p": )" + good + R"(}, "outputs": {"o": "p.word"}})");
  ASSERT_EQ(session_->poll().size(), 1u);
  EXPECT_EQ(frame(), 1u) << "version 1 has no such parameter";
  manifest(2);
  for (const live::Event& event : session_->poll()) EXPECT_EQ(event.error, "");
  EXPECT_EQ(frame(), 2u);
}

TEST_F(LivePlugin, HistoryOfAnotherLayoutStartsAnew) {
  folder_.write("graph.json", R"({"version": 1, "passes": {"p": {"type": "live.Paint",
      "inputs": {"before": "p.word@previous"}}}, "outputs": {"o": "p.word"}})");
  ASSERT_EQ(session_->poll().size(), 1u);
  EXPECT_EQ(frame(), 1u);
  EXPECT_EQ(frame(), 2u);
  manifest(2);  // its words are of another version, as large as before
  for (const live::Event& event : session_->poll()) EXPECT_EQ(event.error, "");
  EXPECT_EQ(frame(), 2u) << "nothing of the old words";
  EXPECT_EQ(frame(), 4u);
}

TEST_F(LivePlugin, ABrokenLibraryIsToldAndTheOldOneGoesOn) {
  EXPECT_EQ(frame(), 1u);
  const std::string library = folder_.write("libweir_live.so.new", "no library at all");
  fs::rename(library, folder_.path() + "/libweir_live.so");
  const std::vector<live::Event> events = session_->poll();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_NE(events[0].error.find("live"), std::string::npos) << events[0].error;
  EXPECT_EQ(frame(), 1u);
  manifest(2);
  ASSERT_EQ(session_->poll().size(), 1u);
  EXPECT_EQ(frame(), 2u);
}

}  // namespace
}  // namespace weir::test
