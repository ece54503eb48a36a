// The program as a script sees it: exit statuses, what is on stdout and what on stderr.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Ran {
  int status = -1;
  std::string out, err;
};

class Commands : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    scratch = fs::temp_directory_path() / (std::string("weir_commands_") + test->name());
    fs::remove_all(scratch);
    fs::create_directories(scratch);
    good = std::string(" --plugin-path ") + TEST_PLUGIN_FOLDER + "/good";
    graph = write(
        "graph.json",
        "{\"version\": 1, \"passes\": {\n\"a\": {\"type\": \"good.Nothing\"}},\n\"outputs\": {\"o\": \"a.color\"}}");
  }
  void TearDown() override { fs::remove_all(scratch); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch / name) << text;
    return (scratch / name).string();
  }
  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  Ran weir(const std::string& arguments) const {
    const std::string command = std::string(WEIR_BINARY_DIR) + "/bin/weir " + arguments + " >" +
                                (scratch / "out").string() + " 2>" + (scratch / "err").string();
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(scratch / "out"), read(scratch / "err")};
  }
  fs::path scratch;
  std::string good, graph;
};

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST_F(Commands, HelpAndVersion) {
  for (const char* help : {"--help", "graph --help", "graph check --help", "passes --help"}) {
    const Ran r = weir(help);
    EXPECT_EQ(r.status, 0) << help;
    EXPECT_FALSE(r.out.empty()) << help;
  }
  EXPECT_EQ(weir("--version").status, 0);
  EXPECT_EQ(weir("--version").out.find("weir "), 0u);
}

TEST_F(Commands, SlipsOnTheCommandLineAreBadInputAndNameTheNearest) {
  const struct {
    const char *arguments, *words;
  } cases[] = {{"", "subcommand"},          {"grahp check x", "'graph'"},
               {"graph chek x", "'check'"}, {"graph check --sett a.b=c x.json", "'--set'"},
               {"graph check", "GRAPH"},    {"passes --jsn", "'--json'"}};
  for (const auto& c : cases) {
    const Ran r = weir(c.arguments);
    EXPECT_EQ(r.status, 2) << c.arguments;
    EXPECT_TRUE(has(r.err, c.words)) << r.err;
    EXPECT_EQ(r.out, "") << c.arguments;
  }
}

TEST_F(Commands, GraphCheck) {
  const Ran fine = weir("graph check " + graph + good);
  EXPECT_EQ(fine.status, 0) << fine.err;
  EXPECT_TRUE(has(fine.out, "no findings"));
  const Ran set = weir("graph check " + graph + good + " --set a.amont=1 --size 8x8");
  EXPECT_EQ(set.status, 2);
  EXPECT_TRUE(has(set.err, "--set: passes.a.params.amont: unknown parameter")) << set.err;
  EXPECT_TRUE(has(set.err, "nearest: 'amount'")) << set.err;
  EXPECT_EQ(weir("graph check " + graph + good + " --size 8by8").status, 2);
  EXPECT_EQ(weir("graph check /nowhere.json").status, 2);
  const Ran type = weir("graph check " + graph);
  EXPECT_EQ(type.status, 2);
  EXPECT_TRUE(has(type.err, graph + ":2: passes.a.type: unknown type 'good.Nothing'")) << type.err;
}

TEST_F(Commands, ExplainDotAndSchema) {
  EXPECT_TRUE(has(weir("graph explain " + graph + good + " --size 8x8").out, "1. a (good.Nothing)"));
  EXPECT_TRUE(has(weir("graph dot " + graph + good).out, "digraph"));
  const Ran schema = weir("graph schema" + good);
  EXPECT_EQ(schema.status, 0);
  EXPECT_TRUE(nlohmann::json::parse(schema.out).at("definitions").contains("good.Nothing"));
  EXPECT_EQ(weir("graph schema " + graph + good).status, 0);
}

TEST_F(Commands, PassesListsGoodOnesAndSaysWhatIsWrongWithOthers) {
  const std::string both = good + " --plugin-path " + TEST_PLUGIN_FOLDER + "/throws";
  const Ran text = weir("passes" + both);
  EXPECT_EQ(text.status, 0);
  EXPECT_TRUE(has(text.out, "good.Nothing")) << text.out;
  EXPECT_TRUE(has(text.out, "amount")) << text.out;
  EXPECT_TRUE(has(text.err, "the tables are missing")) << text.err;
  const Ran json = weir("passes --json" + both);
  const nlohmann::json parsed = nlohmann::json::parse(json.out);
  EXPECT_GE(parsed.at("passes").size(), 2u);
  bool found = false;
  for (const auto& pass : parsed.at("passes")) {
    if (pass.at("type") != "good.Nothing") continue;
    found = true;
    EXPECT_EQ(pass.at("params").at(0).at("name"), "amount");
    EXPECT_EQ(pass.at("params").at(0).at("default"), 1.0);
    EXPECT_EQ(pass.at("params").at(0).at("high"), 2.0);
    EXPECT_EQ(pass.at("outputs").at(0).at("format"), "RGBA32F");
  }
  EXPECT_TRUE(found);
  bool said = false;
  for (const auto& problem : parsed.at("problems")) said |= problem.at("plugin") == "throws";
  EXPECT_TRUE(said) << json.out;
}

}  // namespace
