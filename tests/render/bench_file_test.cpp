// Bench files: what is read back, merged, flattened, tabulated, and what is refused.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/render/bench_file.h>
#include <weir/render/bench_record.h>
#include <weir/render/bench_tables.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "support/device.h"

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;
using test::TemporaryFolder;

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

std::string idOf(int i) {
  std::string id = "0000000000000000";
  id[15] = static_cast<char>('0' + i);
  return id;
}

std::string record(int i, double ms = 1.0, double error = 0.5, int candidates = 8) {
  BenchRecord r;
  r.id = idOf(i);
  r.graph = "g, \"quoted\".json";
  r.name = "g";
  r.command = "weir bench g.json";
  r.frames = 100;
  r.parameters["initial.candidates"] = candidates;
  r.parameters["initial.uniformShare"] = 0.1f;
  r.cost.passes = {{"gbuffer", "gbuffer.RayTraced", Quantiles{0.5, 0.6, 0.7}, 0.1, 16, 32}};
  r.cost.frameGpuMs = Quantiles{ms, ms * 1.01, ms * 1.02};
  r.cost.wallMs = NAN;
  ErrorMeasure e;
  e.repeats = 4;
  e.frames = 64;
  e.frameMedian = e.frameMean = e.frameTrimmed = {error, error - 0.01, error + 0.01};
  e.means = {{64, {error / 10, error / 11, error / 9}}};
  e.trimmedMeans = e.means;
  e.bias = {0.0, -0.001, 0.001};
  e.correlationTime = {NAN, NAN, NAN};
  r.error = e;
  r.pictures = PictureNames{{0, 0, 1, 1}, "a.pictures/" + r.id + ".png", "a.pictures/r.png", ""};
  return recordJson(r);
}

BenchFile file(const std::vector<int>& measured, int planned = 4) {
  BenchFile f;
  f.device = "d";
  f.driver = "v";
  f.trace = "pipeline";
  f.weir = "0 0";
  for (int i = 0; i < planned; ++i) f.planned.push_back({idOf(i), "label " + std::to_string(i), {"s"}});
  for (const int i : measured) f.configurations.push_back({idOf(i), record(i)});
  return f;
}

std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.write("f.json", text);
  try {
    readBenchFile(path);
  } catch (const InputError& error) {
    EXPECT_TRUE(has(error.what(), path)) << error.what();
    return error.what();
  }
  return "not refused";
}

TEST(BenchFile, ComesBackAsItWasInThePlansOrder) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/f.json";
  BenchFile f = file({2, 0});
  f.configurations.push_back({idOf(9), record(9)});  // of an earlier plan
  f.shard = 1;
  f.shards = 3;
  writeBenchFile(path, f);
  const BenchFile back = readBenchFile(path);
  EXPECT_EQ(back.conflict(f), "");
  EXPECT_EQ(back.planned, f.planned);
  EXPECT_EQ(back.shard, 1u);
  EXPECT_EQ(back.shards, 3u);
  ASSERT_EQ(back.configurations.size(), 3u);
  EXPECT_EQ(back.configurations[0].id, idOf(0));
  EXPECT_EQ(back.configurations[2].id, idOf(9));
  EXPECT_EQ(back.configurations[0].json, record(0));
  EXPECT_TRUE(std::filesystem::exists(folder.path() + "/f.csv"));
}

TEST(BenchFile, HasNoNumbersThatJsonLacksAndFloatsAsTheyAreWritten) {
  const Json j = Json::parse(record(1));
  EXPECT_TRUE(j.at("frame").at("wall_ms").is_null());
  EXPECT_TRUE(j.at("error").at("correlation_time").at("value").is_null());
  EXPECT_EQ(j.at("parameters").at("initial.uniformShare").dump(), "0.1");
  EXPECT_FALSE(j.contains("floor"));
  EXPECT_FALSE(j.at("pictures").contains("flip"));
}

TEST(BenchFile, RefusesWhatIsNone) {
  const std::string good = benchFileText(file({0, 1}));
  EXPECT_EQ(refusal(good), "not refused");
  EXPECT_TRUE(has(refusal(""), "not valid JSON"));
  EXPECT_TRUE(has(refusal("{"), "not valid JSON"));
  EXPECT_TRUE(has(refusal("[]"), "weir_bench"));
  EXPECT_TRUE(has(refusal("{}"), "weir_bench"));
  EXPECT_TRUE(has(refusal(std::string(1'000'000, '[')), "nested deeper"));
  EXPECT_TRUE(has(refusal(std::string(1'000'000, ']')), "not valid JSON"));
  EXPECT_TRUE(has(refusal(good.substr(0, good.size() / 2)), "not valid JSON"));
  const auto changed = [&](const std::function<void(Json&)>& change) {
    Json j = Json::parse(good);
    change(j);
    return refusal(j.dump());
  };
  EXPECT_TRUE(has(changed([](Json& j) { j["weir_bench"] = 2; }), "its version is 2"));
  EXPECT_TRUE(has(changed([](Json& j) { j["weir_bench"] = "x"; }), "its version"));
  EXPECT_TRUE(has(changed([](Json& j) { j.erase("device"); }), "\"device\""));
  EXPECT_TRUE(has(changed([](Json& j) { j["driver"] = 3; }), "\"driver\""));
  EXPECT_TRUE(has(changed([](Json& j) { j.erase("plan"); }), "\"plan\""));
  EXPECT_TRUE(has(changed([](Json& j) { j["plan"]["shard"] = -1; }), "\"shard\""));
  EXPECT_TRUE(has(changed([](Json& j) { j["plan"]["configurations"][0]["sweeps"] = {1}; }), "\"sweeps\""));
  EXPECT_TRUE(has(changed([](Json& j) { j["configurations"] = 1; }), "\"configurations\""));
  EXPECT_TRUE(has(changed([](Json& j) { j["configurations"][0] = 1; }), "must be an object"));
  EXPECT_TRUE(has(changed([](Json& j) { j["configurations"][0]["id"] = "../../etc/passwd"; }), "hexadecimal"));
  EXPECT_TRUE(has(changed([](Json& j) { j["configurations"][0]["id"] = idOf(1); }), "there twice"));
  // What only figures lack is no crash of whoever shows them.
  Json odd = Json::parse(good);
  odd["configurations"][0] = {{"id", idOf(0)}, {"passes", 3}, {"frame", {1}}, {"error", "x"}, {"parameters", {2}}};
  const TemporaryFolder folder;
  const BenchFile read = readBenchFile(folder.write("odd.json", odd.dump()));
  EXPECT_FALSE(benchCsv(read).empty());
  BenchPlan plan;
  plan.tables = {{"1", "", "s", {"initial.candidates"}, {}, ""}};
  EXPECT_TRUE(has(benchTables(read, plan), "| ? |"));
}

TEST(BenchFile, MergesShardsAndNamesWhatIsMissing) {
  const TemporaryFolder folder;
  const std::string a = folder.path() + "/a.json", b = folder.path() + "/b.json";
  std::filesystem::create_directories(folder.path() + "/deeper");
  writeBenchFile(a, file({0, 2}));
  writeBenchFile(b, file({2, 1}));
  const Merged merged = mergeBenchFiles({b, a}, folder.path() + "/deeper/m.json");
  EXPECT_EQ(merged.file.configurations.size(), 3u);
  EXPECT_EQ(merged.missing, (std::vector<std::string>{"label 3 (" + idOf(3) + ")"}));
  const Json j = Json::parse(benchFileText(merged.file));
  EXPECT_EQ(j.at("configurations").at(0).at("id"), idOf(0));
  EXPECT_EQ(j.at("configurations").at(0).at("pictures").at("frame"), "../a.pictures/" + idOf(0) + ".png");
  EXPECT_EQ(mergeBenchFiles({a}, a).file.configurations[0].json, record(0));
}

TEST(BenchFile, MergesOnlyWhatBelongsTogether) {
  const TemporaryFolder folder;
  const std::string a = folder.path() + "/a.json", b = folder.path() + "/b.json";
  writeBenchFile(a, file({0}));
  const auto refused = [&](const std::function<void(BenchFile&)>& change) {
    BenchFile f = file({1});
    change(f);
    writeBenchFile(b, f);
    try {
      mergeBenchFiles({a, b}, folder.path() + "/m.json");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  EXPECT_EQ(refused([](BenchFile&) {}), "not refused");
  EXPECT_TRUE(has(refused([](BenchFile& f) { f.device = "e"; }), "device: 'd' and 'e'"));
  EXPECT_TRUE(has(refused([](BenchFile& f) { f.driver = "e"; }), "driver"));
  EXPECT_TRUE(has(refused([](BenchFile& f) { f.trace = "query"; }), "trace"));
  EXPECT_TRUE(has(refused([](BenchFile& f) { f.weir = "1 1"; }), "weir"));
  EXPECT_TRUE(has(refused([](BenchFile& f) { f.planned.pop_back(); }), "different plans"));
}

TEST(BenchFile, BecomesATable) {
  const std::string csv = benchCsv(file({0, 1}));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_TRUE(has(csv, "parameters.initial.candidates"));
  EXPECT_TRUE(has(csv, "passes.gbuffer.gpu_ms.median"));
  EXPECT_TRUE(has(csv, "error.relmse.median.low"));
  EXPECT_TRUE(has(csv, "\"g, \"\"quoted\"\".json\""));
}

TEST(Tables, StandBesidePublishedFiguresAndFindInertKnobs) {
  BenchPlan plan;
  plan.tables = {{"6.7", "neighbours", "s", {"initial.candidates"}, {{"8", 9.8}}, "somebody"}};
  BenchFile f = file({});
  f.configurations = {{idOf(1), record(1, 1.0, 0.5, 8)}, {idOf(0), record(0, 1.002, 0.505, 32)}};
  const std::string inert = benchTables(f, plan);
  EXPECT_TRUE(has(inert, "### 6.7: neighbours")) << inert;
  EXPECT_LT(inert.find("| 8 |"), inert.find("| 32 |"));
  EXPECT_TRUE(has(inert, "| 8 | 9.8 | 1.000 | 0.5 ± 0.01 |")) << inert;
  EXPECT_TRUE(has(inert, "| 32 |  | 1.002 |")) << inert;
  EXPECT_TRUE(has(inert, "label 3 |  | not measured |")) << inert;
  EXPECT_TRUE(has(inert, "Inert?")) << inert;
  f.configurations[1].json = record(0, 1.1, 0.505, 32);  // ten times the noise of its median, and more than 1 %
  EXPECT_FALSE(has(benchTables(f, plan), "Inert?"));
  f.configurations[1].json = record(0, 1.002, 0.6, 32);  // intervals apart
  EXPECT_FALSE(has(benchTables(f, plan), "Inert?"));
}

}  // namespace
}  // namespace weir::render
