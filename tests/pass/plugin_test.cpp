// Plugins that are wrong in one way each: a clear finding, and the others are still there.
#include <weir/core/error.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>

#include "pass/plugin_files.h"

namespace weir {
namespace {

TEST_F(Plugins, AGoodOne) {
  Registry registry({folderOf("good")});
  const PassDescription* nothing = registry.find("good.Nothing");
  ASSERT_NE(nothing, nullptr);
  EXPECT_EQ(nothing->type, "good.Nothing");
  EXPECT_EQ(nothing->outputs.size(), 1u);
  EXPECT_EQ(registry.find("good.Nothing"), nothing);
  EXPECT_NE(registry.create("good.Nothing"), nullptr);
  EXPECT_EQ(registry.types(), (std::vector<std::string>{"good.CannotBeMade", "good.Nothing"}));
  EXPECT_EQ(registry.shaderFolder("good.Nothing"), fs::canonical(folderOf("good")) / "shaders/good");
  EXPECT_EQ(registry.problem("good.Nothing"), "");
  EXPECT_TRUE(registry.problems().empty());
}

TEST_F(Plugins, AConstructorThatThrowsIsARuntimeError) {
  Registry registry({folderOf("good")});
  try {
    registry.create("good.CannotBeMade");
    FAIL();
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("no room"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("good.CannotBeMade"), std::string::npos);
  }
}

TEST_F(Plugins, UnknownTypesNameTheNearest) {
  Registry registry({folderOf("good")});
  EXPECT_EQ(registry.problem("good.Nothin"), "plugin 'good' has no pass 'Nothin'");
  EXPECT_NE(registry.problem("goood.Nothing").find("no plugin 'goood'"), std::string::npos);
  EXPECT_NE(registry.problem("Nothing").find("plugin.Pass"), std::string::npos);
  EXPECT_EQ(registry.find(""), nullptr);
  try {
    registry.create("good.Nothin");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nearest: 'good.Nothing'"), std::string::npos) << error.what();
  }
}

TEST_F(Plugins, EachWrongOneIsRefusedAndTheGoodOneLivesOn) {
  const struct {
    const char *plugin, *pass;
    std::vector<std::string> words;
  } cases[] = {
      {"wrong_abi", "Nothing", {"ABI 999", "rebuild"}},
      {"wrong_tag", "Nothing", {"weir-0.0-Watcom1", WEIR_BUILD_TAG}},
      {"wrong_name", "Nothing", {"calls itself 'another_name'", "'wrong_name'"}},
      {"no_symbol", "Nothing", {"does not export the function weir_plugin"}},
      {"throws_loading", "Nothing", {"weir_plugin threw", "the licence server is away"}},
      {"throws_loading_int", "Nothing", {"weir_plugin threw something that is no exception"}},
      {"returns_nothing", "Nothing", {"weir_plugin returned nothing"}},
      {"lacks_record", "Nothing", {"lacks its name or one of its functions"}},
      {"throws", "Throws", {"'throws.Throws'", "the tables are missing"}},
      {"throws", "Nothing", {"the tables are missing"}},
      {"throws_int", "Throws", {"no exception"}},
      {"twice", "Nothing", {"two passes called 'Nothing'"}},
      {"contradicts", "Contradicts", {"amount", "outside its range"}},
  };
  std::vector<fs::path> folders{folderOf("good")};
  for (const auto& c : cases) folders.push_back(folderOf(c.plugin));
  Registry registry(folders);
  EXPECT_TRUE(registry.problems().empty()) << "nothing is loaded before it is asked for";
  for (const auto& c : cases) {
    std::vector<std::string> words = c.words;
    words.push_back(libraryOf(c.plugin));
    expectRefused(registry, std::string(c.plugin) + "." + c.pass, words);
  }
  EXPECT_EQ(registry.problems().size(), 12u);
  EXPECT_EQ(registry.types().size(), 2u);
  EXPECT_NE(registry.create("good.Nothing"), nullptr);
}

TEST_F(Plugins, BadManifestsAreNamedAndStopNobody) {
  const struct {
    const char *file, *text, *words;
  } cases[] = {
      {"weir_a.json", "{", "not valid JSON"},
      {"weir_b.json", "[]", "must be a JSON object"},
      {"weir_c.json", "{\"name\": \"c\"}", "no 'library'"},
      {"weir_d.json", "{\"name\": 3}", "'name'"},
      {"weir_e.json", "{\"name\": \"e.f\", \"library\": \"x\", \"abi\": 1, \"buildTag\": \"x\"}",
       "must not contain '.'"},
      {"weir_f.json", "{\"name\": \"f\", \"library\": \"x\", \"abi\": -1, \"buildTag\": \"x\"}", "'abi'"},
      {"weir_g.json", "", "not valid JSON"},
  };
  for (const auto& c : cases) write(c.file, c.text);
  write("other.json", "{");
  write("weir_h.txt", "{");
  Registry registry({scratch, folderOf("good")});
  ASSERT_EQ(registry.problems().size(), std::size(cases));
  for (size_t i = 0; i < std::size(cases); ++i) {
    const std::string& message = registry.problems()[i].message;
    EXPECT_NE(message.find((fs::canonical(scratch) / cases[i].file).string()), std::string::npos) << message;
    EXPECT_NE(message.find(cases[i].words), std::string::npos) << message;
  }
  expectRefused(registry, "a.Pass", {"not valid JSON"});
  EXPECT_NE(registry.find("good.Nothing"), nullptr);
}

TEST_F(Plugins, AManifestOfAnotherBuildIsRefusedWithoutLoading) {
  write("weir_old.json", manifest("old", "does_not_exist.so", "77"));
  write("weir_tag.json", manifest("tag", "does_not_exist.so", "", "yesterday"));
  write("weir_gone.json", manifest("gone", "does_not_exist.so"));
  const fs::path text = write("text.so", "this is no library");
  write("weir_text.json", manifest("text", text.string()));
  Registry registry({scratch});
  expectRefused(registry, "old.Pass", {"ABI 77", "weir_old.json"});
  expectRefused(registry, "tag.Pass", {"yesterday", "weir_tag.json"});
  expectRefused(registry, "gone.Pass", {"does not exist", "weir_gone.json"});
  expectRefused(registry, "text.Pass", {"can't be loaded", "no shared library", text.string()});
}

TEST_F(Plugins, AHalfWrittenLibraryIsRefusedAtEveryLength) {
  std::ifstream file(libraryOf("good"), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GT(whole.size(), 4000u);
  for (size_t bytes = 0; bytes < whole.size(); bytes += 1 + whole.size() / 97) {
    write("weir_good.json", manifest("good", "part.so"));
    write("part.so", whole.substr(0, bytes));
    Registry registry({scratch});
    expectRefused(registry, "good.Nothing", {"can't be loaded", "part.so"});
  }
  std::string program = whole;
  program[16] = 2;  // e_type: an executable
  write("part.so", program);
  Registry registry({scratch});
  expectRefused(registry, "good.Nothing", {"no shared library for this machine"});
}

TEST_F(Plugins, WithoutATemporaryFolderThePluginIsRefused) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("TMPDIR", (scratch / "nowhere").c_str(), 1);
  Registry registry({folderOf("good")});
  expectRefused(registry, "good.Nothing", {libraryOf("good"), "temporary files", "TMPDIR"});
  if (before != nullptr)
    ::setenv("TMPDIR", kept.c_str(), 1);
  else
    ::unsetenv("TMPDIR");
  registry.reload("good");
  EXPECT_NE(registry.find("good.Nothing"), nullptr);
}

TEST_F(Plugins, LibrariesThatAPluginBroughtAreFound) {
  const auto expectHelped = [&](const std::string& where) {
    Registry registry({scratch / "moved"});
    const PassDescription* helped = registry.find("with_helper.Helped");
    ASSERT_NE(helped, nullptr) << where << ": " << registry.problem("with_helper.Helped");
    EXPECT_EQ(helped->text, "from the helper");
  };
  fs::copy(folderOf("with_helper"), scratch / "moved");
  expectHelped("beside it, by $ORIGIN");
  fs::create_directory(scratch / "its_own");
  fs::rename(scratch / "moved/libtest_plugin_helper.so", scratch / "its_own/libtest_plugin_helper.so");
  expectHelped("beside its folder, by $ORIGIN/../its_own");
  fs::remove_all(scratch / "its_own");
  Registry registry({scratch / "moved"});
  expectRefused(registry, "with_helper.Helped", {"libtest_plugin_helper.so", "libweir_with_helper.so"});
}

TEST_F(Plugins, TwoThatClaimOneNameAreBothNamedAndNeitherIsUsed) {
  const fs::path first = write("one/weir_good.json", manifest("good", libraryOf("good")));
  const fs::path second = write("two/weir_good.json", manifest("good", libraryOf("good")));
  Registry registry({scratch / "one", scratch / "two", folderOf("twice")});
  ASSERT_EQ(registry.problems().size(), 1u);
  expectRefused(registry, "good.Nothing",
                {"two plugins claim the name 'good'", fs::canonical(first).string(), fs::canonical(second).string()});
  EXPECT_THROW(registry.reload("good"), InputError);
}

TEST_F(Plugins, OneFolderTwiceOnThePathIsOneFolder) {
  fs::create_directory_symlink(folderOf("good"), scratch / "link");
  Registry registry({folderOf("good"), folderOf("good") / ".", scratch / "link"});
  EXPECT_TRUE(registry.problems().empty());
  EXPECT_NE(registry.find("good.Nothing"), nullptr);
}

TEST_F(Plugins, AFolderThatIsNoneIsSaid) {
  Registry registry({scratch / "nowhere", write("file", "x")});
  ASSERT_EQ(registry.problems().size(), 2u);
  EXPECT_NE(registry.problems()[0].message.find("nowhere"), std::string::npos);
}

TEST_F(Plugins, TheSearchPathInItsOrder) {
  ::setenv("WEIR_PLUGIN_PATH", "/b::/c:", 1);
  const std::vector<fs::path> path = pluginSearchPath({"/a"});
  ::unsetenv("WEIR_PLUGIN_PATH");
  ASSERT_EQ(path.size(), 4u);
  EXPECT_EQ(path[0], "/a");
  EXPECT_EQ(path[1], "/b");
  EXPECT_EQ(path[2], "/c");
  EXPECT_EQ(path[3], fs::canonical(std::string(WEIR_BINARY_DIR) + "/bin"));
  EXPECT_EQ(pluginSearchPath({}).size(), 1u);
}

TEST_F(Plugins, AGraphSaysWhyItsTypeIsRefused) {
  Registry registry({folderOf("wrong_tag")});
  std::vector<graph::Diagnostic> diagnostics;
  const graph::Description d = graph::parse(
      "{\"version\": 1, \"passes\": {\n\"a\": {\"type\": \"wrong_tag.Nothing\"}}, \"outputs\": {\"o\": \"a.color\"}}",
      "g.json", diagnostics);
  graph::compile(d, registry.catalog(), 8, 8, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].line, 2);
  EXPECT_NE(diagnostics[0].message.find("Watcom"), std::string::npos) << diagnostics[0].message;
}

// ---------------------------------------------------------------------------------------------------- in-process

class Made final : public Pass {
 public:
  static inline int alive = 0;
  static void describe(PassDescription& d) { d.output("o", storageImage(Format::R32F)); }
  Made() { ++alive; }
  ~Made() override { --alive; }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};

TEST(Registry, PassesOfTheProgramItself) {
  Registry registry;
  const WeirPassEntry entries[] = {passEntry<Made>("Made")};
  registry.add("here", entries, "/shaders/here");
  EXPECT_EQ(registry.types(), std::vector<std::string>{"here.Made"});
  EXPECT_EQ(registry.shaderFolder("here.Made"), "/shaders/here");
  {
    const PassPtr pass = registry.create("here.Made");
    EXPECT_EQ(Made::alive, 1);
  }
  EXPECT_EQ(Made::alive, 0);
  EXPECT_THROW(registry.add("here", entries), InputError);
  EXPECT_THROW(registry.add("a.b", entries), InputError);
  EXPECT_THROW(registry.add("", entries), InputError);
}

}  // namespace
}  // namespace weir
