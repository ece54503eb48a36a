#include "laboratory.h"

#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/core/text.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <algorithm>
#include <cmath>

#include "support/device.h"

namespace weir::test {
namespace {

constexpr uint32_t kTile = 16;
constexpr uint32_t kReferenceSeed = 0x5eed0000u;  // far from every seed that is tested

uint32_t scaledBy(uint32_t restarts, double effort) {
  return std::max(8u, static_cast<uint32_t>(std::lround(restarts * effort)));
}

bool moves(const Situation& s, const render::Stage& stage) {
  return stage.playback.has_value() || s.camera != nullptr;
}

}  // namespace

Laboratory::Laboratory(const gpu::Device& device, const Situation& situation, double effort, double alpha)
    : device_(device),
      situation_(situation),
      effort_(effort),
      alpha_(alpha),
      registry_(pluginSearchPath({})),
      stage_(situation.stage()) {
  scene_ = std::make_unique<scene::SceneGpu>(device_, stage_.scene, stage_.prepared, true);
  // Where things move, the reference shows the frame that is looked at, and nothing before it.
  const uint32_t first = moves(situation_, stage_) ? situation_.frames - 1 : 0;
  const std::vector<std::string> nothing;
  const image::RestartAccumulator reference =
      run({situation_.reference, situation_.referenceSet, nothing, scaledBy(situation_.referenceRestarts, effort), 1,
           first, kReferenceSeed},
          stage_.prepared, *scene_, 0);
  truth_ = reference.mean();
  truthError_ = reference.standardError();
}

Laboratory::~Laboratory() = default;

image::RestartAccumulator Laboratory::run(const Words& words, const scene::PreparedScene& prepared,
                                          const scene::SceneGpu& scene, int mutant) {
  std::vector<std::pair<std::string, std::string>> defines;
  if (mutant > 0) defines.emplace_back("WEIR_MUTANT", std::to_string(mutant));
  shader::Compiler compiler({}, std::move(defines));
  graph::Overrides overrides;
  overrides.set = words.set;
  overrides.disable = words.disable;
  execute::Executor executor(
      device_, compiler, registry_, scene,
      graph::compileFile(sourcePath(words.graph), overrides, registry_.catalog(), situation_.size, situation_.size),
      {.backend = trace::chooseBackend("auto", device_)});
  render::Stage stage = stage_;
  stage.prepared = prepared;
  render::Player player(stage);
  image::RestartAccumulator result(kTile);
  render::FrameMean mean;
  const bool last = moves(situation_, stage);
  uint32_t taken = 0;
  const uint32_t wanted = last ? 1 : words.frames;
  executor.captureTo({"radiance"}, [&](const std::string&, const image::Picture& picture) {
    mean.add(picture);
    if (++taken < wanted) return;
    result.add(mean.mean());
    mean = render::FrameMean();
    taken = 0;
  });
  for (uint32_t r = 0; r < words.restarts; ++r) {
    executor.resetHistory();
    for (uint32_t f = words.firstFrame; f < words.firstFrame + words.frames; ++f) {
      execute::FrameInput input = player.frame(f, render::restartSeed(words.seed, r));
      if (situation_.camera) input.camera = situation_.camera(f);
      executor.frame(input, !last || f + 1 == words.firstFrame + words.frames);
    }
  }
  executor.finish();
  return result;
}

Finding Laboratory::examine(const Mutant* mutant, uint32_t seed) {
  const Clock::time_point start = Clock::now();
  scene::PreparedScene prepared = stage_.prepared;
  std::unique_ptr<scene::SceneGpu> broken;
  if (mutant != nullptr && mutant->host) {
    mutant->host(prepared);
    broken = std::make_unique<scene::SceneGpu>(device_, stage_.scene, prepared, true);
  }
  const image::RestartAccumulator measured =
      run({situation_.graph, situation_.set, situation_.disable, scaledBy(situation_.restarts, effort_),
           situation_.frames, 0, seed},
          prepared, broken ? *broken : *scene_, mutant != nullptr && !mutant->host ? mutant->number : 0);
  // Half of the false alarms for the tiles, half for the whole.
  const image::TileTest t =
      image::tileTest(measured.tiles(), truth_, &truthError_, {.alpha = 0.5 * alpha_, .eachColour = true});
  Finding f;
  f.relativeBias = t.relativeBias;
  f.low = t.intervalLow;
  f.high = t.intervalHigh;
  f.worstT = t.worstT;
  f.bound = t.bound;
  f.compared = measured.nonFinite() == 0;
  f.caught = !f.compared || !t.passed || !(t.intervalLow <= 0.0 && t.intervalHigh >= 0.0);
  f.seconds = millisecondsSince(start) / 1000.0;
  return f;
}

const Situation& situationNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const Situation& s : situations()) {
    if (s.name == name) return s;
    names.push_back(s.name);
  }
  throw InputError("situation '" + name + "' is not known; nearest is '" + nearestName(name, names) + "'");
}

}  // namespace weir::test
