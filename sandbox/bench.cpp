// `weir bench`, `weir bench merge` and `weir bench tables`.
#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/render/bench.h>
#include <weir/render/bench_file.h>
#include <weir/render/bench_plan.h>
#include <weir/render/bench_tables.h>
#include <weir/render/write_file.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>

#include "commands.h"
#include "graph_options.h"
#include "render_options.h"

namespace {

using namespace weir;
using render::BenchOptions;
using render::BenchPart;

struct Words {
  BenchOptions options;
  BenchPart part;  ///< of the command line
  std::string size = "1920x1080", crop, shard, scenes;
  std::vector<std::string> sweeps;
  bool noFlip = false, floor = false;
};

/// Numbers with one character between them, and nothing else.
bool numbers(const std::string& text, char between, std::span<uint32_t> to) {
  const char *at = text.data(), *end = at + text.size();
  for (size_t i = 0; i < to.size(); ++i) {
    if (i > 0 && (at == end || *at++ != between)) return false;
    const auto read = std::from_chars(at, end, to[i]);
    if (read.ec != std::errc()) return false;
    at = read.ptr;
  }
  return at == end;
}

void parseShard(const std::string& text, BenchOptions& o) {
  std::array<uint32_t, 2> both{};
  if (!numbers(text, '/', both) || both[0] >= both[1])
    throw InputError(
        fmt::format("--shard '{}': expected I/N, counted from 0: 0/4, 1/4, 2/4 and 3/4 are the shards of four", text));
  o.shard = both[0];
  o.shards = both[1];
}

render::Crop parseCrop(const std::string& text) {
  render::Crop crop{};
  if (!numbers(text, ',', crop))
    throw InputError(fmt::format("--crop '{}': expected x,y,width,height in pixels", text));
  return crop;
}

/// What the command line says of settings goes before what the plan says.
void usePlan(const CLI::App& command, Words& words) {
  BenchOptions& o = words.options;
  for (const char* name : {"graph",
                           "--scene",
                           "--lights",
                           "--light-seed",
                           "--replace-lights",
                           "--environment",
                           "--environment-scale",
                           "--environment-rotation",
                           "--camera",
                           "--energy-compensation",
                           "--animate",
                           "--set",
                           "--enable",
                           "--disable",
                           "--sweep",
                           "--reference",
                           "--reference-exact",
                           "--reference-graph",
                           "--reference-set",
                           "--reference-frames",
                           "--reference-restarts"})
    if (command.get_option(name)->count() > 0)
      throw InputError(fmt::format("{} and --plan: the plan says what is measured", name));
  const render::BenchSettings given = o.settings;
  render::BenchPlan plan = render::loadBenchPlan(o.plan, words.scenes);
  o.parts = std::move(plan.parts);
  o.settings = plan.settings;
  const auto said = [&](const char* name) { return command.get_option(name)->count() > 0; };
  if (said("--warmup")) o.settings.warmup = given.warmup;
  if (said("--frames")) o.settings.frames = given.frames;
  if (said("--first-frame")) o.settings.firstFrame = given.firstFrame;
  if (said("--seed")) o.settings.seed = given.seed;
  if (said("--repeats")) o.settings.repeats = given.repeats;
  if (said("--error-frames")) o.settings.errorFrames = given.errorFrames;
  if (said("--error-every")) o.settings.errorEvery = given.errorEvery;
  if (said("--output")) o.settings.output = given.output;
  if (said("--no-flip")) o.settings.flip = given.flip;
  if (said("--crop")) o.settings.crop = given.crop;
  for (BenchPart& part : o.parts)
    if (said("--size")) parseSize(words.size, part.width, part.height);
}

std::string shown(double value, const char* unit) {
  return std::isfinite(value) ? fmt::format("{:.4g}{}", value, unit) : std::string("unknown");
}

void print(const render::BenchRecord& r) {
  const double ms = r.cost.frameGpuMs ? r.cost.frameGpuMs->median : r.cost.wallMs;
  std::string line = fmt::format("{} {}:", r.id, r.graph);
  for (const auto& [name, value] : r.settings) line += fmt::format(" {}={}", name, toText(value));
  line += fmt::format(" {:.3f} ms", ms);
  if (r.error) {
    line += fmt::format(", relMSE {}, bias {}, τ {}", shown(r.error->frameMedian.value, ""),
                        shown(100 * r.error->bias.value, " %"), shown(r.error->correlationTime.value, ""));
  }
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void run(const CLI::App& command, Words& words) {
  BenchOptions& o = words.options;
  o.settings.flip = !words.noFlip;
  if (words.floor) o.floor = render::measureFloor;
  if (!words.crop.empty()) o.settings.crop = parseCrop(words.crop);
  if (!words.shard.empty()) parseShard(words.shard, o);
  if (o.out.empty()) throw InputError("--out FILE.json is required");
  if (!o.plan.empty()) {
    usePlan(command, words);
  } else {
    if (!words.scenes.empty()) throw InputError("--scenes needs --plan");
    if (words.part.graphs.empty()) throw InputError("no graph is named: weir bench GRAPH... or --plan FILE");
    if (words.part.stage.scene.empty()) throw InputError("--scene is required");
    parseSize(words.size, words.part.width, words.part.height);
    for (const std::string& text : words.sweeps) words.part.sweeps.push_back(render::parseSweep(text));
    o.parts = {words.part};
  }
  o.warn = [](const std::string& text) { fmt::print(stderr, "warning: {}\n", text); };
  if (isatty(fileno(stderr)) != 0) {
    o.progress = [](const std::string& what, size_t number, size_t all) {
      fmt::print(stderr, "{} of {}: {}\n", number, all, what);
    };
  }
  const render::BenchOutcome outcome = render::bench(o, print);
  fmt::print("{} of {} configurations measured, {} were there already{} → {}\n", outcome.measured, outcome.own,
             outcome.there, o.shards > 1 ? fmt::format(" (shard {}/{})", o.shard, o.shards) : "", o.out);
}

/// InputError when words of `weir bench` itself stand before one of its subcommands, which would ignore them.
void requireAlone(const CLI::App& bench, const char* subcommand) {
  for (const CLI::Option* option : bench.get_options())
    if (option->count() > 0)
      throw InputError(fmt::format("weir bench {} takes no {}; see weir bench {} --help", subcommand,
                                   option->get_name(), subcommand));
}

void merge(const std::vector<std::string>& files, const std::string& out) {
  if (!out.ends_with(".json")) throw InputError(fmt::format("--out {}: the file must end in .json", out));
  render::checkWritable(out);
  const render::Merged merged = render::mergeBenchFiles(files, out);
  render::writeBenchFile(out, merged.file);
  fmt::print("{} configurations → {}\n", merged.file.configurations.size(), out);
  if (merged.missing.empty()) return;
  fmt::print(stderr, "weir: {} of {} configurations are in none of the files:\n", merged.missing.size(),
             merged.file.planned.size());
  for (const std::string& label : merged.missing) fmt::print(stderr, "  {}\n", label);
  throw CommandStatus{1};
}

void tables(const std::string& file, const std::string& plan, const std::string& out) {
  const render::BenchPlan loaded = render::loadBenchPlan(plan);
  if (loaded.tables.empty()) throw InputError(fmt::format("{} has no tables", plan));
  const std::string text = render::benchTables(render::readBenchFile(file), loaded);
  if (out.empty()) {
    fmt::print("{}", text);
    return;
  }
  render::checkWritable(out);
  render::requireDistinct({{"--out", out}}, {{"the bench file", file}, {"--plan", plan}});
  render::writeTextFile(out, text);
}

void addErrorOptions(CLI::App& command, Words& words) {
  render::BenchReference& r = words.part.reference;
  render::BenchSettings& s = words.options.settings;
  command.add_option("--reference", r.file, "EXR to measure errors against");
  command.add_flag("--reference-exact", r.exact, "The reference has no error, as a closed form");
  command.add_option("--reference-graph", r.graph,
                     "Or: render it with this graph, as graphs/all_lights.json; its radiance is the truth");
  command.add_option("--reference-set", r.overrides.set, "pass.param=value in that graph")->allow_extra_args(false);
  command.add_option("--reference-frames", r.frames, "Frames of a restart of it")->capture_default_str();
  command.add_option("--reference-restarts", r.restarts, "Restarts of it; two or more tell its own error")
      ->capture_default_str();
  command.add_option("--repeats", s.repeats, "Independent restarts that errors and their intervals come from")
      ->capture_default_str();
  command.add_option("--error-frames", s.errorFrames, "Frames of each, after the warm-up")->capture_default_str();
  command.add_option("--error-every", s.errorEvery, "Compare every so many frames by themselves; means are of all")
      ->capture_default_str();
  command.add_option("--output", s.output, "Output of the graphs that is compared")->capture_default_str();
  command.add_flag("--no-flip", words.noFlip, "Leave FLIP out, which takes longest on the host");
  command.add_option("--crop", words.crop,
                     "x,y,width,height of the pictures that are kept; default: 256x256 in the middle");
}

void addMerge(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("merge", "Put the files of a bench's shards together");
  command->footer(
      "Exit status: 0 complete; 1 configurations are missing, which are listed (the file is written); 2 bad input.");
  auto files = std::make_shared<std::vector<std::string>>();
  auto out = std::make_shared<std::string>();
  command->add_option("files", *files, "Files that `weir bench --shard` has written")->required();
  command->add_option("--out", *out, "FILE.json; FILE.csv is written beside it")->required();
  command->callback([files, out, &bench] {
    requireAlone(bench, "merge");
    merge(*files, *out);
  });
}

void addTables(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("tables", "Print the tables of a plan, as Markdown");
  auto file = std::make_shared<std::string>();
  auto plan = std::make_shared<std::string>();
  auto out = std::make_shared<std::string>();
  command->add_option("file", *file, "What `weir bench --plan` has written")->required();
  command->add_option("--plan", *plan, "The plan that has the tables")->required();
  command->add_option("--out", *out, "File to write them to instead");
  command->callback([file, plan, out, &bench] {
    requireAlone(bench, "tables");
    tables(*file, *plan, *out);
  });
}

}  // namespace

void addBenchCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure what graphs cost and how far their pictures are from a reference");
  command->footer(
      "Started again with the same words it goes on where it was stopped. Two of several shards can run at a time, on\n"
      "devices of their own: --shard 0/2 --out a.json and --shard 1/2 --out b.json, then weir bench merge a.json "
      "b.json.\n"
      "docs/bench.md has the formats.");
  auto words = std::make_shared<Words>();
  BenchOptions& o = words->options;
  command->add_option("graph", words->part.graphs, "Graphs, JSON files");
  addStageOptions(*command, words->part.stage);
  command->get_option("--scene")->required(false);  // a plan names its own
  command->add_option("--size", words->size, "Width x height in pixels")->capture_default_str();
  addOverrideOptions(*command, words->part.overrides);
  command
      ->add_option("--sweep", words->sweeps, "pass.param=a,b,c or pass.enabled=true,false; several: every combination")
      ->allow_extra_args(false);
  command->add_option("--plan", o.plan, "JSON file that says what to measure instead");
  command->add_option("--scenes", words->scenes, "Folder that a plan's scenes are in; default: the plan's own");
  command->add_option("--warmup", o.settings.warmup, "Frames before others are timed or compared")
      ->capture_default_str();
  command->add_option("--frames", o.settings.frames, "Frames that are timed")->capture_default_str();
  command->add_option("--first-frame", o.settings.firstFrame, "Number of the first frame")->capture_default_str();
  command->add_option("--seed", o.settings.seed, "Seed of the random numbers")->capture_default_str();
  addErrorOptions(*command, *words);
  command->add_option("--out", o.out, "FILE.json; FILE.csv and FILE.pictures are written beside it");
  command->add_flag("--floor", words->floor,
                    "Also measure what the rays and buffers of each configuration cost at the least");
  command->add_flag("--fresh", o.fresh, "Measure again what FILE.json has");
  command->add_option("--shard", words->shard, "I/N: every N-th configuration from the I-th on, counted from 0");
  addDeviceOptions(*command, o.device.device, o.device.trace, o.device.validation);
  addPluginPath(*command, o.pluginPaths);
  addMerge(*command);
  addTables(*command);
  command->callback([command, words] {
    if (command->get_subcommands().empty()) run(*command, *words);
  });
}
