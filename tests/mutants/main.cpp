// Runs every known bug through the test that should notice it, and clean runs through the same tests for their false
// alarms. On a GPU, with all its restarts; tools/mutants.sh calls it.
//   mutants --device NVIDIA --effort 4 --clean 100 --json mutants.json --table mutants.md
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/write_file.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "laboratory.h"

namespace {

using namespace weir;
using namespace weir::test;
using Json = nlohmann::ordered_json;

struct Words {
  std::string device, json, table;
  double effort = 1.0, alpha = kAlpha;
  uint32_t clean = 0, seed = 1;
  std::vector<int> only;
  std::vector<std::string> situations;
  bool list = false, cleanOnly = false;
};

Json toJson(const Finding& f) {
  return {{"caught", f.caught},       {"relative_bias", f.relativeBias}, {"interval", {f.low, f.high}},
          {"worst_tile_t", f.worstT}, {"tile_bound", f.bound},           {"seconds", f.seconds}};
}

/// Chance of so many false alarms or more in `runs` runs: Poisson's distribution, as each is rare.
double chanceOf(int alarms, double expected) {
  double fewer = 0.0, term = std::exp(-expected);
  for (int k = 0; k < alarms; ++k) {
    fewer += term;
    term *= expected / (k + 1);
  }
  return 1.0 - fewer;
}

void print(const std::string& name, const Finding& f) {
  fmt::print("{:<72} bias {:+8.3f} % ({:+.3f} … {:+.3f})  |t| {:6.1f} of {:.1f}  {:5.1f} s  {}\n", name,
             100 * f.relativeBias, 100 * f.low, 100 * f.high, f.worstT, f.bound, f.seconds,
             f.caught ? "seen" : "not seen");
  std::fflush(stdout);
}

class Program {
 public:
  explicit Program(const Words& words) : words_(words), device_({.choice = words.device}) {}

  int run() {
    Json j = {{"device", device_.info().name}, {"effort", words_.effort}, {"alpha", words_.alpha}};
    int missed = 0, small = 0, caught = 0;
    for (const Situation& s : situations()) {
      if (!words_.situations.empty() && std::ranges::find(words_.situations, s.name) == words_.situations.end())
        continue;
      std::unique_ptr<Laboratory> laboratory;
      const auto open = [&] {
        if (!laboratory) laboratory = std::make_unique<Laboratory>(device_, s, words_.effort, words_.alpha);
      };
      for (const Mutant& m : mutants()) {
        if (m.situation != s.name || words_.cleanOnly) continue;
        if (!words_.only.empty() && std::ranges::find(words_.only, m.number) == words_.only.end()) continue;
        open();
        const Finding f = laboratory->examine(&m, words_.seed);
        print(fmt::format("{} {}", m.number, m.bug), f);
        (f.caught ? caught : missed) += 1;
        small += std::abs(f.relativeBias) <= 0.02 ? 1 : 0;
        Json row = {{"number", m.number}, {"bug", m.bug}, {"situation", s.name}};
        row.update(toJson(f));
        j["mutants"].push_back(row);
        rows_[m.number] = fmt::format("| {} | {} | {} | {:+.2f} | {:.1f} | {:.1f} | {} |\n", m.number, m.bug, s.name,
                                      100 * f.relativeBias, f.worstT, f.bound, f.caught ? "yes" : "**no**");
      }
      for (uint32_t i = 0; i < words_.clean; ++i) {
        open();
        // Both sides are other random numbers each time: two runs against one reference would share its error.
        laboratory->renderReference(words_.seed + 0x51ea0000u + i);
        const Finding f = laboratory->examine(nullptr, words_.seed + 1000 + i);
        alarms_ += f.caught ? 1 : 0;
        ++cleanRuns_;
        if (f.caught || words_.clean <= 3) print(fmt::format("{}, clean, seed {}", s.name, words_.seed + 1000 + i), f);
        Json row = {{"situation", s.name}, {"seed", words_.seed + 1000 + i}};
        row.update(toJson(f));
        j["clean"].push_back(row);
      }
    }
    fmt::print("{} bugs caught, {} missed; {} of them move the mean by at most 2 %; {} false alarms in {} clean runs\n",
               caught, missed, small, alarms_, cleanRuns_);
    j["caught"] = caught;
    j["missed"] = missed;
    j["at_most_2_percent"] = small;
    j["clean_runs"] = cleanRuns_;
    j["false_alarms"] = alarms_;
    if (caught + missed + cleanRuns_ == 0) throw InputError("nothing to run: no bug is in one of these situations");
    if (!words_.json.empty()) render::writeTextFile(words_.json, j.dump(1) + "\n");
    if (!words_.table.empty()) writeTable(caught, missed);
    const bool honest = alarms_ == 0 || chanceOf(alarms_, words_.alpha * cleanRuns_) > 1e-3;
    if (!honest) fmt::print("that is more false alarms than chance explains\n");
    return missed > 0 || !honest ? 1 : 0;
  }

 private:
  void writeTable(int caught, int missed) const {
    std::string text =
        "| number | bug | seen in | moves the mean by, % | worst tile's \\|t\\| | bound | caught "
        "|\n|---:|---|---|---:|---:|---:|---|\n";
    for (const auto& [number, row] : rows_) text += row;
    text += fmt::format("\n{} of {} caught. {} false alarms in {} clean runs.\n", caught, caught + missed, alarms_,
                        cleanRuns_);
    render::writeTextFile(words_.table, text);
  }

  const Words& words_;
  gpu::Device device_;
  std::map<int, std::string> rows_;
  int alarms_ = 0, cleanRuns_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Words words;
  CLI::App app("Known bugs in estimators, and whether the tests notice them");
  app.add_option("--device", words.device);
  app.add_option("--effort", words.effort, "Restarts, as a multiple of the quick run's")
      ->check(CLI::Range(0.1, 1000.0));
  app.add_option("--alpha", words.alpha, "Chance of a false alarm in one run")->check(CLI::Range(1e-12, 0.5));
  app.add_option("--clean", words.clean, "Clean runs of every situation, each with a seed of its own");
  app.add_option("--seed", words.seed);
  app.add_option("--only", words.only, "Numbers of bugs");
  app.add_option("--situation", words.situations, "Names of situations");
  app.add_option("--json", words.json);
  app.add_option("--table", words.table, "Markdown");
  app.add_flag("--list", words.list);
  app.add_flag("--clean-only", words.cleanOnly, "No bugs, the clean runs alone");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    // CLI::Range lets NaN pass.
    if (!std::isfinite(words.effort) || !std::isfinite(words.alpha))
      throw InputError("--effort and --alpha must be numbers");
    if (words.cleanOnly && words.clean == 0) throw InputError("--clean-only needs --clean N");
    for (const std::string& name : words.situations) situationNamed(name);
    for (const int number : words.only) {
      if (std::ranges::none_of(mutants(), [&](const Mutant& m) { return m.number == number; }))
        throw InputError(fmt::format("there is no bug number {}; --list names them", number));
    }
    for (const Mutant& m : mutants()) situationNamed(m.situation);
    if (words.list) {
      for (const Mutant& m : mutants()) fmt::print("{:4} {:<18} {}\n", m.number, m.situation, m.bug);
      return 0;
    }
    return Program(words).run();
  } catch (const InputError& error) {
    fmt::print(stderr, "mutants: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "mutants: {}\n", error.what());
    return 1;
  }
}
