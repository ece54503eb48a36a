// What `cmake --install` puts somewhere, after it was moved: the program runs, and a plugin from outside of the tree is
// built against it and renders.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <weir/image/image.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

void replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = read(file);
  ASSERT_TRUE(has(text, from)) << file << " has no '" << from << "'";
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  std::ofstream(file) << text;
}

struct Ran {
  int status = -1;
  std::string out, err;
};

class Installed : public testing::Test {
 protected:
  void SetUp() override {
    expectDone(TEST_CMAKE " --install " WEIR_BINARY_DIR " " TEST_INSTALL_OPTIONS " --prefix " + first().string());
    fs::rename(first(), prefix());
  }

  /// By a shell, without what could lead the program or CMake back to the build tree.
  Ran run(const std::string& command) const {
    const fs::path out = root() / "out", err = root() / "err";
    const int status = std::system(("env -u WEIR_PLUGIN_PATH -u WEIR_SHADERS -u LD_LIBRARY_PATH " + command + " >" +
                                    out.string() + " 2>" + err.string())
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
  }
  std::string expectDone(const std::string& command) const {
    const Ran r = run(command);
    EXPECT_EQ(r.status, 0) << command << "\n" << r.out << r.err;
    return r.out;
  }
  Ran weir(const std::string& arguments) const { return run((prefix() / "bin/weir").string() + " " + arguments); }

  /// Configures and builds a project against the installation; the build tree is `build` below its folder.
  void build(const fs::path& project, const fs::path& installation) const {
    expectDone(std::string(TEST_CMAKE) + " -G Ninja -S " + project.string() + " -B " + (project / "build").string() +
               " -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=" TEST_COMPILER " -DCMAKE_PREFIX_PATH=" +
               installation.string());
    expectDone(std::string(TEST_CMAKE) + " --build " + (project / "build").string());
  }
  /// The example, copied out of the source tree.
  fs::path example(const std::string& name) const {
    fs::copy(sourcePath("examples/plugin"), root() / name, fs::copy_options::recursive);
    return root() / name;
  }
  /// `weir render` of the example's graph; the output `radiance`.
  image::Picture radiance(const fs::path& project, const std::string& more) const {
    const fs::path file = root() / "radiance.exr";
    const Ran r = weir(render(project, more + " --out radiance=" + file.string()));
    EXPECT_EQ(r.status, 0) << r.err;
    return r.status == 0 ? image::readExr(file.string()) : image::Picture{};
  }
  std::string render(const fs::path& project, const std::string& more) const {
    return "render " + (project / "letterbox.json").string() + " --plugin-path " + (project / "build/weir").string() +
           " --scene " + (prefix() / "share/weir/scenes/cornell.glb").string() + " --size 64x64 --device " +
           deviceChoice() + " " + more;
  }

  fs::path root() const { return fs::canonical(folder_.path()); }
  fs::path first() const { return root() / "where_it_was_installed"; }
  fs::path prefix() const { return root() / "moved"; }

 private:
  TemporaryFolder folder_;
};

TEST_F(Installed, HoldsWhatItShouldAndNoPathOfItsOrigin) {
  for (const char* file :
       {"bin/weir", "lib/libweir.so", "lib/weir/libweir_output.so", "lib/weir/weir_output.json",
        "lib/weir/shaders/common/trace.glsl", "lib/weir/shaders/output/tonemap.glsl", "include/weir/pass/plugin.h",
        "include/weir/embed/embed.h", "include/weir/passes/common/layouts.h", "share/weir/graphs/restir_di.json",
        "share/weir/scenes/cornell.glb", "lib/cmake/weir/weirConfig.cmake", "lib/cmake/weir/weirConfigVersion.cmake",
        "lib/cmake/weir/weirTargets.cmake", "lib/cmake/weir/weir_plugin.cmake"})
    EXPECT_TRUE(fs::is_regular_file(prefix() / file)) << file;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix())) {
    EXPECT_FALSE(entry.is_symlink()) << entry.path();
    if (!entry.is_regular_file()) continue;
    const std::string bytes = read(entry.path());
    for (const std::string& place : {std::string(WEIR_SOURCE_DIR), std::string(WEIR_BINARY_DIR), first().string()})
      EXPECT_FALSE(has(bytes, place)) << entry.path() << " holds " << place;
  }
}

TEST_F(Installed, FindsItsOwnLibraryPluginsAndShaders) {
  const std::string linked = expectDone("ldd " + (prefix() / "bin/weir").string());
  EXPECT_TRUE(has(linked, (prefix() / "lib/libweir.so").string()) ||
              has(linked, (prefix() / "bin/../lib/libweir.so").string()))
      << linked;
  const nlohmann::json passes = nlohmann::json::parse(expectDone((prefix() / "bin/weir").string() + " passes --json"));
  EXPECT_TRUE(passes.at("problems").empty()) << passes.at("problems");
  EXPECT_GE(passes.at("passes").size(), 10u);
  const Ran r = weir("render " + (prefix() / "share/weir/graphs/restir_di.json").string() + " --scene " +
                     (prefix() / "share/weir/scenes/cornell.glb").string() + " --size 16x16 --device " +
                     deviceChoice() + " --out color=" + (root() / "a.png").string());
  EXPECT_EQ(r.status, 0) << r.err;
}

// The page lies in share/weir there, not beside the library.
TEST_F(Installed, FindsTheChartPage) {
  if (!TEST_HAS_PAGE) GTEST_SKIP() << "built without the page: no node or no npm";
  const fs::path bench = root() / "bench.json", page = root() / "report.html";
  std::ofstream(bench)
      << R"({"weir_bench": 1, "device": "made up", "configurations": [{"id": "a", "graph": "made_up.json",
    "scene": {"file": "made_up.glb"}, "size": [1, 1], "passes": [], "frame": {"gpu_ms": {"median": 1}}}]})";
  const Ran r = weir("chart " + bench.string() + " --out " + page.string());
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_TRUE(has(read(page), "<title>Error against time: made_up.glb</title>"));
}

TEST_F(Installed, HeadersNeedNothingThatIsNotInstalled) {
  const fs::path project = root() / "headers";
  fs::create_directories(project);
  std::ofstream(project / "CMakeLists.txt") << "cmake_minimum_required(VERSION 3.25)\nproject(headers LANGUAGES CXX)\n"
                                               "find_package(weir " TEST_RELEASE
                                               " CONFIG REQUIRED)\n"
                                               "add_library(headers OBJECT all.cpp)\n"
                                               "target_link_libraries(headers PRIVATE weir::framework)\n";
  std::vector<std::string> headers;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix() / "include"))
    if (entry.path().extension() == ".h") headers.push_back(fs::relative(entry.path(), prefix() / "include").string());
  std::sort(headers.begin(), headers.end());
  EXPECT_GT(headers.size(), 40u);
  std::ofstream all(project / "all.cpp");
  for (const std::string& header : headers) all << "#include <" << header << ">\n";
  all.close();
  build(project, prefix());
}

TEST_F(Installed, TheExampleIsBuiltAndDoesWhatItSays) {
  const fs::path project = example("example");
  build(project, prefix());

  // A 64×64 picture of aspect 1.6 has 40 rows; 12 above and below it are two stops darker, which is exact in binary.
  const image::Picture with = radiance(project, ""), without = radiance(project, "--disable bars");
  ASSERT_EQ(with.rgba.size(), 64u * 64 * 4);
  ASSERT_EQ(without.rgba.size(), with.rgba.size());
  double light = 0;
  for (size_t y = 0; y < 64; ++y)
    for (size_t x = 0; x < 64; ++x)
      for (size_t channel = 0; channel < 4; ++channel) {
        const size_t i = (y * 64 + x) * 4 + channel;
        const bool darker = (y < 12 || y >= 52) && channel < 3;
        ASSERT_EQ(with.rgba[i], darker ? without.rgba[i] / 4 : without.rgba[i]) << x << ", " << y << ", " << channel;
        if (darker) light += without.rgba[i];
      }
  EXPECT_GT(light, 1) << "there is something to darken";

  // Its host code runs again for another parameter, and what it refuses is bad input that names the pass.
  const image::Picture square = radiance(project, "--set bars.aspect=1");
  EXPECT_EQ(square.rgba, without.rgba);
  const Ran refused = weir(render(project, "--set bars.aspect=0.5 --out color=" + (root() / "none.png").string()));
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_TRUE(has(refused.err, "letterbox.Bars") && has(refused.err, "no bar fits")) << refused.err;

  // Installed, it is found without being named.
  EXPECT_FALSE(has(weir("passes").out, "letterbox.Bars"));
  expectDone(std::string(TEST_CMAKE) + " --install " + (project / "build").string() + " --prefix " + prefix().string());
  const Ran found = weir("passes");
  EXPECT_TRUE(has(found.out, "letterbox.Bars")) << found.out << found.err;
}

TEST_F(Installed, AHostInCIsBuiltAndRendersAGraphOnItsOwnDevice) {
  const fs::path project = root() / "host", picture = root() / "picture.pfm";
  fs::copy(sourcePath("examples/embed"), project, fs::copy_options::recursive);
  build(project, prefix());
  const std::string share = (prefix() / "share/weir").string();
  expectDone((project / "build/weir_embed_example").string() + " " + share + "/graphs/restir_di.json " + share +
             "/scenes/cornell.glb " + picture.string() + " --size 16x16 --frames 2");
  EXPECT_EQ(fs::file_size(picture), std::string("PF\n24 24\n-1.0\n").size() + size_t{3} * 4 * 24 * 24);
}

TEST_F(Installed, APluginOfAnotherReleaseIsRefusedByName) {
  // As the package of another release would have it.
  const fs::path other = root() / "other", project = example("example");
  fs::copy(prefix(), other, fs::copy_options::recursive);
  replace(other / "lib/cmake/weir/weirConfig.cmake", "weir-" TEST_RELEASE "-", "weir-0.0.1-");
  build(project, other);
  const fs::path file = root() / "none.png";
  Ran r = weir(render(project, "--out color=" + file.string()));
  EXPECT_EQ(r.status, 2) << r.err;
  for (const char* words : {"plugin 'letterbox'", "'weir-0.0.1-", "'weir-" TEST_RELEASE "-", "rebuild the plugin"})
    EXPECT_TRUE(has(r.err, words)) << words << " in: " << r.err;

  // A manifest that claims the right tag doesn't help: the library has its own.
  replace(project / "build/weir/weir_letterbox.json", "weir-0.0.1-", "weir-" TEST_RELEASE "-");
  r = weir(render(project, "--out color=" + file.string()));
  EXPECT_EQ(r.status, 2) << r.err;
  EXPECT_TRUE(has(r.err, "libweir_letterbox.so) has build tag 'weir-0.0.1-")) << r.err;
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace weir::test
