// What a pass declared it has, what it didn't it can't reach; mistakes name the pass and what it asked for.
#include "execute/graph_run.h"

namespace weir::test {
namespace {

using execute::KernelKind;

/// What the test's pass does in prepare() and record().
std::function<void(PrepareContext&)> onPrepare;
std::function<void(RecordContext&)> onRecord;
bool declaresDrawing = false;

class Scripted final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("maybe", perPixel<Word>()).optional();
    d.output("to", perPixel<Word>());
    d.param("amount", 2).range(0, 9);
    d.needs(Need::FrameIndex);
    if (declaresDrawing) d.rasterises();
  }
  void prepare(PrepareContext& c) override { onPrepare(c); }
  void record(RecordContext& c) override {
    if (onRecord) onRecord(c);
  }
};

const std::string kIt = R"({"it": {"type": "own.Scripted"}})";

/// The message of what preparing (and, when given, one frame) throws.
std::string thrown(std::function<void(PrepareContext&)> prepare, std::function<void(RecordContext&)> record = {},
                   const std::string& shaders = sourcePath("tests/execute/shaders")) {
  onPrepare = std::move(prepare);
  onRecord = std::move(record);
  try {
    GraphRun g(kIt, "it.to", {passEntry<Scripted>("Scripted")}, {.shaders = shaders});
    g.run();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing was thrown";
}

void expectWords(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' in: " << text;
}

TEST(Contexts, AskingForWhatIsNotDeclaredNamesPassAndName) {
  expectWords(thrown([](PrepareContext& c) { (void)c.integer("amuont"); }),
              {"it", "own.Scripted", "'amuont'", "'amount'"});
  expectWords(thrown([](PrepareContext& c) { (void)c.number("amount"); }),
              {"it", "own.Scripted", "'amount'", "another type"});
  expectWords(thrown([](PrepareContext& c) { (void)c.connected("perhaps"); }), {"it", "own.Scripted", "'perhaps'"});
  expectWords(thrown([](PrepareContext& c) { (void)c.rayKernel("any.glsl"); }),
              {"it", "own.Scripted", "scene.acceleration"});
  expectWords(thrown([](PrepareContext& c) { (void)c.lights(); }), {"it", "own.Scripted", "scene.lights"});
  expectWords(thrown([](PrepareContext& c) { c.lightTree(); }), {"it", "own.Scripted", "scene.lights"});
  expectWords(thrown([](PrepareContext& c) { (void)c.rasterKernel("any.glsl", "nowhere"); }),
              {"it", "own.Scripted", "rasterises"});
  declaresDrawing = true;
  expectWords(thrown([](PrepareContext& c) { (void)c.rasterKernel("any.glsl", "nowhere"); }), {"it", "nowhere"});
  declaresDrawing = false;
  expectWords(thrown([](PrepareContext&) {}, [](RecordContext& c) { c.launch(Kernel{}); }),
              {"it", "own.Scripted", "never prepared"});
}

TEST(Contexts, WhatIsDeclaredIsAnswered) {
  int amount = 0;
  bool open = true;
  EXPECT_EQ(thrown([&](PrepareContext& c) {
              amount = c.integer("amount");
              open = c.connected("maybe");
            }),
            "nothing was thrown");
  EXPECT_EQ(amount, 2);
  EXPECT_FALSE(open);
}

TEST(Contexts, ShaderErrorsNameFileAndLine) {
  const TemporaryFolder folder;
  folder.write("broken.glsl", "// one\n// two\nvoid run(uvec2 p) { out_to[0].value = nonsense; }\n");
  folder.write("port.glsl", "void run(uvec2 p) {\n  out_too[0].value = 1u;\n}\n");
  folder.write("open.glsl", "void run(uvec2 p) {\n\n\n  out_to[0].value = in_maybe[0].value;\n}\n");
  folder.write("camera.glsl", "void run(uvec2 p) {\n  out_to[0].value = uint(camera.origin.x);\n}\n");
  folder.write("scene.glsl", "void run(uvec2 p) { out_to[0].value = sceneTriangles[0].x; }\n");
  const auto with = [&](const char* file) {
    return thrown([file](PrepareContext& c) { (void)c.kernel(file); }, {}, folder.path());
  };
  expectWords(with("broken.glsl"), {"broken.glsl:3", "nonsense"});
  expectWords(with("port.glsl"), {"port.glsl:2", "out_too"});
  expectWords(with("open.glsl"), {"open.glsl:4", "in_maybe"});
  expectWords(with("camera.glsl"), {"camera.glsl:2", "camera"});
  expectWords(with("scene.glsl"), {"scene.glsl:1", "sceneTriangles"});
  expectWords(with("brokn.glsl"), {"there is no shader 'brokn.glsl'", "nearest: 'broken.glsl'"});
}

TEST(Contexts, ScratchComesBeforeKernelsAndBindsByName) {
  const TemporaryFolder folder;
  folder.write("ok.glsl", "void run(uvec2 p) {}\n");
  expectWords(thrown(
                  [](PrepareContext& c) {
                    (void)c.kernel("ok.glsl");
                    c.scratch("late", perPixel<Word>());
                  },
                  {}, folder.path()),
              {"it", "'late'", "before the first kernel"});
  expectWords(thrown(
                  [](PrepareContext& c) {
                    (void)c.kernel("ok.glsl", {.bind = {{"out_to", "scratch_none"}}, .defines = {}, .sources = {}});
                  },
                  {}, folder.path()),
              {"it", "'scratch_none'"});
}

// ------------------------------------------------------------------------------------------------ prelude

class Plain final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("left", perPixel<Word>());
    d.output("right", storageImage(Format::RG32F));
    d.param("one", 1.0f);
    d.param("name", "text");
    d.param("two", 2).specialises();
    d.param("three", true);
  }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};
class Feeder final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("words", perPixel<Word>()); }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};
template <Need kNeed>
class Needs final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.output("words", perPixel<Word>());
    d.needs(kNeed);
  }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};

/// The prelude of pass `it`.
std::string preludeOf(const WeirPassEntry& entry, const std::string& inputs, KernelKind kind = KernelKind::Compute,
                      const scene::SceneTraits& traits = {}) {
  Registry registry;
  const WeirPassEntry entries[] = {entry, passEntry<Feeder>("Feeder")};
  registry.add("own", entries);
  std::vector<graph::Diagnostic> diagnostics;
  const std::string output = registry.find(std::string("own.") + entry.name)->outputs.at(0).name;
  const std::string json =
      std::string(R"({"version": 1, "name": "t", "passes": {"feeder": {"type": "own.Feeder"}, "it": {"type": "own.)") +
      entry.name + R"(", "inputs": {)" + inputs + R"(}}}, "outputs": {"o": "it.)" + output + "\"}}";
  const auto description = graph::parse(json, "t", diagnostics);
  const graph::CompiledGraph compiled = graph::compile(description, registry.catalog(), 8, 8, diagnostics);
  if (!diagnostics.empty()) throw graph::GraphError(diagnostics);
  for (const graph::CompiledPass& pass : compiled.passes) {
    if (pass.name != "it") continue;
    execute::KernelInterface interface;
    interface.graph = &compiled;
    interface.pass = &pass;
    interface.scratch.push_back({"spare", perPixel<Word>(), 3});
    interface.textures.emplace_back("lut", true);
    interface.traits = traits;
    return execute::kernelSource(interface, kind, "body.glsl");
  }
  return "no such pass";
}

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(Prelude, NamesEverythingThatIsDeclared) {
  const std::string s = preludeOf(passEntry<Plain>("Plain"), R"("left": "feeder.words")");
  for (const char* words :
       {"in_left[]", "readonly buffer Block_in_left", "rg32f)  uniform image2D out_right", "scratch_spare[]",
        "scratch_spare_count = 3u", "sampler3D texture_lut", "param_one", "param_three", "#include \"body.glsl\"",
        "layout(constant_id = 0) const int param_two", "struct Word"}) {
    EXPECT_TRUE(holds(s, words)) << words << " in:\n" << s;
  }
  EXPECT_FALSE(holds(s, "param_name")) << "texts have no place in shaders";
  // Bindings of set 1 count through inputs, outputs, scratch and textures.
  EXPECT_TRUE(holds(s, "set = 1, binding = 0, std430) readonly buffer Block_in_left"));
  EXPECT_TRUE(holds(s, "set = 1, binding = 3) uniform sampler3D texture_lut"));
  EXPECT_EQ(s.find("in_left[]"), s.rfind("in_left[]"));
}

TEST(Prelude, LeavesOutWhatIsNotDeclared) {
  const struct {
    WeirPassEntry entry;
    std::vector<const char*> there, absent;
  } cases[] = {
      {passEntry<Plain>("Plain"),
       {},
       {"scenePositions", "sceneMaterials", "sceneLights", "Camera camera;", "frameIndex", "CAN_TRACE"}},
      {passEntry<Needs<Need::SceneGeometry>>("G"),
       {"scenePositions", "sceneInstances"},
       {"sceneMaterials[]", "sceneLights[]", "Camera camera;"}},
      {passEntry<Needs<Need::SceneMaterials>>("M"),
       {"sceneMaterials", "sceneTextures"},
       {"sceneLights[]", "sceneAcceleration"}},
      {passEntry<Needs<Need::SceneLights>>("L"),
       {"sceneLights[]", "sceneAlias[]"},
       {"sceneAcceleration", "frameIndex", "lightNodes"}},
      {passEntry<Needs<Need::FrameCamera>>("C"),
       {"Camera camera;"},
       {"Camera previousCamera;", "scenePositions", "frameSeed"}},
      {passEntry<Needs<Need::FrameIndex>>("I"), {"frameIndex", "frameSeed"}, {"Camera camera;", "scenePositions"}},
  };
  for (const auto& c : cases) {
    const bool plain = std::string(c.entry.name) == "Plain";
    const std::string s = preludeOf(c.entry, plain ? R"("left": "feeder.words")" : "");
    for (const char* words : c.there) EXPECT_TRUE(holds(s, words)) << c.entry.name << ": " << words;
    for (const char* words : c.absent) EXPECT_FALSE(holds(s, words)) << c.entry.name << ": " << words;
  }
}

TEST(Prelude, EnvironmentsAreDeclaredOnlyWhereASceneHasOne) {
  scene::SceneTraits sky;
  sky.environment = true;
  const auto of = [](const WeirPassEntry& entry, const scene::SceneTraits& traits) {
    return preludeOf(entry, "", KernelKind::Compute, traits);
  };
  for (const WeirPassEntry& entry :
       {passEntry<Needs<Need::SceneEnvironment>>("E"), passEntry<Needs<Need::SceneLights>>("L")}) {
    EXPECT_TRUE(holds(of(entry, sky), "sceneEnvironmentMap") && holds(of(entry, sky), "#define SCENE_ENVIRONMENT 1"));
    EXPECT_FALSE(holds(of(entry, {}), "nvironment")) << entry.name;
  }
  EXPECT_FALSE(holds(of(passEntry<Needs<Need::SceneGeometry>>("G"), sky), "sceneEnvironmentMap"));
}

TEST(Prelude, OnlyRayKernelsCanTrace) {
  const WeirPassEntry rays = passEntry<Needs<Need::SceneAcceleration>>("A");
  EXPECT_FALSE(holds(preludeOf(rays, ""), "sceneAcceleration"));
  const std::string pipeline = preludeOf(rays, "", KernelKind::RayPipeline),
                    query = preludeOf(rays, "", KernelKind::RayQuery);
  for (const std::string& s : {pipeline, query}) EXPECT_TRUE(holds(s, "sceneAcceleration") && holds(s, "CAN_TRACE"));
  EXPECT_TRUE(holds(pipeline, "TRACE_PIPELINE") && !holds(pipeline, "TRACE_QUERY") &&
              holds(pipeline, "gl_LaunchIDEXT"));
  EXPECT_TRUE(holds(query, "TRACE_QUERY") && !holds(query, "TRACE_PIPELINE"));
}

TEST(Prelude, ParametersAreFourBytesEachAfterTheLaunch) {
  PassDescription d;
  Plain::describe(d);
  const auto push = execute::pushParams(d);
  ASSERT_EQ(push.size(), 2u);
  EXPECT_EQ(push[0].description->name, "one");
  EXPECT_EQ(push[0].offset, 16u);
  EXPECT_EQ(push[1].description->name, "three");
  EXPECT_EQ(push[1].offset, 20u);
  EXPECT_EQ(execute::pushBytes(d), 24u);
  ASSERT_EQ(execute::specialParams(d).size(), 1u);
  EXPECT_EQ(execute::specialParams(d)[0]->name, "two");
  EXPECT_EQ(execute::paramBits(*push[0].description, ParamValue(1.0f)), 0x3f800000u);
  EXPECT_EQ(execute::paramBits(*push[1].description, ParamValue(true)), 1u);
  EXPECT_EQ(execute::paramBits(*execute::specialParams(d)[0], ParamValue(int32_t{-2})), 0xfffffffeu);
}

TEST(Prelude, TooManyParametersAreRefused) {
  PassDescription d;
  d.type = "own.Many";
  for (int i = 0; i < 28; ++i) d.param(std::string(static_cast<size_t>(i) + 1, 'p'), 0);
  EXPECT_EQ(execute::pushBytes(d), 128u);
  d.param("more", 0);
  try {
    (void)execute::pushBytes(d);
    FAIL() << "132 bytes were taken";
  } catch (const InputError& e) {
    expectWords(e.what(), {"own.Many", "132"});
  }
}

}  // namespace
}  // namespace weir::test
