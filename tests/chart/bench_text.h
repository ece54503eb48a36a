// Small bench files made by hand, for tests that change something in them.
#pragma once

#include <gtest/gtest.h>
#include <weir/chart/chart.h>
#include <weir/chart/page.h>
#include <weir/core/error.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {

using Json = nlohmann::ordered_json;

/// Everything that must be there, and an error.
inline Json configuration(const std::string& id, double ms, double error) {
  return {{"id", id},
          {"graph", "made_up.json"},
          {"name", "made-up"},
          {"scene", {{"file", "made_up.glb"}}},
          {"size", {64, 48}},
          {"settings", {{"pick.count", 8}, {"spread.enabled", true}}},
          {"parameters", {{"pick.count", 8}, {"pick.mode", "even"}}},
          {"command", "weir bench made_up.json"},
          {"frames", 10},
          {"warmup", 1},
          {"passes",
           {{{"name", "surfaces"}, {"type", "gbuffer.Made"}, {"gpu_ms", {{"median", ms / 4}, {"p95", ms / 3}}}},
            {{"name", "pick"}, {"type", "made_up.Pick"}, {"gpu_ms", {{"median", ms / 2}, {"p95", ms / 2}}}}}},
          {"frame", {{"gpu_ms", {{"median", ms}, {"p95", 1.25 * ms}, {"p99", 2 * ms}}}, {"wall_ms", 1.5 * ms}}},
          {"error",
           {{"repeats", 2},
            {"frames", 4},
            {"relmse", {{"median", {{"value", error}, {"low", error / 2}, {"high", 2 * error}}}}},
            {"bias", {{"value", -0.01}, {"low", -0.03}, {"high", 0.02}}}}}};
}

inline Json bench(std::vector<Json> configurations) {
  return {{"weir_bench", 1}, {"device", "Made-up device"},
          {"driver", "1.0"}, {"trace", "pipeline"},
          {"weir", "0.0"},   {"configurations", std::move(configurations)}};
}

inline void expectHas(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "should say \"" << words << "\":\n" << text.substr(0, 4000);
}

class BenchText : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder.path() + "/" + name; }
  std::string write(const std::string& text, const std::string& name = "bench.json") const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  std::string write(const Json& json, const std::string& name = "bench.json") const { return write(json.dump(), name); }
  std::string read(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  /// What reading this says; empty when it is taken.
  std::string refusal(const std::string& text) const {
    try {
      chart::readBench({write(text)});
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  std::string refusal(const Json& json) const { return refusal(json.dump()); }
  TemporaryFolder folder;
};

}  // namespace weir::test
