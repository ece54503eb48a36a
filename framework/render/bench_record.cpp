#include <fmt/format.h>
#include <weir/render/bench_record.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN: null says that there is no such figure.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json toJson(const image::Interval& i) {
  return {{"value", number(i.value)}, {"low", number(i.low)}, {"high", number(i.high)}};
}

Json toJson(const std::optional<Quantiles>& q) {
  if (!q) return nullptr;
  return {{"median", q->median}, {"p95", q->p95}, {"p99", q->p99}};
}

Json toJson(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        // As it was written: 0.1, not the double nearest to the float 0.1.
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, float>)
          return number(std::strtod(fmt::format("{}", v).c_str(), nullptr));
        else
          return v;
      },
      value);
}

Json toJson(const std::map<std::string, ParamValue>& values) {
  Json j = Json::object();
  for (const auto& [name, value] : values) j[name] = toJson(value);
  return j;
}

Json toJson(const ErrorMeasure& e) {
  Json j;
  j["repeats"] = e.repeats;
  j["frames"] = e.frames;
  j["every"] = e.every;
  j["reference"] = {{"what", e.reference}, {"exact", e.exact}, {"relmse", number(e.referenceRelMse)}};
  j["relmse"] = {{"median", toJson(e.frameMedian)}, {"mean", toJson(e.frameMean)}, {"trimmed", toJson(e.frameTrimmed)}};
  for (size_t i = 0; i < e.means.size(); ++i) {
    const std::string name = fmt::format("relmse_mean{}", e.means[i].first);
    j[name] = toJson(e.means[i].second);
    j[name + "_trimmed"] = toJson(e.trimmedMeans[i].second);
  }
  if (e.flip) j["flip"] = toJson(*e.flip);
  j["bias"] = toJson(e.bias);
  j["correlation_time"] = toJson(e.correlationTime);
  j["non_finite"] = e.nonFinite;
  return j;
}

Json toJson(const Floor& f) {
  Json j = {{"gpu_ms", number(f.gpuMs)}, {"multiple", number(f.multiple)}, {"parts", Json::array()}};
  for (const FloorPart& part : f.parts) j["parts"].push_back({{"name", part.name}, {"gpu_ms", number(part.gpuMs)}});
  return j;
}

void addCost(Json& j, const CostMeasure& c) {
  j["passes"] = Json::array();
  for (const PassMeasure& p : c.passes)
    j["passes"].push_back({{"name", p.name},
                           {"type", p.type},
                           {"gpu_ms", toJson(p.gpuMs)},
                           {"cpu_ms", p.cpuMs},
                           {"bytes_read", p.bytesRead},
                           {"bytes_written", p.bytesWritten}});
  j["frame"] = {{"gpu_ms", toJson(c.frameGpuMs)}, {"cpu_ms", c.frameCpuMs}, {"wall_ms", c.wallMs}};
  j["memory"] = {{"transient_bytes", c.transientBytes},
                 {"history_bytes", c.historyBytes},
                 {"scene_bytes", c.sceneBytes},
                 {"aliased_saving_bytes", c.savedBytes}};
  j["rays"] = c.rays;
}

}  // namespace

std::string recordJson(const BenchRecord& r) {
  Json j;
  j["id"] = r.id;
  j["graph"] = r.graph;
  j["name"] = r.name;
  j["scene"] = {{"file", r.sceneFile},
                {"digest", r.sceneDigest},
                {"lights", r.lights},
                {"camera", r.camera},
                {"animation", r.animation}};
  j["size"] = {r.width, r.height};
  j["settings"] = toJson(r.settings);
  j["parameters"] = toJson(r.parameters);
  j["command"] = r.command;
  j["frames"] = r.frames;
  j["warmup"] = r.warmup;
  addCost(j, r.cost);
  if (r.floor) j["floor"] = toJson(*r.floor);
  if (r.error) j["error"] = toJson(*r.error);
  if (r.pictures) {
    const PictureNames& p = *r.pictures;
    j["pictures"] = {{"crop", p.crop}, {"frame", p.frame}, {"reference", p.reference}};
    if (!p.flip.empty()) j["pictures"]["flip"] = p.flip;
  }
  // Names of files and devices need not be UTF-8.
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace weir::render
