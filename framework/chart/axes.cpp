#include <weir/chart/axes.h>

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <set>

namespace weir::chart {
namespace {

const char* errorLabel(const std::string& key) {
  static const std::map<std::string, const char*> labels = {
      {"relmse.median", "relMSE of a frame, median"},
      {"relmse.mean", "relMSE of a frame, mean"},
      {"relmse.trimmed", "relMSE of a frame, without the worst ‰ of its pixels"},
      {"relmse_mean64", "relMSE of the mean of 64 frames"},
      {"relmse_mean64_trimmed", "relMSE of the mean of 64 frames, trimmed"},
      {"relmse_mean256", "relMSE of the mean of 256 frames"},
      {"relmse_mean256_trimmed", "relMSE of the mean of 256 frames, trimmed"},
      {"flip", "FLIP of a frame"},
      {"bias", "|relative bias|"}};
  return labels.at(key);
}

Axis choose(const std::vector<Axis>& axes, const std::string& given, const char* what,
            const std::function<bool(const std::string&)>& measured) {
  std::vector<std::string> names;
  for (const Axis& axis : axes) {
    if (given.empty() ? measured(axis.key) : axis.key == given) return axis;
    names.push_back(axis.key);
  }
  if (given.empty()) return axes.front();
  const std::string nearest = nearestName(given, names);
  throw InputError(fmt::format("no {} is called '{}'{}; there are {}", what, given,
                               nearest.empty() ? "" : " (nearest is '" + nearest + "')", fmt::join(names, ", ")));
}

double aboveZero(double value) {
  return value > 0 ? value : kNone;
}

/// What a scene is: its content where that is known, as it may lie elsewhere on another machine.
const std::string& identity(const Configuration& c) {
  return c.digest.empty() ? c.scene : c.digest;
}

/// The file's name; its whole path when another scene has the same name.
std::string sceneName(const Bench& bench, const Configuration& c) {
  const std::string name = std::filesystem::path(c.scene).filename().string();
  for (const Configuration& other : bench.configurations)
    if (identity(other) != identity(c) && std::filesystem::path(other.scene).filename() == name) return c.scene;
  return name.empty() ? c.scene : name;
}

}  // namespace

std::vector<Axis> timeAxes(const Bench& bench) {
  std::vector<Axis> axes = {{"frame", "GPU time of a frame"},
                            {"no-gbuffer", "GPU time of a frame without the G-buffer"},
                            {"wall", "wall time of a frame"}};
  std::set<std::string> known;
  for (const Configuration& c : bench.configurations)
    for (const PassTimes& pass : c.passes)
      if (known.insert(pass.name).second)
        axes.push_back({"pass." + pass.name, fmt::format("GPU time of the pass '{}'", pass.name)});
  return axes;
}

std::vector<Axis> errorAxes() {
  std::vector<Axis> axes;
  for (const std::string& key : errorMeasures()) axes.push_back({key, errorLabel(key)});
  return axes;
}

Interval timeOf(const Configuration& c, const std::string& key) {
  if (key == "frame") return {c.frame.median, c.frame.median, c.frame.p95};
  if (key == "wall") return {c.wall.median, c.wall.median, c.wall.p95};
  if (key == "no-gbuffer") {
    double ms = c.frame.median;
    for (const PassTimes& pass : c.passes)
      if (pass.type.starts_with("gbuffer.")) ms -= pass.gpu.median;
    return {ms, kNone, kNone};
  }
  for (const PassTimes& pass : c.passes)
    if (key == "pass." + pass.name) return {pass.gpu.median, pass.gpu.median, pass.gpu.p95};
  return {};
}

Interval errorOf(const Configuration& c, const std::string& key) {
  const auto found = c.errors.find(key);
  if (found == c.errors.end()) return {};
  Interval e = found->second;
  if (key != "bias") return e;
  const bool holdsZero = e.low <= 0 && e.high >= 0;
  const double a = std::abs(e.low), b = std::abs(e.high);
  return {std::abs(e.value), holdsZero ? 0 : std::min(a, b), std::max(a, b)};
}

Axis chooseTime(const Bench& bench, const std::string& given) {
  return choose(timeAxes(bench), given, "time", [&](const std::string& key) {
    return std::any_of(bench.configurations.begin(), bench.configurations.end(),
                       [&](const Configuration& c) { return timeOf(c, key).value > 0; });
  });
}

Axis chooseError(const Bench& bench, const std::string& given) {
  return choose(errorAxes(), given, "error", [&](const std::string& key) {
    return std::any_of(bench.configurations.begin(), bench.configurations.end(),
                       [&](const Configuration& c) { return errorOf(c, key).value > 0; });
  });
}

std::vector<Group> groups(const Bench& bench) {
  // What sets two groups apart, from the most telling on; only what differs somewhere is said.
  const auto facts = [&](const Configuration& c) {
    return std::vector<std::string>{identity(c),
                                    c.lights,
                                    c.camera,
                                    c.animation,
                                    fmt::format("{}×{}", c.width, c.height),
                                    bench.files[c.file].device};
  };
  std::vector<std::set<std::string>> values(facts(bench.configurations.front()).size());
  for (const Configuration& c : bench.configurations) {
    const std::vector<std::string> f = facts(c);
    for (size_t i = 0; i < f.size(); ++i) values[i].insert(f[i]);
  }
  std::map<std::vector<std::string>, size_t> known;
  std::set<std::string> labels;
  std::vector<Group> result;
  for (size_t i = 0; i < bench.configurations.size(); ++i) {
    const Configuration& c = bench.configurations[i];
    const std::vector<std::string> f = facts(c);
    const auto [entry, isNew] = known.emplace(f, result.size());
    if (isNew) {
      std::string label = sceneName(bench, c);
      for (size_t k = 1; k < f.size(); ++k)
        if (values[k].size() > 1 && !f[k].empty()) label += ", " + f[k];
      // A file that changed between two runs.
      if (!labels.insert(label).second) label += ", " + f[0];
      result.push_back({label, {}});
    }
    result[entry->second].configurations.push_back(i);
  }
  return result;
}

std::vector<Point> points(const Bench& bench, const Group& group, const std::string& time, const std::string& error) {
  std::vector<Point> result;
  for (const size_t i : group.configurations) {
    Point p{i, timeOf(bench.configurations[i], time), errorOf(bench.configurations[i], error)};
    if (!(p.time.value > 0 && p.error.value > 0)) continue;
    for (Interval* interval : {&p.time, &p.error}) {
      interval->low = aboveZero(interval->low);
      interval->high = aboveZero(interval->high);
    }
    result.push_back(p);
  }
  return result;
}

std::vector<bool> paretoFront(const std::vector<Point>& points) {
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const double ta = points[a].time.value, tb = points[b].time.value;
    return ta < tb || (ta == tb && points[a].error.value < points[b].error.value);
  });
  std::vector<bool> front(points.size(), false);
  const Point* last = nullptr;
  for (const size_t i : order) {
    const Point& p = points[i];
    const bool same = last != nullptr && last->time.value == p.time.value && last->error.value == p.error.value;
    if (last != nullptr && !same && p.error.value >= last->error.value) continue;
    front[i] = true;
    last = &p;
  }
  return front;
}

}  // namespace weir::chart
