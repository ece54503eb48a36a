#include <fmt/format.h>
#include <weir/chart/configuration.h>

#include <filesystem>

namespace weir::chart {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostPasses = 1000, kMostParameters = 10000, kMostParts = 1000, kLongestKey = 1024;
constexpr uint64_t kLargestCount = uint64_t{1} << 53u;  // what a double, and so JavaScript, holds exactly

/// Copies a figure that may be missing or null.
double optionalNumber(const Place& from, const char* key, Json& to) {
  const auto place = from.find(key);
  if (!place) return kNone;
  const double value = place->atLeastZero();
  to[key] = value;
  return value;
}

void optionalText(const Place& from, const char* key, Json& to) {
  if (const auto place = from.find(key)) to[key] = place->text();
}

/// Either {"median", "p95", "p99"} or one figure.
Times times(const Place& from, const char* key, Json& to) {
  Times result;
  const auto place = from.find(key);
  if (!place) return result;
  Json copy = Json::object();
  if (place->json().is_object()) {
    result.median = optionalNumber(*place, "median", copy);
    result.p95 = optionalNumber(*place, "p95", copy);
    optionalNumber(*place, "p99", copy);
  } else {
    result.median = place->atLeastZero();
    copy["median"] = result.median;
  }
  to[key] = std::move(copy);
  return result;
}

Json namedValues(const Place& from) {
  from.object();
  if (from.json().size() > kMostParameters)
    from.fail(fmt::format("{} members; expected at most {}", from.json().size(), kMostParameters));
  Json copy = Json::object();
  for (const auto& [key, value] : from.json().items()) {
    if (key.size() > kLongestKey)
      from.fail(fmt::format("a name of {} bytes; expected at most {}", key.size(), kLongestKey));
    if (value.is_null()) continue;
    from.at(key).scalar();
    copy[key] = value;
  }
  return copy;
}

Interval interval(const Place& from, bool mayBeNegative, Json& to) {
  Interval result;
  from.object();
  const auto figure = [&](const char* key) {
    const auto place = from.find(key);
    if (!place) return kNone;
    return mayBeNegative ? place->number() : place->atLeastZero();
  };
  result.value = figure("value");
  if (result.value != result.value) return result;
  to["value"] = result.value;
  // An interval about a mean may reach below zero where the figure itself can't.
  if (const auto low = from.find("low")) to["low"] = result.low = low->number();
  if (const auto high = from.find("high")) to["high"] = result.high = high->number();
  // Not whether the value is between them: that of a median and the interval of a mean need not agree.
  if (result.low > result.high)
    from.fail(fmt::format("the interval ends at {}, below its start {}", result.high, result.low));
  return result;
}

void readErrors(const Place& from, Configuration& c, Json& json) {
  Json copy = Json::object();
  if (const auto repeats = from.find("repeats")) copy["repeats"] = repeats->count(kLargestCount);
  if (const auto frames = from.find("frames")) copy["frames"] = frames->count(kLargestCount);
  if (const auto reference = from.find("reference")) {
    Json r = Json::object();
    optionalText(*reference, "what", r);
    if (const auto exact = reference->find("exact")) r["exact"] = exact->boolean();
    copy["reference"] = std::move(r);
  }
  Json measures = Json::object();
  for (const std::string& name : errorMeasures()) {
    const size_t dot = name.find('.');
    auto place = from.find(name.substr(0, dot));
    if (place && dot != std::string::npos) place = place->find(name.substr(dot + 1));
    if (!place) continue;
    Json figure = Json::object();
    const Interval value = interval(*place, name == "bias", figure);
    if (figure.empty()) continue;
    c.errors[name] = value;
    measures[name] = std::move(figure);
  }
  if (const auto tau = from.find("correlation_time")) {
    Json figure = Json::object();
    interval(*tau, true, figure);
    if (!figure.empty()) copy["correlation_time"] = std::move(figure);
  }
  copy["measures"] = std::move(measures);
  json["error"] = std::move(copy);
}

void readPasses(const Place& from, Configuration& c, Json& json) {
  from.array(kMostPasses);
  Json list = Json::array();
  for (size_t i = 0; i < from.json().size(); ++i) {
    const Place place = from.element(i);
    Json copy = Json::object();
    PassTimes pass;
    copy["name"] = pass.name = place.at("name").text();
    copy["type"] = pass.type = place.at("type").text();
    pass.gpu = times(place, "gpu_ms", copy);
    times(place, "cpu_ms", copy);
    for (const char* key : {"bytes_read", "bytes_written", "rays"}) optionalNumber(place, key, copy);
    c.passes.push_back(std::move(pass));
    list.push_back(std::move(copy));
  }
  json["passes"] = std::move(list);
}

/// Of what a picture is called. Whoever made the file must not reach what lies outside of its folder.
std::string picturePath(const Place& pictures, const char* key, const std::string& folder,
                        std::vector<std::string>& warnings) {
  const auto place = pictures.find(key);
  if (!place) return "";
  const std::string name = place->text();
  if (name.empty() || name.find('\0') != std::string::npos) place->fail("no name of a file");
  if (fs::path(name).is_absolute())
    place->fail(fmt::format("'{}' is absolute; expected a path below {}", name, folder));
  std::error_code failed;
  const fs::path real = fs::weakly_canonical(fs::path(folder) / name, failed);
  if (failed) {
    warnings.push_back(fmt::format("{}: no picture {}: {}", place->path(), name, failed.message()));
    return "";
  }
  const fs::path below = real.lexically_relative(folder);
  if (below.empty() || *below.begin() == "..")
    place->fail(fmt::format("'{}' leads out of the file's folder {}", name, folder));
  if (!fs::is_regular_file(real, failed)) {
    warnings.push_back(fmt::format("{}: no picture {} in {}", place->path(), name, folder));
    return "";
  }
  return real.string();
}

void readPictures(const Place& from, const std::string& folder, Configuration& c, Json& json,
                  std::vector<std::string>& warnings) {
  if (const auto crop = from.find("crop")) {
    crop->array(4);
    if (crop->json().size() != 4) crop->fail("expected 4 numbers: x, y, width, height");
    Json copy = Json::array();
    for (size_t i = 0; i < 4; ++i) copy.push_back(crop->element(i).count(1u << 20u));
    json["crop"] = std::move(copy);
  }
  c.pictures.frame = picturePath(from, "frame", folder, warnings);
  c.pictures.reference = picturePath(from, "reference", folder, warnings);
  c.pictures.flip = picturePath(from, "flip", folder, warnings);
}

void readFloor(const Place& from, Json& json) {
  Json copy = Json::object();
  optionalNumber(from, "gpu_ms", copy);
  optionalNumber(from, "multiple", copy);
  if (const auto parts = from.find("parts")) {
    parts->array(kMostParts);
    Json list = Json::array();
    for (size_t i = 0; i < parts->json().size(); ++i) {
      const Place part = parts->element(i);
      Json one = Json::object();
      one["name"] = part.at("name").text();
      optionalNumber(part, "gpu_ms", one);
      list.push_back(std::move(one));
    }
    copy["parts"] = std::move(list);
  }
  json["floor"] = std::move(copy);
}

void readScene(const Place& from, Configuration& c, Json& json) {
  Json scene = Json::object();
  const Place place = from.at("scene");
  scene["file"] = c.scene = place.at("file").text();
  for (const auto& [key, to] :
       {std::pair{"digest", &c.digest}, {"lights", &c.lights}, {"camera", &c.camera}, {"animation", &c.animation}}) {
    if (const auto member = place.find(key)) scene[key] = *to = member->text();
  }
  json["scene"] = std::move(scene);
  const Place size = from.at("size");
  size.array(2);
  if (size.json().size() != 2) size.fail("expected 2 numbers: width and height in pixels");
  c.width = static_cast<uint32_t>(size.element(0).count(1u << 20u));
  c.height = static_cast<uint32_t>(size.element(1).count(1u << 20u));
  json["size"] = {c.width, c.height};
}

}  // namespace

const std::vector<std::string>& errorMeasures() {
  static const std::vector<std::string> names = {"relmse.median",
                                                 "relmse.mean",
                                                 "relmse.trimmed",
                                                 "relmse_mean64",
                                                 "relmse_mean64_trimmed",
                                                 "relmse_mean256",
                                                 "relmse_mean256_trimmed",
                                                 "flip",
                                                 "bias"};
  return names;
}

Configuration readConfiguration(const Place& place, const std::string& folder, std::vector<std::string>& warnings) {
  Configuration c;
  Json json = Json::object();
  json["id"] = c.id = place.at("id").text();
  if (c.id.empty()) place.at("id").fail("is empty");
  json["graph"] = c.graph = place.at("graph").text();
  if (const auto name = place.find("name")) c.name = name->text();
  json["name"] = c.name;
  readScene(place, c, json);
  for (const char* key : {"settings", "parameters"}) {
    const auto values = place.find(key);
    json[key] = values ? namedValues(*values) : Json::object();
  }
  optionalText(place, "command", json);
  for (const char* key : {"frames", "warmup"})
    if (const auto number = place.find(key)) json[key] = number->count(kLargestCount);
  readPasses(place.at("passes"), c, json);
  const Place frame = place.at("frame");
  Json copy = Json::object();
  c.frame = times(frame, "gpu_ms", copy);
  times(frame, "cpu_ms", copy);
  c.wall = times(frame, "wall_ms", copy);
  json["frame"] = std::move(copy);
  if (const auto memory = place.find("memory")) {
    Json bytes = Json::object();
    for (const char* key : {"transient_bytes", "history_bytes", "scene_bytes", "aliased_saving_bytes"})
      optionalNumber(*memory, key, bytes);
    json["memory"] = std::move(bytes);
  }
  optionalNumber(place, "rays", json);
  if (const auto floor = place.find("floor")) readFloor(*floor, json);
  if (const auto error = place.find("error")) readErrors(*error, c, json);
  if (const auto pictures = place.find("pictures")) readPictures(*pictures, folder, c, json, warnings);
  c.json = json.dump();
  return c;
}

}  // namespace weir::chart
