#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/graph/json_tree.h>
#include <weir/render/bench_plan.h>
#include <weir/render/bench_sweep.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace weir::render {
namespace {

namespace fs = std::filesystem;
using graph::JsonMember;
using graph::JsonValue;

constexpr size_t kMostElements = 100'000;

class Reader {
 public:
  Reader(std::string file, std::string scenes) : file_(std::move(file)), scenes_(std::move(scenes)) {}

  BenchPlan plan(const JsonValue& root) {
    BenchPlan plan;
    BenchPart common;
    std::optional<int64_t> version;
    if (!object(root, "", "a plan")) finish();
    const JsonMember* sweeps = nullptr;
    const JsonMember* tables = nullptr;
    keys(root, "",
         {"$schema", "version", "description", "size", "frames", "warmup", "firstFrame", "seed", "repeats",
          "errorFrames", "errorEvery", "output", "flip", "crop", "reference", "sweeps", "tables"},
         [&](const JsonMember& m, const std::string& at) {
           BenchSettings& s = plan.settings;
           if (m.key == "version") version = whole(m.value, at, 1, 1);
           if (m.key == "$schema" || m.key == "description") text(m.value, at);
           if (m.key == "size") size(m.value, at, common);
           if (m.key == "frames") number(s.frames, m.value, at, 1);
           if (m.key == "warmup") number(s.warmup, m.value, at, 0);
           if (m.key == "firstFrame") number(s.firstFrame, m.value, at, 0);
           if (m.key == "seed") number(s.seed, m.value, at, 0);
           if (m.key == "repeats") number(s.repeats, m.value, at, 1);
           if (m.key == "errorFrames") number(s.errorFrames, m.value, at, 1);
           if (m.key == "errorEvery") number(s.errorEvery, m.value, at, 1);
           if (m.key == "output") assign(s.output, text(m.value, at));
           if (m.key == "flip") assign(s.flip, boolean(m.value, at));
           if (m.key == "crop") crop(m.value, at, s);
           if (m.key == "reference") reference(m.value, at, common.reference);
           if (m.key == "sweeps") sweeps = &m;
           if (m.key == "tables") tables = &m;
         });
    if (!has(root, "version")) add(root.line, "version", "is missing; expected \"version\": 1");
    if (sweeps == nullptr)
      add(root.line, "sweeps", "is missing; expected an array of sweeps");
    else
      each(sweeps->value, "sweeps",
           [&](const JsonValue& v, const std::string& at) { plan.parts.push_back(sweep(v, at, common)); });
    std::set<std::string> names;
    for (const BenchPart& part : plan.parts)
      if (!names.insert(part.name).second)
        add(sweeps->line, "sweeps", fmt::format("two sweeps have the name '{}'", part.name));
    if (tables != nullptr)
      each(tables->value, "tables",
           [&](const JsonValue& v, const std::string& at) { plan.tables.push_back(table(v, at, plan.parts)); });
    finish();
    return plan;
  }

  void finish() {
    if (!findings_.empty()) throw graph::GraphError(std::move(findings_));
  }
  std::vector<graph::Diagnostic>& findings() { return findings_; }

 private:
  void add(int line, const std::string& at, std::string message, std::string nearest = "") {
    findings_.push_back({file_, line, at, std::move(message), std::move(nearest)});
  }
  static bool has(const JsonValue& v, const std::string& key) {
    return std::ranges::any_of(v.members, [&](const JsonMember& m) { return m.key == key; });
  }
  static std::string under(const std::string& at, const std::string& key) { return at.empty() ? key : at + "." + key; }

  bool object(const JsonValue& v, const std::string& at, const char* what) {
    if (v.isObject()) return true;
    add(v.line, at, fmt::format("{} must be a JSON object, not {}", what, v.kindName()));
    return false;
  }
  template <typename Work>
  void keys(const JsonValue& v, const std::string& at, const std::vector<std::string>& known, const Work& work) {
    for (const JsonMember& m : v.members) {
      if (std::ranges::count(known, m.key) > 0)
        work(m, under(at, m.key));
      else
        add(m.line, under(at, m.key), fmt::format("unknown key; expected one of {}", fmt::join(known, ", ")),
            nearestName(m.key, known));
    }
  }
  template <typename Work>
  void each(const JsonValue& v, const std::string& at, const Work& work) {
    if (v.kind != JsonValue::Kind::Array)
      return add(v.line, at, fmt::format("expected an array, not {}", v.kindName()));
    for (size_t i = 0; i < v.elements.size(); ++i) work(v.elements[i], fmt::format("{}[{}]", at, i));
  }
  template <typename T>
  std::optional<T> scalar(const JsonValue& v, const std::string& at, const char* what) {
    const T* value = v.kind == JsonValue::Kind::Scalar ? std::get_if<T>(&v.scalar) : nullptr;
    if (value != nullptr) return *value;
    add(v.line, at, fmt::format("expected {}, not {}", what, v.kindName()));
    return std::nullopt;
  }
  std::optional<std::string> text(const JsonValue& v, const std::string& at) {
    return scalar<std::string>(v, at, "a text");
  }
  std::optional<bool> boolean(const JsonValue& v, const std::string& at) { return scalar<bool>(v, at, "a bool"); }
  std::optional<int64_t> whole(const JsonValue& v, const std::string& at, int64_t low, int64_t high) {
    const std::optional<int64_t> value = scalar<int64_t>(v, at, "an integer");
    if (!value || (*value >= low && *value <= high)) return value;
    add(v.line, at, fmt::format("is {}; expected {} … {}", *value, low, high));
    return std::nullopt;
  }
  std::optional<double> real(const JsonValue& v, const std::string& at) {
    if (v.kind == JsonValue::Kind::Scalar) {
      if (const auto* i = std::get_if<int64_t>(&v.scalar)) return static_cast<double>(*i);
    }
    return scalar<double>(v, at, "a number");
  }
  void number(uint32_t& to, const JsonValue& v, const std::string& at, uint32_t low) {
    if (const auto value = whole(v, at, low, UINT32_MAX)) to = static_cast<uint32_t>(*value);
  }
  template <typename T>
  static void assign(T& to, std::optional<T> value) {
    if (value) to = std::move(*value);
  }
  void real(float& to, const JsonValue& v, const std::string& at) {
    if (const auto value = real(v, at)) to = static_cast<float>(*value);
  }
  std::vector<std::string> texts(const JsonValue& v, const std::string& at) {
    std::vector<std::string> list;
    each(v, at, [&](const JsonValue& e, const std::string& place) {
      if (auto value = text(e, place)) list.push_back(std::move(*value));
    });
    return list;
  }

  void size(const JsonValue& v, const std::string& at, BenchPart& part) {
    const std::optional<std::string> value = text(v, at);
    if (value && !parseSizeText(*value, part.width, part.height))
      add(v.line, at, fmt::format("'{}' is no size; expected WIDTHxHEIGHT, such as 1920x1080", *value));
  }
  void crop(const JsonValue& v, const std::string& at, BenchSettings& settings) {
    std::vector<uint32_t> values;
    each(v, at, [&](const JsonValue& e, const std::string& place) { number(values.emplace_back(0), e, place, 0); });
    if (values.size() != 4) return add(v.line, at, "expected [x, y, width, height] in pixels");
    settings.crop = Crop{values[0], values[1], values[2], values[3]};
  }

  std::string beside(const std::string& path, const std::string& folder) const {
    if (path.empty() || fs::path(path).is_absolute()) return path;
    return ((folder.empty() ? fs::path(file_).parent_path() : fs::path(folder)) / path).lexically_normal().string();
  }
  std::string scalarText(const JsonValue& v, const std::string& at) {
    if (v.kind == JsonValue::Kind::Scalar && !std::holds_alternative<std::nullptr_t>(v.scalar))
      return graph::toText(v.scalar);
    add(v.line, at, fmt::format("expected a value of a parameter, not {}", v.kindName()));
    return "";
  }
  void set(const JsonValue& v, const std::string& at, graph::Overrides& overrides) {
    if (!object(v, at, "\"set\"")) return;
    for (const JsonMember& m : v.members) overrides.set.push_back(m.key + "=" + scalarText(m.value, under(at, m.key)));
  }

  void reference(const JsonValue& v, const std::string& at, BenchReference& r) {
    r = {};
    if (!object(v, at, "a reference")) return;
    keys(v, at, {"file", "exact", "graph", "set", "frames", "restarts"},
         [&](const JsonMember& m, const std::string& place) {
           if (m.key == "file") r.file = beside(text(m.value, place).value_or(""), scenes_);
           if (m.key == "exact") assign(r.exact, boolean(m.value, place));
           if (m.key == "graph") r.graph = beside(text(m.value, place).value_or(""), "");
           if (m.key == "set") set(m.value, place, r.overrides);
           if (m.key == "frames") number(r.frames, m.value, place, 1);
           if (m.key == "restarts") number(r.restarts, m.value, place, 1);
         });
    if (r.file.empty() == r.graph.empty()) add(v.line, at, "expected either \"file\" or \"graph\"");
  }

  BenchPart sweep(const JsonValue& v, const std::string& at, const BenchPart& common) {
    BenchPart part = common;
    if (!object(v, at, "a sweep")) return part;
    StageOptions& stage = part.stage;
    keys(v, at,
         {"name", "graphs", "scene", "lights", "lightSeed", "replaceLights", "environment", "environmentScale",
          "environmentRotation", "camera", "energyCompensation", "size", "set", "enable", "disable", "sweep",
          "reference"},
         [&](const JsonMember& m, const std::string& place) {
           if (m.key == "name") assign(part.name, text(m.value, place));
           if (m.key == "graphs")
             for (const std::string& file : texts(m.value, place)) part.graphs.push_back(beside(file, ""));
           if (m.key == "scene") stage.scene = beside(text(m.value, place).value_or(""), scenes_);
           if (m.key == "lights") number(stage.lights, m.value, place, 1);
           if (m.key == "lightSeed") number(stage.lightSeed, m.value, place, 0);
           if (m.key == "replaceLights") assign(stage.replaceLights, boolean(m.value, place));
           if (m.key == "environment") stage.environment = beside(text(m.value, place).value_or(""), scenes_);
           if (m.key == "environmentScale") real(stage.environmentScale, m.value, place);
           if (m.key == "environmentRotation") real(stage.environmentRotation, m.value, place);
           if (m.key == "camera") assign(stage.camera, text(m.value, place));
           if (m.key == "energyCompensation") assign(stage.energyCompensation, boolean(m.value, place));
           if (m.key == "size") size(m.value, place, part);
           if (m.key == "set") set(m.value, place, part.overrides);
           if (m.key == "enable") part.overrides.enable = texts(m.value, place);
           if (m.key == "disable") part.overrides.disable = texts(m.value, place);
           if (m.key == "sweep") values(m.value, place, part);
           if (m.key == "reference") reference(m.value, place, part.reference);
         });
    for (const auto& [key, empty] : {std::pair("name", part.name.empty()), std::pair("graphs", part.graphs.empty()),
                                     std::pair("scene", stage.scene.empty())})
      if (empty) add(v.line, under(at, key), "is missing or empty");
    return part;
  }

  void values(const JsonValue& v, const std::string& at, BenchPart& part) {
    if (!object(v, at, "\"sweep\"")) return;
    for (const JsonMember& m : v.members) {
      const std::string place = under(at, m.key);
      const size_t dot = m.key.find('.');
      if (dot == std::string::npos || dot == 0 || dot + 1 == m.key.size()) {
        add(m.line, place, "expected \"pass.param\": [values] or \"pass.enabled\": [true, false]");
        continue;
      }
      Sweep sweep{m.key.substr(0, dot), m.key.substr(dot + 1), {}};
      each(m.value, place, [&](const JsonValue& e, const std::string& p) { sweep.values.push_back(scalarText(e, p)); });
      try {
        checkValues(sweep);
      } catch (const InputError& error) {
        add(m.line, place, error.what());
      }
      part.sweeps.push_back(std::move(sweep));
    }
  }

  BenchTable table(const JsonValue& v, const std::string& at, const std::vector<BenchPart>& parts) {
    BenchTable t;
    if (!object(v, at, "a table")) return t;
    keys(v, at, {"name", "title", "sweep", "knobs", "published", "source"},
         [&](const JsonMember& m, const std::string& place) {
           if (m.key == "name") assign(t.name, text(m.value, place));
           if (m.key == "title") assign(t.title, text(m.value, place));
           if (m.key == "sweep") assign(t.sweep, text(m.value, place));
           if (m.key == "knobs") t.knobs = texts(m.value, place);
           if (m.key == "source") assign(t.source, text(m.value, place));
           if (m.key == "published" && object(m.value, place, "\"published\""))
             for (const JsonMember& figure : m.value.members)
               if (const auto ms = real(figure.value, under(place, figure.key))) t.published[figure.key] = *ms;
         });
    if (t.knobs.empty()) add(v.line, under(at, "knobs"), "is missing or empty");
    std::vector<std::string> names;
    for (const BenchPart& part : parts) names.push_back(part.name);
    if (std::ranges::count(names, t.sweep) == 0)
      add(v.line, under(at, "sweep"), fmt::format("the plan has no sweep '{}'", t.sweep), nearestName(t.sweep, names));
    return t;
  }

  std::string file_, scenes_;
  std::vector<graph::Diagnostic> findings_;
};

}  // namespace

bool parseSizeText(const std::string& text, uint32_t& width, uint32_t& height) {
  const char* end = text.data() + text.size();
  const auto w = std::from_chars(text.data(), end, width);
  if (w.ec != std::errc() || w.ptr == end || *w.ptr != 'x') return false;
  const auto h = std::from_chars(w.ptr + 1, end, height);
  return h.ec == std::errc() && h.ptr == end;
}

BenchPlan loadBenchPlan(const std::string& path, const std::string& scenes) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path + ": is a folder; expected a plan's JSON file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": can't be read; expected a plan's JSON file");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  Reader reader(path, scenes);
  JsonValue root;
  if (!graph::readJson(text, path, root, reader.findings(), kMostElements)) reader.finish();
  return reader.plan(root);
}

void checkSettings(const BenchSettings& s) {
  const auto within = [](const char* option, uint32_t value, uint32_t low, uint32_t high) {
    if (value < low || value > high) throw InputError(fmt::format("{} {}: must be {} … {}", option, value, low, high));
  };
  constexpr uint32_t kMostFrames = 1'000'000;
  within("--frames", s.frames, 1, kMostFrames);
  within("--warmup", s.warmup, 0, kMostFrames);
  within("--repeats", s.repeats, 1, 64);
  within("--error-frames", s.errorFrames, 1, kMostFrames);
  within("--error-every", s.errorEvery, 1, s.errorFrames);
  const uint32_t most = std::max(s.frames, s.errorFrames) + s.warmup;
  requireFrameNumbers(s.firstFrame, "--warmup and --frames or --error-frames", most);
}

}  // namespace weir::render
