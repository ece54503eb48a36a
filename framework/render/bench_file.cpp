#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/bench_file.h>
#include <weir/render/write_file.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace weir::render {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr int kVersion = 1;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw InputError(fmt::format("'{}' is no bench file: {}", path, why));
}

/// Writing and comparing JSON goes down by recursion: what is nested without end would end the stack.
void requireShallow(const std::string& path, const std::string& text) {
  constexpr int kDeepest = 32;
  int depth = 0;
  bool inText = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inText) {
      if (c == '\\') ++i;
      if (c == '"') inText = false;
    } else if (c == '"') {
      inText = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kDeepest) refuse(path, fmt::format("nested deeper than {} levels", kDeepest));
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

std::string text(const std::string& path, const Json& j, const char* key) {
  const auto found = j.find(key);
  if (found == j.end() || !found->is_string()) refuse(path, fmt::format("\"{}\" must be a text", key));
  return found->get<std::string>();
}

uint32_t whole(const std::string& path, const Json& j, const char* key) {
  const auto found = j.find(key);
  if (found == j.end() || !found->is_number_unsigned() || found->get<uint64_t>() > UINT32_MAX)
    refuse(path, fmt::format("\"{}\" must be a whole number", key));
  return found->get<uint32_t>();
}

std::string identity(const std::string& path, const Json& j) {
  if (!j.is_object()) refuse(path, "a configuration must be an object");
  std::string id = text(path, j, "id");
  const bool valid = id.size() == 16 &&
                     std::ranges::all_of(id, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
  if (!valid) refuse(path, fmt::format("id '{}' must be 16 hexadecimal digits", id.substr(0, 60)));
  return id;
}

const Json& list(const std::string& path, const Json& j, const char* key) {
  const auto found = j.find(key);
  if (found == j.end() || !found->is_array()) refuse(path, fmt::format("\"{}\" must be an array", key));
  return *found;
}

void readPlan(const std::string& path, const Json& root, BenchFile& file) {
  const auto plan = root.find("plan");
  if (plan == root.end() || !plan->is_object()) refuse(path, "\"plan\" must be an object");
  file.shard = whole(path, *plan, "shard");
  file.shards = whole(path, *plan, "shards");
  for (const Json& j : list(path, *plan, "configurations")) {
    PlannedConfiguration planned{identity(path, j), text(path, j, "label"), {}};
    for (const Json& sweep : list(path, j, "sweeps")) {
      if (!sweep.is_string()) refuse(path, "\"sweeps\" must hold texts");
      planned.sweeps.push_back(sweep.get<std::string>());
    }
    file.planned.push_back(std::move(planned));
  }
}

std::string dumped(const Json& j, int indent) {
  return j.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// Names of pictures are relative to the file's folder: the same files, seen from another folder.
std::string moved(const std::string& json, const fs::path& from, const fs::path& to) {
  Json j = Json::parse(json);
  const auto pictures = j.find("pictures");
  if (pictures == j.end() || !pictures->is_object()) return json;
  std::error_code failed;
  for (const char* key : {"frame", "reference", "flip"}) {
    const auto name = pictures->find(key);
    if (name == pictures->end() || !name->is_string()) continue;
    const fs::path there = fs::relative(fs::absolute(from / name->get<std::string>()), fs::absolute(to), failed);
    if (!failed) *name = there.generic_string();
  }
  return dumped(j, -1);
}

fs::path folderOf(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

}  // namespace

bool BenchFile::has(const std::string& id) const {
  return std::ranges::any_of(configurations, [&](const MeasuredConfiguration& c) { return c.id == id; });
}

std::string BenchFile::conflict(const BenchFile& other) const {
  const auto differ = [](const char* what, const std::string& a, const std::string& b) {
    return a == b ? std::string() : fmt::format("{}: '{}' and '{}'", what, a, b);
  };
  for (const std::string& text : {differ("device", device, other.device), differ("driver", driver, other.driver),
                                  differ("trace", trace, other.trace), differ("weir", weir, other.weir)})
    if (!text.empty()) return text;
  return "";
}

BenchFile readBenchFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("can't read '{}'", path));
  const std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  requireShallow(path, content);
  const Json root = Json::parse(content, nullptr, false);
  if (root.is_discarded()) refuse(path, "not valid JSON");
  if (!root.is_object() || !root.contains("weir_bench")) refuse(path, "\"weir_bench\" is missing");
  if (root["weir_bench"] != kVersion)
    refuse(path,
           fmt::format("its version is {}, this program's {}", dumped(root["weir_bench"], -1).substr(0, 60), kVersion));
  BenchFile file;
  file.device = text(path, root, "device");
  file.driver = text(path, root, "driver");
  file.trace = text(path, root, "trace");
  file.weir = text(path, root, "weir");
  readPlan(path, root, file);
  std::set<std::string> ids;
  for (const Json& j : list(path, root, "configurations")) {
    const std::string id = identity(path, j);
    if (!ids.insert(id).second) refuse(path, fmt::format("id {} is there twice", id));
    file.configurations.push_back({id, dumped(j, -1)});
  }
  return file;
}

std::string benchFileText(const BenchFile& file) {
  Json root;
  root["weir_bench"] = kVersion;
  root["device"] = file.device;
  root["driver"] = file.driver;
  root["trace"] = file.trace;
  root["weir"] = file.weir;
  Json plan = {{"shard", file.shard}, {"shards", file.shards}, {"configurations", Json::array()}};
  std::map<std::string, size_t> place;
  for (const PlannedConfiguration& p : file.planned) {
    place.emplace(p.id, place.size());
    plan["configurations"].push_back({{"id", p.id}, {"label", p.label}, {"sweeps", p.sweeps}});
  }
  root["plan"] = std::move(plan);
  std::vector<const MeasuredConfiguration*> sorted;
  for (const MeasuredConfiguration& c : file.configurations) sorted.push_back(&c);
  const auto rank = [&](const MeasuredConfiguration* c) {
    const auto found = place.find(c->id);
    return found == place.end() ? place.size() : found->second;
  };
  std::ranges::stable_sort(sorted, {}, rank);
  root["configurations"] = Json::array();
  for (const MeasuredConfiguration* c : sorted) root["configurations"].push_back(Json::parse(c->json));
  return dumped(root, 1) + "\n";
}

std::string besideBenchFile(const std::string& path, const std::string& ending) {
  return fs::path(path).replace_extension(ending).string();
}

void writeBenchFile(const std::string& path, const BenchFile& file) {
  writeTextFile(path, benchFileText(file));
  writeTextFile(besideBenchFile(path, ".csv"), benchCsv(file));
}

Merged mergeBenchFiles(const std::vector<std::string>& paths, const std::string& out) {
  Merged merged;
  for (size_t i = 0; i < paths.size(); ++i) {
    const std::string& path = paths[i];
    BenchFile one = readBenchFile(path);
    if (i == 0) {
      merged.file = one;
      merged.file.configurations.clear();
      merged.file.shard = 0;
      merged.file.shards = 1;
    }
    const std::string conflict = merged.file.conflict(one);
    if (!conflict.empty())
      throw InputError(fmt::format("'{}' and '{}' don't belong together: {}", paths.front(), path, conflict));
    if (merged.file.planned != one.planned)
      throw InputError(
          fmt::format("'{}' and '{}' don't belong together: they are of different plans, of {} and {} configurations",
                      paths.front(), path, merged.file.planned.size(), one.planned.size()));
    for (const MeasuredConfiguration& c : one.configurations)
      if (!merged.file.has(c.id))
        merged.file.configurations.push_back({c.id, moved(c.json, folderOf(path), folderOf(out))});
  }
  for (const PlannedConfiguration& p : merged.file.planned)
    if (!merged.file.has(p.id)) merged.missing.push_back(fmt::format("{} ({})", p.label, p.id));
  return merged;
}

}  // namespace weir::render
