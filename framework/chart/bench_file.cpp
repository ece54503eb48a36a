#include <weir/chart/bench_file.h>

#include <fmt/format.h>
#include <weir/chart/configuration.h>
#include <weir/core/error.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <unordered_map>

namespace weir::chart {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t kLargestFile = uintmax_t{128} << 20u;
constexpr int kDeepest = 64;
constexpr size_t kMostConfigurations = 20000;

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::string readText(const std::string& path) {
  std::error_code failed;
  if (!fs::exists(path, failed)) throw InputError("no bench file at '" + path + "'");
  // Reading a pipe or a device may never end.
  if (!fs::is_regular_file(path, failed)) throw InputError("'" + path + "' is no regular file; expected a bench file");
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw InputError("cannot read '" + path + "'");
  std::string text;
  char buffer[65536];
  while (const size_t got = std::fread(buffer, 1, sizeof buffer, file.get())) {
    text.append(buffer, got);
    if (text.size() > kLargestFile)
      throw InputError(fmt::format("{}: more than {} MiB; expected a bench file", path, kLargestFile >> 20u));
  }
  if (std::ferror(file.get())) throw InputError("cannot read '" + path + "'");
  return text;
}

Json parse(const std::string& path, const std::string& text) {
  // Whatever walks over a tree, its destructor first, does so recursively.
  const auto depthChecked = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDeepest) throw InputError(fmt::format("{}: nested deeper than {} levels", path, kDeepest));
    return true;
  };
  try {
    return Json::parse(text, depthChecked);
  } catch (const nlohmann::json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, …"
    std::string reason = error.what();
    if (const size_t bracket = reason.find("] "); bracket != std::string::npos) reason.erase(0, bracket + 2);
    if (reason.size() > 300) reason = reason.substr(0, reason.find(';')).substr(0, 300);
    throw InputError(fmt::format("{}: not valid JSON: {}", path, reason));
  }
}

void checkVersion(const Place& root) {
  root.object();
  const uint64_t version = root.at("weir_bench").count(1u << 20u);
  if (version != 1) root.at("weir_bench").fail(fmt::format("{}; this program reads version 1", version));
}

}  // namespace

Bench readBench(const std::vector<std::string>& paths) {
  Bench bench;
  std::unordered_map<std::string, std::vector<size_t>> byId;
  for (const std::string& path : paths) {
    const Json json = parse(path, readText(path));
    const Place root(path, json);
    checkVersion(root);
    BenchFile file{.path = path, .device = root.at("device").text(), .driver = {}, .trace = {}, .weir = {}};
    for (const auto& [key, to] : {std::pair{"driver", &file.driver}, {"trace", &file.trace}, {"weir", &file.weir}})
      if (const auto text = root.find(key)) *to = text->text();
    std::error_code ignored;
    const std::string folder = fs::canonical(fs::absolute(path).parent_path(), ignored).string();
    const Place list = root.at("configurations");
    list.array(kMostConfigurations);
    for (size_t i = 0; i < json["configurations"].size(); ++i) {
      Configuration c = readConfiguration(list.element(i), folder, bench.warnings);
      c.file = bench.files.size();
      bool known = false;
      std::vector<size_t>& same = byId[c.id];
      for (const size_t other : same) known |= bench.configurations[other].json == c.json;
      if (known) {
        bench.warnings.push_back(
            fmt::format("{}: {}: configuration {} is there already", path, list.element(i).path(), c.id));
        continue;
      }
      if (!same.empty()) {
        bench.warnings.push_back(
            fmt::format("{}: {}: configuration {} was measured more than once; every measurement is shown", path,
                        list.element(i).path(), c.id));
      }
      same.push_back(bench.configurations.size());
      bench.configurations.push_back(std::move(c));
      if (bench.configurations.size() > kMostConfigurations)
        throw InputError(fmt::format("{}: more than {} configurations altogether", path, kMostConfigurations));
    }
    bench.files.push_back(std::move(file));
  }
  if (bench.configurations.empty())
    throw InputError(fmt::format("{}: no configurations", paths.empty() ? "no file" : paths.front()));
  return bench;
}

}  // namespace weir::chart
