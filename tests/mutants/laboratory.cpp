#include "laboratory.h"

#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/core/text.h>
#include <weir/graph/compile.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "support/device.h"

namespace weir::test {
namespace {

constexpr uint32_t kTile = 16, kCoarseTile = 64;  // pixels
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
  renderReference(kReferenceSeed);
}

void Laboratory::renderReference(uint32_t seed) {
  // Where things move, the reference shows the frame that is looked at, and nothing before it.
  const uint32_t first = moves(situation_, stage_) ? situation_.frames - 1 : 0;
  const std::vector<std::string> nothing;
  const Words words{situation_.reference,
                    situation_.referenceSet,
                    nothing,
                    scaledBy(situation_.referenceRestarts, effort_),
                    1,
                    first,
                    seed};
  if (!reference_) reference_ = executor(words, *scene_, compiler_);
  truth_ = run(*reference_, words, stage_).evidence();
}

Laboratory::~Laboratory() = default;

std::unique_ptr<execute::Executor> Laboratory::executor(const Words& words, const scene::SceneGpu& scene,
                                                        shader::Compiler& compiler) {
  graph::Overrides overrides;
  overrides.set = words.set;
  overrides.disable = words.disable;
  execute::ExecutorOptions options;
  options.backend = trace::chooseBackend("auto", device_);
  return std::make_unique<execute::Executor>(
      device_, compiler, registry_, scene,
      graph::compileFile(sourcePath(words.graph), overrides, registry_.catalog(), situation_.size, situation_.size),
      options);
}

image::EvidenceCollector Laboratory::run(execute::Executor& executor, const Words& words, const render::Stage& stage) {
  render::Player player(stage);
  image::EvidenceCollector result(kTile, kCoarseTile);
  render::FrameMean mean;
  const bool last = moves(situation_, stage);
  const uint32_t wanted = last ? 1 : words.frames;
  uint32_t taken = 0;
  executor.captureTo({"radiance"}, [&](const std::string&, const image::Picture& picture) {
    mean.add(picture);
    if (++taken < wanted) return;
    result.add(std::exchange(mean, {}).mean());
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
  const Words words{situation_.graph,
                    situation_.set,
                    situation_.disable,
                    scaledBy(situation_.restarts, effort_),
                    situation_.frames,
                    0,
                    seed};
  const auto collect = [&] {
    if (mutant == nullptr) {
      if (!clean_) clean_ = executor(words, *scene_, compiler_);
      return run(*clean_, words, stage_);
    }
    if (!mutant->host) {
      shader::Compiler compiler({}, {{"WEIR_MUTANT", std::to_string(mutant->number)}});
      return run(*executor(words, *scene_, compiler), words, stage_);
    }
    render::Stage stage = stage_;
    mutant->host(stage.prepared);
    const scene::SceneGpu broken(device_, stage.scene, stage.prepared, true);
    return run(*executor(words, broken, compiler_), words, stage);
  };
  const image::EvidenceCollector measured = collect();
  const image::Verdict v = image::decide(measured.evidence(), truth_, measured.nonFinite(), {.alpha = alpha_});
  const image::Comparison& worst = v.fine.tiles[v.fine.worst];
  Finding f;
  f.caught = v.answer == image::Answer::Biased;
  f.relativeBias = v.whole.relative;
  f.low = v.low;
  f.high = v.high;
  f.worstT = std::abs(worst.t);
  f.bound = image::criticalT(worst.freedom, v.fine.level);
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
