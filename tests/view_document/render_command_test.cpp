// The command that is copied from the window: a shell must read it as it was meant, and `weir` must give the picture.
#include "view/document/render_command.h"

#include "view/document/camera_words.h"
#include "view/document/overrides.h"

#include <fmt/format.h>
#include <weir/image/image.h>

#include <sys/wait.h>

#include <cstdio>
#include <random>

#include "graphs.h"

namespace weir::view::test {
namespace {

using Words = std::vector<std::string>;

class Command : public Graphs {
 protected:
  /// What a shell hands to `weir`.
  Words words(const RenderCommand& command) const {
    const std::string script =
        folder.write("words.sh", "weir() { for a in \"$@\"; do printf '%s\\0' \"$a\"; done; }\n" + command.text + "\n");
    std::FILE* pipe = ::popen(("/bin/sh " + script).c_str(), "r");
    if (!pipe) throw std::runtime_error("no shell");
    std::string out;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) out += static_cast<char>(c);
    EXPECT_EQ(::pclose(pipe), 0) << command.text;
    Words found;
    for (size_t at = 0; at < out.size(); at = out.find('\0', at) + 1) found.emplace_back(out.c_str() + at);
    return found;
  }
  static bool hasPair(const Words& words, const std::string& option, const std::string& value) {
    for (size_t i = 0; i + 1 < words.size(); ++i)
      if (words[i] == option && words[i + 1] == value) return true;
    return std::find(words.begin(), words.end(), option + "=" + value) != words.end();
  }
  static render::RenderOptions view() {
    render::RenderOptions options;
    options.stage.scene = sourcePath("scenes/cornell.glb");
    options.width = 48;
    options.height = 32;
    return options;
  }
};

TEST_F(Command, AShellReadsAnyPathAsItIs) {
  const Words paths = {"plain.glb", "with space.glb",   "it's.glb",  "$(touch x) `y` $HOME.glb",
                       "a\nb.glb",  "ä€\t.glb",         "-dash.glb", "~/x.glb",
                       "*?[a].glb", "\"quoted\\\".glb", "",          "#;&|<>!{}.glb"};
  for (const std::string& path : paths) {
    const Document document = Document::fromText(restir().text(), path.empty() ? "graph.json" : path);
    render::RenderOptions options = view();
    options.stage.scene = path;
    options.outputs = {{"color", path}};
    options.pluginPaths = {path};
    const Words read = words(renderCommand(document, catalog, options, std::nullopt, document.file()));
    ASSERT_GE(read.size(), 2u);
    EXPECT_EQ(read[0], "render");
    EXPECT_EQ(read[1], path.starts_with('-') ? "./" + path : document.file());
    EXPECT_TRUE(hasPair(read, "--scene", path)) << path;
    EXPECT_TRUE(hasPair(read, "--out", "color=" + path)) << path;
    EXPECT_TRUE(hasPair(read, "--plugin-path", path)) << path;
  }
}

TEST_F(Command, SaysEveryOptionOfTheView) {
  render::RenderOptions options = view();
  options.frames = 8;
  options.average = 4;
  options.firstFrame = 3;
  options.seed = 7;
  options.exposure = -1.5f;
  options.trace = "query";
  options.device = "cpu";
  options.stage.lights = 500;
  options.stage.lightSeed = 2;
  options.stage.replaceLights = options.stage.energyCompensation = options.stage.animate = true;
  options.stage.environment = "sky.hdr";
  options.stage.environmentScale = 0.1f;
  options.stage.environmentRotation = -30.0f;
  options.stage.clip = "Walk";
  options.stage.time = 0.25;
  options.stage.camera = "left camera";
  const Words read = words(renderCommand(restir(), catalog, options, std::nullopt));
  const std::vector<std::pair<std::string, std::string>> expected = {{"--size", "48x32"},
                                                                     {"--frames", "8"},
                                                                     {"--average", "4"},
                                                                     {"--first-frame", "3"},
                                                                     {"--seed", "7"},
                                                                     {"--exposure", "-1.5"},
                                                                     {"--trace", "query"},
                                                                     {"--device", "cpu"},
                                                                     {"--lights", "500"},
                                                                     {"--light-seed", "2"},
                                                                     {"--environment", "sky.hdr"},
                                                                     {"--environment-scale", "0.1"},
                                                                     {"--environment-rotation", "-30"},
                                                                     {"--clip", "Walk"},
                                                                     {"--time", "0.25"},
                                                                     {"--camera", "left camera"}};
  for (const auto& [option, value] : expected) EXPECT_TRUE(hasPair(read, option, value)) << option << " " << value;
  for (const char* flag : {"--replace-lights", "--energy-compensation", "--animate"})
    EXPECT_EQ(std::count(read.begin(), read.end(), flag), 1) << flag;
}

TEST_F(Command, EditsBecomeOverridesThatGiveTheSameGraph) {
  Document document = restir();
  document.setParam("spatial", "radius", 12.34567f);
  document.setParam("temporal", "mis", std::string("z"));
  document.setParam("tonemap", "view", std::string("it's = a.view"));
  document.resetParam("spatial", "neighbours");
  document.setEnabled("temporal", false);
  const RenderCommand command = renderCommand(document, catalog, view(), std::nullopt);
  EXPECT_EQ(command.saveFirst, "");
  graph::Overrides overrides;
  const Words read = words(command);
  for (size_t i = 0; i + 1 < read.size(); ++i) {
    if (read[i] == "--set") overrides.set.push_back(read[i + 1]);
    if (read[i] == "--disable") overrides.disable.push_back(read[i + 1]);
  }
  EXPECT_EQ(overrides.set.size(), 4u);
  const graph::CompiledGraph said = graph::compileFile(document.file(), overrides, catalog, 64, 64),
                             meant = compiled(document);
  ASSERT_EQ(said.passes.size(), meant.passes.size());
  for (size_t i = 0; i < said.passes.size(); ++i) EXPECT_EQ(said.passes[i].params, meant.passes[i].params);
}

TEST_F(Command, SaysWhenTheGraphMustBeSavedFirst) {
  const std::string file = folder.write("graph.json", restir().text());
  Document document = Document::load(file);
  EXPECT_EQ(renderCommand(document, catalog, view(), std::nullopt).saveFirst, "");
  swapType(document, context, "gbuffer", "gbuffer.Raster");
  EXPECT_NE(renderCommand(document, catalog, view(), std::nullopt).saveFirst, "");
  EXPECT_EQ(renderCommand(document, catalog, view(), std::nullopt, "elsewhere.json").saveFirst, "");
  document.save();
  EXPECT_EQ(renderCommand(document, catalog, view(), std::nullopt).saveFirst, "");
  document.setParam("tonemap", "view", std::string("a\0b", 3));
  EXPECT_NE(renderCommand(document, catalog, view(), std::nullopt).saveFirst, "");
  document.undo();
  folder.write("graph.json", document.text() + "\n");
  EXPECT_NE(renderCommand(document, catalog, view(), std::nullopt).saveFirst, "");
}

TEST_F(Command, CamerasReadFromWordsComeBackToTheLastBit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-20, 20), fov(5, 120);
  int exact = 0;
  constexpr int kCameras = 300;
  for (int i = 0; i < kCameras; ++i) {
    const std::string text = fmt::format("{},{},{},{},{},{},{}", place(random), place(random), place(random),
                                         place(random), place(random), place(random), fov(random));
    const scene::Camera camera = scene::chooseCamera({}, text, 1.0f);
    const CameraWords words = cameraWords(camera);
    const scene::Camera again = scene::chooseCamera({}, words.text, 1.0f);
    EXPECT_EQ(again.eye, camera.eye);
    EXPECT_EQ(again.verticalFov, camera.verticalFov);
    EXPECT_LT(glm::length(again.forward - camera.forward), 1e-6f);
    EXPECT_TRUE(words.level);
    EXPECT_EQ(words.exact, again.forward == camera.forward && again.up == camera.up);
    exact += words.exact ? 1 : 0;
  }
  std::printf("%d of %d cameras come back exactly\n", exact, kCameras);
  EXPECT_GE(exact, kCameras * 95 / 100);
}

TEST_F(Command, ARolledCameraIsSaidToBeUnsayable) {
  scene::Camera camera = scene::chooseCamera({}, "1,2,3,0,0,0,50", 1.0f);
  EXPECT_TRUE(renderCommand(restir(), catalog, view(), camera).unsaid.empty());
  camera.up = glm::normalize(camera.up + 0.2f * glm::cross(camera.forward, camera.up));
  EXPECT_EQ(renderCommand(restir(), catalog, view(), camera).unsaid.size(), 1u);
}

TEST_F(Command, RunsAndGivesThePictureOfTheSavedGraph) {
  const std::string name = "it's $a graph.json";
  Document document = Document::load(folder.write(name, read(sourcePath("graphs/restir_di.json"))));
  document.setParam("spatial", "radius", 9.25f);
  document.setParam("temporal", "mis", std::string("z"));
  document.setEnabled("temporal", false);
  render::RenderOptions options = view();
  options.width = options.height = 16;
  options.frames = 2;
  options.device = weir::test::deviceChoice();
  const scene::Camera camera = scene::chooseCamera({}, "-0.3,1.1,2.9,0.1,0.9,-0.2,40", 1.0f);
  const auto picture = [&](const std::string& file, const RenderCommand& command) {
    EXPECT_EQ(command.saveFirst, "");
    const std::string line = "PATH=" + shellQuoted(binaryPath("bin")) + ":$PATH; " + command.text + " >/dev/null";
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
    return image::readExr(file);
  };
  const std::string edited = folder.path() + "/edited \"picture\".exr", saved = folder.path() + "/saved.exr";
  options.outputs = {{"radiance", edited}};
  const image::Picture before = picture(edited, renderCommand(document, catalog, options, camera));
  document.save();
  options.outputs = {{"radiance", saved}};
  const RenderCommand command = renderCommand(document, catalog, options, camera);
  EXPECT_EQ(command.text.find("--set"), std::string::npos) << command.text;
  const image::Picture after = picture(saved, command);
  EXPECT_EQ(before.rgba.size(), size_t{16} * 16 * 4);
  EXPECT_EQ(before.rgba, after.rgba);
}

}  // namespace
}  // namespace weir::view::test
