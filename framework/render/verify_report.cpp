// What `weir verify` leaves behind: numbers and a map.
#include <weir/render/verify.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinities: null says that there is no such figure.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

const char* kindName(ReferenceKind kind) {
  switch (kind) {
    case ReferenceKind::Rendered:
      return "rendered";
    case ReferenceKind::WithError:
      return "file with standard error";
    case ReferenceKind::Exact:
      return "exact";
    case ReferenceKind::Scatter:
      break;
  }
  return "file, error from its scatter";
}

Json comparisonJson(const image::Comparison& c) {
  return {{"mean", number(c.mean)},
          {"reference", number(c.reference)},
          {"relative", number(c.relative)},
          {"error", number(c.standardError)},
          {"freedom", number(c.freedom)},
          {"t", number(c.t)},
          {"p", number(c.p)}};
}

Json scaleJson(const image::Scale& s) {
  Json tiles = Json::array();
  for (size_t i = 0; i < s.grid.count(); ++i) {
    Json tile = {{"x", s.grid.left(i)}, {"y", s.grid.top(i)}, {"colour", std::string(1, s.colours[i])}};
    tile.update(comparisonJson(s.tiles[i]));
    tiles.push_back(std::move(tile));
  }
  Json alarms = Json::array();
  for (const size_t i : s.alarms) {
    if (i < s.grid.count()) alarms.push_back({s.grid.left(i), s.grid.top(i)});
  }
  return {{"side", s.grid.side},
          {"columns", s.grid.columns()},
          {"rows", s.grid.rows()},
          {"comparisons", s.comparisons},
          {"level", s.level},
          {"resolution", number(s.resolution)},
          {"worst", {s.grid.left(s.worst), s.grid.top(s.worst)}},
          {"alarms", alarms},
          {"tiles", tiles}};
}

using Rgb = std::array<float, 3>;

/// Colour of a figure in [-1, 1]: blue below, red above, over a grey that shows what is there.
Rgb blend(double v, float grey) {
  const float weight = float(std::min(1.0, std::abs(v)));
  const Rgb full = v < 0 ? Rgb{0.10f, 0.35f, 1.0f} : Rgb{1.0f, 0.18f, 0.10f};
  Rgb result;
  for (size_t c = 0; c < 3; ++c) result[c] = grey * (1 - weight) + full[c] * weight;
  return result;
}

}  // namespace

std::string verificationJson(const Verification& v, const VerifyOptions& o) {
  const image::Verdict& d = v.verdict;
  Json j = {{"verdict", image::answerName(d.answer)},
            {"reasons", d.reasons},
            {"warnings", v.warnings},
            {"within", number(d.within)},
            {"confidence", 1.0 - o.verdict.alpha},
            {"tolerance", o.verdict.tolerance},
            {"tile_tolerance", o.verdict.tileTolerance},
            {"enough_restarts", d.enough},
            {"whole", comparisonJson(d.whole)},
            {"interval", {number(d.low), number(d.high)}},
            {"interval_level", d.wholeLevel},
            {"graph", o.graph},
            {"set", o.overrides.set},
            {"enable", o.overrides.enable},
            {"disable", o.overrides.disable},
            {"output", o.output},
            {"device", v.device},
            {"scene", v.scene},
            {"lights", v.lights},
            {"camera", v.camera},
            {"animation", v.animation},
            {"size", {o.width, o.height}},
            {"seed", o.seed},
            {"restarts", d.restarts},
            {"frames", o.frames},
            {"lanes", v.lanes},
            {"look", v.look},
            {"looks", v.looks},
            {"seconds_per_restart", v.secondsPerRestart},
            {"reference",
             {{"kind", kindName(v.kind)},
              {"name", v.referenceName},
              {"set", o.referenceOverrides.set},
              {"restarts", d.referenceRestarts},
              {"frames", o.referenceFrames},
              {"lanes", v.referenceLanes},
              {"seconds_per_restart", v.secondsPerReferenceRestart}}},
            {"coarse", scaleJson(d.coarse)},
            {"fine", scaleJson(d.fine)}};
  // Paths need not be UTF-8; a replacement character beats an exception.
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

double fullColour(const image::Verdict& verdict, double tolerance) {
  double full = tolerance;
  for (const size_t i : verdict.fine.alarms) {
    const double relative = std::abs(verdict.fine.tiles[i].relative);
    if (std::isfinite(relative)) full = std::max(full, relative);
  }
  return full;
}

image::Picture verificationMap(const Verification& v, double full) {
  const image::Scale& s = v.verdict.fine;
  const image::TileGrid& g = s.grid;
  constexpr uint32_t kGap = 2;
  image::Picture map{2 * g.width + kGap, g.height, {}, {}};
  map.rgba.assign(size_t{4} * map.width * map.height, 1.0f);
  double brightest = 0;
  for (size_t i = 0; i < v.referenceMean.rgba.size(); i += 4) {
    const double y = image::luminance(&v.referenceMean.rgba[i]);
    if (std::isfinite(y)) brightest += y;
  }
  brightest = std::max(brightest / (double(g.width) * g.height), 1e-30);
  std::vector<bool> alarms(g.count());
  for (const size_t i : s.alarms) alarms[i] = true;
  for (uint32_t y = 0; y < g.height; ++y) {
    for (uint32_t x = 0; x < g.width; ++x) {
      const size_t tile = g.index(x, y);
      const image::Comparison& c = s.tiles[tile];
      const double light = image::luminance(v.referenceMean.at(x, y)) / brightest;
      const float grey = float(0.1 + 0.5 * (light > 0 ? light / (1.0 + light) : 0.0));
      // An infinite difference or t is as much as there can be.
      const double much = std::isnan(c.relative) ? 1.0 : std::clamp(c.relative / full, -1.0, 1.0);
      const double sure = image::criticalT(c.freedom, s.level);
      const double how = std::isnan(c.t) ? 1.0 : std::clamp(c.t / sure, -1.0, 1.0);
      const uint32_t dx = x % g.side, dy = y % g.side;
      const bool rim = alarms[tile] && (dx == 0 || dy == 0 || dx + 1 == g.side || dy + 1 == g.side ||
                                        x + 1 == g.width || y + 1 == g.height);
      const Rgb left = rim ? Rgb{1.0f, 0.9f, 0.0f} : blend(much, grey);
      const Rgb right = rim ? Rgb{1.0f, 0.9f, 0.0f} : blend(how, grey);
      std::copy(left.begin(), left.end(), map.at(x, y));
      std::copy(right.begin(), right.end(), map.at(g.width + kGap + x, y));
    }
  }
  return map;
}

}  // namespace weir::render
