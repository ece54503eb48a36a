// Bench files: what is read of them, and that whatever is wrong is said with its place.
#include <weir/core/error.h>

#include <filesystem>
#include <functional>

#include "chart/bench_text.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

TEST_F(BenchText, EverythingIsRead) {
  const chart::Bench b = chart::readBench({write(bench({configuration("a", 4, 0.5)}))});
  EXPECT_TRUE(b.warnings.empty());
  EXPECT_EQ(b.files.at(0).device, "Made-up device");
  const chart::Configuration& c = b.configurations.at(0);
  EXPECT_EQ(c.frame.median, 4);
  EXPECT_EQ(c.frame.p95, 5);
  EXPECT_EQ(c.wall.median, 6);  // one figure instead of median and percentiles
  EXPECT_EQ(c.passes.at(1).gpu.median, 2);
  EXPECT_EQ(c.errors.at("relmse.median").low, 0.25);
  EXPECT_EQ(c.errors.at("bias").value, -0.01);
  EXPECT_EQ(c.errors.size(), 2u);
  const Json kept = Json::parse(c.json);
  EXPECT_EQ(kept.at("settings").at("pick.count"), 8);
  EXPECT_EQ(kept.at("command"), "weir bench made_up.json");
}

TEST_F(BenchText, WhatWasNotMeasuredMayBeMissingOrNull) {
  Json c = configuration("a", 4, 0.5);
  c.erase("error");
  c["frame"] = {{"gpu_ms", nullptr}, {"wall_ms", 3}};
  c["passes"][0]["gpu_ms"] = nullptr;
  c["floor"] = nullptr;
  const chart::Bench b = chart::readBench({write(bench({c}))});
  EXPECT_TRUE(b.configurations.at(0).errors.empty());
  EXPECT_NE(b.configurations.at(0).frame.median, b.configurations.at(0).frame.median);
  EXPECT_EQ(b.configurations.at(0).wall.median, 3);
}

// Members that a later version adds are no mistake, and don't reach the page.
TEST_F(BenchText, UnknownMembersAreLeftOut) {
  Json c = configuration("a", 4, 0.5);
  c["new"] = "something new";
  EXPECT_EQ(chart::readBench({write(bench({c}))}).configurations.at(0).json.find("something new"), std::string::npos);
  c["new"] = Json::parse(std::string(50, '[') + std::string(50, ']'));
  EXPECT_EQ(refusal(bench({c})), "");
}

TEST_F(BenchText, DeepNestingIsRefused) {
  std::string text = bench({configuration("a", 4, 0.5)}).dump();
  for (const auto& [open, close] : {std::pair{"[", "]"}, {R"({"a":)", "}"}}) {
    std::string deep, end;
    for (int i = 0; i < 200000; ++i) {
      deep += open;
      end += close;
    }
    expectHas(refusal(std::string(text).insert(1, "\"deep\":" + deep + "1" + end + ",")),
              "nested deeper than 64 levels");
    expectHas(refusal(deep), "nested deeper than 64 levels");
  }
}

TEST_F(BenchText, WrongFilesAreRefusedWithTheirPlace) {
  expectHas(refusal(std::string("{")), "bench.json: not valid JSON");
  expectHas(refusal(std::string("")), "not valid JSON");
  expectHas(refusal(std::string("[1]")), "expected an object");
  expectHas(refusal(Json{{"weir_bnch", 1}}), "'weir_bench' is missing (the nearest that is there: 'weir_bnch')");
  expectHas(refusal(Json{{"weir_bench", 2}}), "weir_bench: 2; this program reads version 1");
  expectHas(refusal(Json{{"weir_bench", "1"}}), "weir_bench: the text '1'; expected a number");
  expectHas(refusal(bench({})), "no configurations");
  expectHas(refusal(bench({1})), "configurations[0]: 1; expected an object");
  const std::string nan = R"({"weir_bench": NaN})", huge = R"({"weir_bench": 1e999})";
  expectHas(refusal(nan), "not valid JSON");
  expectHas(refusal(huge), "not valid JSON");
  expectHas(refusal(std::string("{\"weir_bench\": \"\xff\"}")), "not valid JSON");
}

TEST_F(BenchText, WrongConfigurationsAreRefusedWithTheirPlace) {
  const auto changed = [&](const std::function<void(Json&)>& change) {
    Json c = configuration("a", 4, 0.5);
    change(c);
    return refusal(bench({configuration("first", 1, 1), c}));
  };
  using Change = std::function<void(Json&)>;
  const std::vector<std::pair<Change, std::string>> cases = {
      {[](Json& c) { c.erase("id"); }, "configurations[1]: 'id' is missing"},
      {[](Json& c) { c["id"] = ""; }, "configurations[1].id: is empty"},
      {[](Json& c) { c["graph"] = 3; }, "configurations[1].graph: 3; expected a text"},
      {[](Json& c) { c["graph"] = std::string(70000, 'x'); }, "a text of 70000 bytes"},
      {[](Json& c) { c["scene"] = "s"; }, "configurations[1].scene: the text 's'; expected an object"},
      {[](Json& c) { c["scene"].erase("file"); }, "configurations[1].scene: 'file' is missing"},
      {[](Json& c) { c["size"] = {1}; }, "configurations[1].size: expected 2 numbers"},
      {[](Json& c) {
         c["size"] = {1.5, 2};
       },
       "configurations[1].size[0]: 1.5; expected a whole number"},
      {[](Json& c) {
         c["size"] = {1e12, 2};
       },
       "expected a whole number from 0 to 1048576"},
      {[](Json& c) { c["passes"] = Json::object(); }, "configurations[1].passes: an object; expected an array"},
      {[](Json& c) { c["passes"][1].erase("type"); }, "configurations[1].passes[1]: 'type' is missing"},
      {[](Json& c) { c["frame"]["gpu_ms"]["median"] = -1; }, "configurations[1].frame.gpu_ms.median: -1"},
      {[](Json& c) { c["frame"]["gpu_ms"] = "fast"; }, "configurations[1].frame.gpu_ms: the text 'fast'"},
      {[](Json& c) { c["settings"]["pick.count"] = {1}; }, "configurations[1].settings.pick.count: an array of 1"},
      {[](Json& c) { c["settings"] = 1; }, "configurations[1].settings: 1; expected an object"},
      {[](Json& c) { c["error"]["relmse"]["median"]["low"] = 1.5; }, "the interval ends at 1, below its start 1.5"},
      {[](Json& c) { c["error"]["relmse"]["median"] = 1; },
       "configurations[1].error.relmse.median: 1; expected an object"},
      {[](Json& c) { c["error"]["relmse"]["median"]["value"] = -1; }, "expected a number that is not negative"},
      {[](Json& c) {
         c["pictures"] = {{"crop", {1, 2}}};
       },
       "configurations[1].pictures.crop: expected 4 numbers"},
      {[](Json& c) { c["frames"] = -3; }, "configurations[1].frames: -3"},
  };
  for (const auto& [change, words] : cases) expectHas(changed(change), words);
  EXPECT_EQ(refusal(bench({configuration("first", 1, 1)})), "");
}

TEST_F(BenchText, PathsThatAreNoFilesAreRefused) {
  ASSERT_EQ(std::system(("mkfifo " + path("pipe")).c_str()), 0);
  for (const std::string& name : {path("none.json"), path("pipe"), folder.path(), std::string("/dev/zero")}) {
    try {
      chart::readBench({name});
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      expectHas(error.what(), name);
    }
  }
}

// The same measurement in two shards is one; two measurements of one configuration are two, and both are shown.
TEST_F(BenchText, ConfigurationsThatAreThereTwice) {
  const std::string a = write(bench({configuration("a", 1, 1), configuration("b", 1, 1)}), "a.json"),
                    b = write(bench({configuration("b", 1, 1), configuration("a", 2, 1)}), "b.json");
  const chart::Bench both = chart::readBench({a, b});
  EXPECT_EQ(both.configurations.size(), 3u);
  ASSERT_EQ(both.warnings.size(), 2u);
  expectHas(both.warnings[0], "b.json: configurations[0]: configuration b is there already");
  expectHas(both.warnings[1], "configuration a was measured more than once");
}

TEST_F(BenchText, PicturesStayInsideOfTheFolder) {
  TemporaryFolder elsewhere;
  std::ofstream(elsewhere.path() + "/secret.png") << "secret";
  fs::create_symlink(elsewhere.path(), path("link"));
  fs::create_directory(path("p"));
  write(std::string("\x89PNG\r\n\x1a\n"), "p/ok.png");
  const auto said = [&](const std::string& name) {
    Json c = configuration("a", 1, 1);
    c["pictures"] = {{"frame", name}};
    return refusal(bench({c}));
  };
  const std::string sibling = "../" + fs::path(elsewhere.path()).filename().string() + "/secret.png";
  expectHas(said(sibling), "configurations[0].pictures.frame: '" + sibling + "' leads out of");
  expectHas(said("p/../../x.png"), "leads out of");
  expectHas(said("link/secret.png"), "leads out of");
  expectHas(said(elsewhere.path() + "/secret.png"), "is absolute");
  expectHas(said(""), "no name of a file");
  expectHas(said(std::string("p/ok.png\0x", 10)), "no name of a file");
  for (const char* fine : {"p/ok.png", "./p/ok.png", "p/../p/ok.png"}) EXPECT_EQ(said(fine), "");
  // One that is missing, a folder or of an endless name is no reason to show nothing.
  for (const std::string& missing : {std::string("p/none.png"), std::string("p"), std::string(5000, 'x')}) {
    Json c = configuration("a", 1, 1);
    c["pictures"] = {{"frame", missing}};
    const chart::Bench b = chart::readBench({write(bench({c}))});
    ASSERT_EQ(b.warnings.size(), 1u) << missing.substr(0, 20);
    expectHas(b.warnings[0], "no picture");
    EXPECT_EQ(b.configurations.at(0).pictures.frame, "");
  }
}

}  // namespace
}  // namespace weir::test
