#include <weir/render/statistics.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Quantiles& q) {
  return {{"median", q.median}, {"p95", q.p95}, {"p99", q.p99}};
}

}  // namespace

Quantiles quantiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  auto at = [&](double q) {
    const double place = q * static_cast<double>(values.size() - 1);
    const auto low = static_cast<size_t>(std::floor(place));
    const size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (values[high] - values[low]) * (place - static_cast<double>(low));
  };
  return {at(0.5), at(0.95), at(0.99)};
}

std::string statisticsJson(const graph::CompiledGraph& graph, const std::vector<execute::FrameTimes>& times,
                           const RunFacts& facts) {
  const size_t warmUp = times.size() >= 3 ? std::max<size_t>(1, times.size() / 10) : 0;
  auto collect = [&](auto value) {
    std::vector<double> values;
    for (size_t f = warmUp; f < times.size(); ++f) values.push_back(value(times[f]));
    return values;
  };
  const bool timed = !times.empty() && !times.front().gpu.empty();
  Json j;
  j["device"] = facts.device;
  j["driver"] = facts.driver;
  j["trace"] = facts.trace;
  j["scene"] = facts.scene;
  j["lights"] = facts.lights;
  j["animation"] = facts.animation;
  if (const RunFacts::Environment& e = facts.environment; !e.file.empty()) {
    j["environment"] = {
        {"file", e.file},   {"size", {e.width, e.height}}, {"table", {e.columns, e.rows}}, {"integral", e.integral},
        {"share", e.share}, {"load_seconds", e.seconds}};
  }
  j["size"] = {graph.width, graph.height};
  j["frames"] = times.size();
  j["warmup_frames"] = warmUp;
  j["passes"] = Json::array();
  for (size_t p = 0; p < graph.passes.size(); ++p) {
    Json pass = {{"name", graph.passes[p].name}, {"type", graph.passes[p].type}};
    pass["gpu_ms"] = timed ? toJson(quantiles(collect([&](const auto& t) { return t.gpu[p]; }))) : Json();
    pass["cpu_ms"] = quantiles(collect([&](const auto& t) { return t.cpu[p]; })).median;
    j["passes"].push_back(pass);
  }
  j["frame"]["gpu_ms"] = timed ? toJson(quantiles(collect([](const auto& t) { return t.gpuFrame; }))) : Json();
  // What it takes to bring a moving scene to its state; no time at all when it is still.
  j["frame"]["scene_gpu_ms"] = timed ? toJson(quantiles(collect([](const auto& t) { return t.gpuScene; }))) : Json();
  j["frame"]["cpu_ms"] = quantiles(collect([](const auto& t) { return t.cpuFrame; })).median;
  j["memory"] = {{"transient_bytes", facts.transientBytes},
                 {"history_bytes", facts.historyBytes},
                 {"scene_bytes", facts.sceneBytes},
                 {"aliased_saving_bytes", facts.savedBytes},
                 {"peak_host_bytes", facts.peakHostBytes}};
  j["rays"] = facts.rays;
  j["load_seconds"] = {{"read", facts.importTimes.read},     {"geometry", facts.importTimes.geometry},
                       {"images", facts.importTimes.images}, {"prepare", facts.prepareSeconds},
                       {"upload", facts.uploadSeconds},      {"acceleration", facts.accelerationSeconds},
                       {"compile", facts.compileSeconds},    {"first_frame", facts.firstFrameSeconds}};
  return j.dump(2) + "\n";
}

}  // namespace weir::render
