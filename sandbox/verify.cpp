// `weir verify`: exit status 0 unbiased, 1 biased (or failed), 2 bad input, 3 undecided.
#include <fmt/format.h>
#include <unistd.h>
#include <weir/render/verify.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "graph_options.h"
#include "render_options.h"

namespace {

using namespace weir;
using render::ReferenceKind;

struct Words {
  render::VerifyOptions options;
  std::string size = "256x256";
};

const char* kindWords(ReferenceKind kind) {
  switch (kind) {
    case ReferenceKind::Rendered:
      return "";
    case ReferenceKind::WithError:
      return ", with its standard error";
    case ReferenceKind::Exact:
      return ", taken as exact";
    case ReferenceKind::Scatter:
      break;
  }
  return ", its error taken from how its pixels scatter";
}

/// "known to …" of a scale where nothing is lit has no figure.
std::string knownTo(double v) {
  return std::isfinite(v) ? fmt::format("{:.3g} %", 100 * v) : std::string("nothing");
}

std::string percent(double v) {
  return std::isfinite(v) ? fmt::format("{:+.4g} %", 100 * v) : std::string("unknown");
}

void print(const render::Verification& v, const render::VerifyOptions& o) {
  const image::Verdict& d = v.verdict;
  std::string from = fmt::format("{} restarts", d.referenceRestarts);
  if (d.referenceRestarts == 0) from = "a file" + std::string(kindWords(v.kind));
  fmt::print("{} on {}: {} restarts of {} frame{}, {:.3g} s each; reference {}: {}\n", o.graph, v.scene, d.restarts,
             o.frames, o.frames == 1 ? "" : "s", v.secondsPerRestart, v.referenceName, from);
  const double confidence = 100 * (1 - o.verdict.alpha);
  fmt::print("whole picture: bias {}, between {} and {}\n", percent(d.whole.relative), percent(d.low), percent(d.high));
  for (const image::Scale* s : {&d.coarse, &d.fine}) {
    const image::Comparison& w = s->tiles[s->worst];
    fmt::print("tiles of {}²: worst |t| {:.2f} at {}, {} ({} in {}), {:.2f} alarms; half of them known to {}\n",
               s->grid.side, std::abs(w.t), s->grid.left(s->worst), s->grid.top(s->worst), percent(w.relative),
               s->colours[s->worst], image::criticalT(w.freedom, s->level), knownTo(s->resolution));
  }
  switch (d.answer) {
    case image::Answer::Unbiased:
      fmt::print("unbiased to {:.3g} % ({:g} %)\n", 100 * d.within, confidence);
      break;
    case image::Answer::Biased:
      fmt::print("biased ({:g} %):\n", confidence);
      break;
    case image::Answer::Undecided:
      fmt::print("undecided:\n");
      break;
  }
  for (const std::string& reason : d.reasons) fmt::print("  {}\n", reason);
  if (d.enough > 0)
    fmt::print("  run longer: about {} restarts should be enough (with another --seed: this look is used up)\n",
               d.enough);
  if (o.picture.ends_with(".png"))
    fmt::print("map → {} (left: how much, full colour at {:.3g} %; right: how sure; yellow: alarms)\n", o.picture,
               100 * render::fullColour(d, o.verdict.tolerance));
  else if (!o.picture.empty())
    fmt::print("mean minus reference → {}\n", o.picture);
  if (!o.json.empty()) fmt::print("numbers → {}\n", o.json);
}

void run(Words& words) {
  render::VerifyOptions& o = words.options;
  parseSize(words.size, o.width, o.height);
  o.warn = [](const std::string& text) { fmt::print(stderr, "warning: {}\n", text); };
  if (isatty(fileno(stderr)) != 0) {
    o.progress = [](const std::string& what, uint64_t done, uint64_t all) {
      fmt::print(stderr, "\r{} of {} {}", done, all, what);
      if (done == all) fmt::print(stderr, "\n");
      std::fflush(stderr);
    };
  }
  const render::Verification v = render::verify(o);
  print(v, o);
  if (v.verdict.answer == image::Answer::Biased) throw CommandStatus{1};
  if (v.verdict.answer == image::Answer::Undecided) throw CommandStatus{3};
}

void addReferenceOptions(CLI::App& command, render::VerifyOptions& o) {
  command.add_option("--reference", o.reference, "EXR to compare with; without it one is rendered here");
  command.add_option("--reference-stderr", o.referenceError,
                     "Its standard error: weir render … --restarts R --out radiance=R.exr --stderr radiance=E.exr");
  command.add_flag("--reference-exact", o.referenceExact, "The reference has no error, as a closed form");
  command.add_option("--reference-graph", o.referenceGraph,
                     "Graph whose radiance is the truth; default: the bundled reference.json with direct light alone");
  command.add_option("--reference-set", o.referenceOverrides.set, "pass.param=value in that graph")
      ->allow_extra_args(false);
  command.add_option("--reference-restarts", o.referenceRestarts, "Restarts of it; default: as --restarts");
  command.add_option("--reference-frames", o.referenceFrames, "Frames of such a restart, in a scene at rest")
      ->capture_default_str();
}

}  // namespace

void addVerifyCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("verify", "Is this graph's estimator unbiased on this scene?");
  command->footer(
      "Exit status: 0 unbiased; 1 biased, or failed while running (then a message on stderr begins with 'weir:'); 2 "
      "bad "
      "input; 3 undecided.");
  auto words = std::make_shared<Words>();
  auto& o = words->options;
  command->add_option("graph", o.graph, "Graph, a JSON file")->required();
  addStageOptions(*command, o.stage);
  command->add_option("--size", words->size, "Width x height in pixels")->capture_default_str();
  command->add_option("--restarts", o.restarts, "Independent repetitions, each one sample")->capture_default_str();
  command->add_option("--max-restarts", o.mostRestarts,
                      "While undecided, twice as many up to this; alpha is shared out among the looks");
  command
      ->add_option("--frames", o.frames,
                   "Frames of a restart: its sample is their mean, or with --animate the last one")
      ->capture_default_str();
  command->add_option("--first-frame", o.firstFrame, "Number of the first frame")->capture_default_str();
  command->add_option("--seed", o.seed, "Seed of the random numbers")->capture_default_str();
  command->add_option("--output", o.output, "Output of the graph that is looked at")->capture_default_str();
  command
      ->add_option("--lanes", o.lanes,
                   "Restarts that run at a time: a number, or auto for what fills the device; verdicts stay the same")
      ->capture_default_str();
  addOverrideOptions(*command, o.overrides);
  addReferenceOptions(*command, o);
  command->add_option("--tile", o.tile, "Side of the fine tiles in pixels; coarse ones have four times that")
      ->capture_default_str();
  command
      ->add_option("--alpha", o.verdict.alpha,
                   "Chance that an unbiased graph is called biased, save for light that hardly any restart has seen")
      ->capture_default_str();
  command->add_option("--tolerance", o.verdict.tolerance, "Unbiased means: the whole picture to this, relative")
      ->capture_default_str();
  command->add_option("--tile-tolerance", o.verdict.tileTolerance, "And half of the coarse tiles to this")
      ->capture_default_str();
  command->add_option("--negligible", o.verdict.negligible, "Relative differences up to this are rounding; 0 … 0.1")
      ->capture_default_str();
  command->add_option("--out", o.picture, ".png: map of where and how much; .exr: mean minus reference");
  command->add_option("--json", o.json, "File for the raw numbers of every tile");
  addDeviceOptions(*command, o.device.device, o.device.trace, o.device.validation);
  addPluginPath(*command, o.pluginPaths);
  command->callback([words] { run(*words); });
}
