// `weir compare`: a picture against a reference, in figures.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/metrics.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace {

using namespace weir;
using Json = nlohmann::ordered_json;

struct Options {
  std::string picture, reference, mask;
  uint32_t tiles = 0;
  bool json = false, force = false, noFlip = false;
};

struct Comparison {
  bool hdr = true;
  std::vector<std::string> conflicts;  // only with --force; otherwise they are an error
  image::Metrics metrics;
  image::TileSummary tiles;
};

/// JSON has no NaN: null says that there is no such figure.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Comparison compare(const Options& options) {
  const bool radiance = image::fileKind(options.picture) != image::FileKind::Png;
  if (radiance != (image::fileKind(options.reference) != image::FileKind::Png)) {
    throw InputError(fmt::format("only one of '{}' and '{}' is a PNG: radiance and display values cannot be compared",
                                 options.picture, options.reference));
  }
  const image::Picture picture = image::readPicture(options.picture), reference = image::readPicture(options.reference);
  if (picture.width != reference.width || picture.height != reference.height) {
    throw InputError(fmt::format("'{}' is {}x{} pixels, the reference '{}' {}x{}", options.picture, picture.width,
                                 picture.height, options.reference, reference.width, reference.height));
  }
  Comparison result;
  result.conflicts = image::attributeConflicts(picture, reference);
  if (!result.conflicts.empty() && !options.force) {
    throw InputError(fmt::format("'{}' and '{}' show different things (--force compares them nevertheless):\n  {}",
                                 options.picture, options.reference, fmt::join(result.conflicts, "\n  ")));
  }
  image::Picture mask;
  if (!options.mask.empty()) mask = image::readPicture(options.mask);
  const image::Picture* maskOrAll = options.mask.empty() ? nullptr : &mask;
  result.hdr = radiance;
  result.metrics = image::measure(picture, reference, {.mask = maskOrAll, .hdr = result.hdr, .flip = !options.noFlip});
  if (result.metrics.pixels == 0) {
    throw InputError(fmt::format("nothing to compare: none of the {} pixels is finite in both '{}' and '{}'",
                                 result.metrics.nonFinite, options.picture, options.reference));
  }
  if (options.tiles > 0) result.tiles = image::compareTiles(picture, reference, options.tiles, maskOrAll);
  return result;
}

Json tilesJson(const image::TileSummary& summary) {
  Json list = Json::array();
  for (const image::TileDifference& tile : summary.tiles) {
    list.push_back({{"x", tile.x},
                    {"y", tile.y},
                    {"pixels", tile.pixels},
                    {"difference", {number(tile.differenceR), number(tile.differenceG), number(tile.differenceB)}},
                    {"luminance_difference", number(tile.difference)},
                    {"luminance_reference", number(tile.reference)},
                    {"relative", number(tile.relative)}});
  }
  return {{"side", summary.grid.side},
          {"columns", summary.grid.columns()},
          {"rows", summary.grid.rows()},
          {"rms_relative", number(summary.rmsRelative)},
          {"max_relative", number(summary.maxRelative)},
          {"worst", summary.worst},
          {"list", list}};
}

void printJson(const Options& options, const Comparison& c) {
  const image::Metrics& m = c.metrics;
  Json json = {{"picture", options.picture},
               {"reference", options.reference},
               {"pixels", m.pixels},
               {"non_finite", m.nonFinite},
               {"mse", number(m.mse)},
               {"relmse", number(m.relMse)},
               {"relmse_trimmed", number(m.relMseTrimmed)},
               {"relmse_median", number(m.relMseMedian)},
               {"mape", number(m.mape)},
               {"flip", {{"kind", c.hdr ? "hdr" : "ldr"}, {"mean", number(m.flipMean)}, {"p99", number(m.flipP99)}}},
               {"bias", {number(m.biasR), number(m.biasG), number(m.biasB)}},
               {"relative_bias", number(m.relativeBias)}};
  if (!options.mask.empty()) json["mask"] = options.mask;
  if (!c.conflicts.empty()) json["forced_over"] = c.conflicts;
  if (options.tiles > 0) json["tiles"] = tilesJson(c.tiles);
  // Paths need not be UTF-8; a replacement character beats an exception.
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// Of a figure that is relative to a reference which may be black, or negative.
std::string percent(double value, int width, const char* sign) {
  if (!std::isfinite(value)) return fmt::format("{:>{}}", "undefined", width);
  return fmt::format(fmt::runtime(fmt::format("{{:>{}{}.4f}} %", sign, width)), 100 * value);
}

void printTable(const Options& options, const Comparison& c) {
  const image::Metrics& m = c.metrics;
  for (const std::string& conflict : c.conflicts)
    fmt::print(stderr, "warning: compared by --force although {}\n", conflict);
  const auto row = [](const char* name, const std::string& value) { fmt::print("{:<18}{}\n", name, value); };
  const auto figure = [&](const char* name, double value) { row(name, fmt::format("{:>12.6g}", value)); };
  row("pixels", fmt::format("{:>12}", m.pixels));
  row("non-finite", fmt::format("{:>12}", m.nonFinite));
  figure("MSE", m.mse);
  figure("relMSE", m.relMse);
  figure("  without worst ‰", m.relMseTrimmed);
  figure("  median pixel", m.relMseMedian);
  figure("MAPE", m.mape);
  if (!options.noFlip) {
    figure(c.hdr ? "HDR-FLIP mean" : "LDR-FLIP mean", m.flipMean);
    figure("  p99", m.flipP99);
  }
  row("bias R G B", fmt::format("{:>12.4g} {:>12.4g} {:>12.4g}", m.biasR, m.biasG, m.biasB));
  row("relative bias", percent(m.relativeBias, 12, "+"));
  if (options.tiles == 0) return;
  const image::TileSummary& s = c.tiles;
  fmt::print("\n{} tiles of {}²: relative difference RMS {}, largest {}; the worst:\n", s.tiles.size(), s.grid.side,
             percent(s.rmsRelative, 1, ""), percent(s.maxRelative, 1, ""));
  fmt::print("{:>7}{:>7}{:>14}{:>14}{:>12}\n", "x", "y", "reference", "difference", "relative");
  for (const size_t i : s.worst) {
    const image::TileDifference& t = s.tiles[i];
    fmt::print("{:>7}{:>7}{:>14.6g}{:>14.6g}{}\n", t.x, t.y, t.reference, t.difference, percent(t.relative, 10, "+"));
  }
}

}  // namespace

void addCompareCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "how far a picture is from a reference");
  const auto options = std::make_shared<Options>();
  command->footer("Exit status: 0 compared, whatever the figures are; 1 failed while running; 2 bad input.");
  command->add_option("picture", options->picture, "EXR (radiance) or PNG (display values)")->required();
  command->add_option("reference", options->reference, "of the same kind and size")->required();
  command->add_option("--mask", options->mask, "counts pixels where the largest of its R, G, B is above 0.5");
  command->add_option("--tiles", options->tiles, "also compares tiles of this many pixels a side")
      ->check(CLI::Range(1, 65536));
  command->add_flag("--json", options->json, "everything as JSON, with every tile");
  command->add_flag("--force", options->force, "compares pictures of different scenes, cameras or lights too");
  command->add_flag("--no-flip", options->noFlip, "leaves FLIP out, which takes most of the time");
  command->callback([options] {
    const Comparison comparison = compare(*options);
    options->json ? printJson(*options, comparison) : printTable(*options, comparison);
  });
}
