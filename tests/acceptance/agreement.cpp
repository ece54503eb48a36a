// Do the unbiased settings of restir_di agree with the brute-force reference? Several verdicts of `weir verify` over
// one scene and one reference. A program rather than a test: on a GPU it runs long enough to resolve a bias of some
// hundredths of a percent. Prints a row a setting and, with --json, writes the raw numbers.
//   agreement --scene scenes/cornell.glb --size 256 --restarts 256 --frames 4 --modes
//   agreement --scene scenes/cornell-moving.glb --animate --time 0.3 --time-step 0.1 --size 256 --restarts 256 --frames
//   6
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/verdict.h>
#include <weir/render/laboratory.h>
#include <weir/render/lanes.h>
#include <weir/render/write_file.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace {

using namespace weir;
using Json = nlohmann::ordered_json;

struct Words {
  render::StageOptions stage;
  std::string device, trace = "auto", json, graphs = "graphs", lanes = "auto";
  uint32_t size = 256, restarts = 64, frames = 4, referenceRestarts = 64, referenceSamples = 4, tile = 16, seed = 0;
  std::vector<std::string> set, only = {""};
  bool modes = false;
};

/// One sample a restart: the mean of its frames, or, where a clip moves the scene, the last one, number words.frames
/// - 1.
image::EvidenceCollector collect(const Words& words, render::Laboratory& laboratory, const std::string& graph,
                                 const graph::Overrides& overrides, uint32_t restarts, uint32_t frames, uint32_t seed) {
  const bool moves = laboratory.stage().playback.has_value();
  render::Restarts runs(laboratory, laboratory.compile(words.graphs + "/" + graph, overrides, words.size, words.size),
                        {.frames = frames,
                         .firstFrame = moves ? words.frames - frames : 0,
                         .seed = seed,
                         .lastOnly = moves,
                         .lanes = render::parseLanes(words.lanes)});
  image::EvidenceCollector result(words.tile, 4 * words.tile);
  runs.run(restarts, [&](std::span<const image::Picture> pictures) { result.add(pictures); });
  return result;
}

struct Setting {
  std::string name;
  std::vector<std::string> set, disable;
};

/// Parameters of one mode for every reuse; `late`: no visibility before the last shadow ray.
std::vector<std::string> modeSettings(const std::string& mis, bool late) {
  std::vector<std::string> set;
  for (const std::string pass : {"temporal", "spatial"}) {
    set.push_back(pass + ".mis=" + mis);
    set.push_back(fmt::format("{}.visibilityRays={}", pass, !late));
  }
  set.push_back(fmt::format("initial.visibility={}", !late));
  return set;
}

/// Pairwise with rays, in four kinds of reuse; with --modes every combination that docs/estimators.md calls unbiased.
std::vector<Setting> settingsOf(const Words& words) {
  const std::vector<Setting> reuses = {{"temporal", {}, {"spatial"}}, {"spatial", {}, {"temporal"}}, {"both", {}, {}}};
  std::vector<Setting> settings = {{"no reuse", {}, {"temporal", "spatial"}}};
  if (!words.modes) {
    for (Setting reuse : reuses) {
      reuse.set = modeSettings("pairwise", false);
      settings.push_back(reuse);
    }
    return settings;
  }
  settings.push_back({"no reuse, bsdfRays", {"initial.bsdfRays=1"}, {"temporal", "spatial"}});
  for (const char* mis : {"z", "balance", "pairwise"}) {
    for (const bool late : {false, true}) {
      for (const Setting& reuse : reuses)
        settings.push_back({fmt::format("{}, {}, {}", mis, late ? "late" : "rays", reuse.name), modeSettings(mis, late),
                            reuse.disable});
      Setting twice{
          fmt::format("{}, {}, both, spatial twice", mis, late ? "late" : "rays"), modeSettings(mis, late), {}};
      twice.set.emplace_back("spatial.iterations=2");
      settings.push_back(twice);
    }
    Setting rays{fmt::format("{}, rays, both, bsdfRays", mis), modeSettings(mis, false), {}};
    rays.set.emplace_back("initial.bsdfRays=1");
    settings.push_back(rays);
  }
  return settings;
}

int run(const Words& words) {
  render::parseLanes(words.lanes);  // before anything else, as a bad word ends it all
  render::Laboratory laboratory({});
  laboratory.open(words.stage, {.device = words.device, .trace = words.trace}, 1.0f);
  const image::Evidence reference =
      collect(words, laboratory, "all_lights.json", {.set = {fmt::format("direct.samples={}", words.referenceSamples)}},
              words.referenceRestarts, 1, words.seed + 1000)
          .evidence();

  std::vector<Setting> settings = settingsOf(words);
  std::erase_if(settings, [&](const Setting& s) {
    return std::ranges::none_of(words.only, [&](const std::string& part) { return s.name.starts_with(part); });
  });
  if (settings.empty()) throw InputError("--only leaves no setting");
  Json j = {{"device", laboratory.device().info().name},
            {"scene", laboratory.stage().sceneLabel},
            {"lights", laboratory.stage().lightsLabel},
            {"camera", laboratory.stage().cameraLabel},
            {"animation", render::animationLabel(laboratory.stage(), words.frames - 1, words.frames - 1)},
            {"time_step", laboratory.stage().playback ? laboratory.stage().playback->step : 0.0},
            {"size", words.size},
            {"restarts", words.restarts},
            {"frames", words.frames},
            {"reference_restarts", words.referenceRestarts},
            {"reference_strata", words.referenceSamples * words.referenceSamples},
            {"set", words.set}};
  fmt::print("{} | {}², {} restarts of {} frames, tiles of {}²\n", laboratory.stage().sceneLabel, words.size,
             words.restarts, words.frames, words.tile);
  bool passed = true;
  for (const Setting& s : settings) {
    graph::Overrides overrides;
    overrides.set = s.set;
    overrides.set.insert(overrides.set.end(), words.set.begin(), words.set.end());
    overrides.disable = s.disable;
    const auto measured =
        collect(words, laboratory, "restir_di.json", overrides, words.restarts, words.frames, words.seed);
    const image::Verdict v = image::decide(measured.evidence(), reference, measured.nonFinite());
    const image::Comparison& worst = v.fine.tiles[v.fine.worst];
    fmt::print(
        "{:32} {:9} worst |t| {:5.2f} of {} tiles, mean bias {:+.4f} % ({:+.4f} … {:+.4f}), a tile to {:.2f} %\n",
        s.name, image::answerName(v.answer), std::abs(worst.t), v.fine.tiles.size(), 100 * v.whole.relative,
        100 * v.low, 100 * v.high, 100 * v.fine.resolution);
    for (const std::string& reason : v.reasons) fmt::print("{:32} {}\n", "", reason);
    std::fflush(stdout);
    passed = passed && v.answer != image::Answer::Biased;
    j["settings"].push_back({{"name", s.name},
                             {"verdict", image::answerName(v.answer)},
                             {"worst_t", std::abs(worst.t)},
                             {"worst_tile", {v.fine.grid.left(v.fine.worst), v.fine.grid.top(v.fine.worst)}},
                             {"worst_relative", worst.relative},
                             {"bound", image::criticalT(worst.freedom, v.fine.level)},
                             {"tiles", v.fine.tiles.size()},
                             {"mean_bias", v.whole.relative},
                             {"interval", {v.low, v.high}},
                             {"detectable", v.fine.resolution},
                             {"passed", v.answer != image::Answer::Biased}});
    // After each setting: what was found stays if somebody stops a long run.
    if (!words.json.empty()) render::writeTextFile(words.json, j.dump(2) + "\n");
  }
  return passed ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  Words words;
  CLI::App app("Do the unbiased settings of restir_di agree with reference.AllLights?");
  app.add_option("--scene", words.stage.scene)->required();
  app.add_option("--lights", words.stage.lights);
  app.add_option("--light-seed", words.stage.lightSeed);
  app.add_flag("--replace-lights", words.stage.replaceLights, "With --lights: the scene's own go");
  app.add_option("--environment", words.stage.environment);
  app.add_option("--camera", words.stage.camera);
  app.add_flag("--animate", words.stage.animate, "Compare the last frame of a scene that a clip moves");
  app.add_option("--clip", words.stage.clip);
  app.add_option("--time", words.stage.time);
  app.add_option("--time-step", words.stage.timeStep);
  app.add_option("--size", words.size);
  app.add_option("--restarts", words.restarts);
  app.add_option("--frames", words.frames);
  app.add_option("--reference-restarts", words.referenceRestarts);
  app.add_option("--reference-samples", words.referenceSamples);
  app.add_option("--tile", words.tile);
  app.add_option("--seed", words.seed);
  app.add_option("--set", words.set)->allow_extra_args(false);
  app.add_option("--lanes", words.lanes, "Restarts that run at a time: a number or auto");
  app.add_option("--device", words.device);
  app.add_option("--trace", words.trace);
  app.add_option("--graphs", words.graphs, "Folder with restir_di.json and all_lights.json");
  app.add_flag("--modes", words.modes, "Every unbiased combination of MIS weights, visibility and reuse");
  app.add_option("--only", words.only, "Settings whose names begin so");
  app.add_option("--json", words.json);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(words);
  } catch (const std::exception& error) {
    fmt::print(stderr, "agreement: {}\n", error.what());
    return 2;
  }
}
