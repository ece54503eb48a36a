#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/graph/names.h>
#include <weir/render/bench_sweep.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>

namespace weir::render {
namespace {

/// What somebody who asks for more has mistyped; a measured configuration takes seconds.
constexpr size_t kMostConfigurations = 100'000;

ParamValue guessed(const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  const char* end = text.data() + text.size();
  int32_t whole = 0;
  if (const auto r = std::from_chars(text.data(), end, whole); r.ec == std::errc() && r.ptr == end) return whole;
  float real = 0;
  if (const auto r = std::from_chars(text.data(), end, real); r.ec == std::errc() && r.ptr == end) return real;
  return text;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearestName(name, known);
  return fmt::format("{}; it has: {}", nearest.empty() ? "" : " (nearest: '" + nearest + "')", graph::listed(known));
}

/// InputError when a sweep names what a graph doesn't have.
void checkSweep(const Sweep& sweep, const graph::Description& graph, Registry& registry) {
  const graph::PassEntry* pass = graph.find(sweep.pass);
  if (pass == nullptr)
    throw InputError(fmt::format("--sweep {}: graph {} has no pass '{}'{}", sweep.name(), graph.file, sweep.pass,
                                 suggestion(sweep.pass, graph::namesOf(graph.passes))));
  if (sweep.isToggle()) return;
  const PassDescription* type = registry.find(pass->type);
  if (type == nullptr) return;  // the compiler says why
  std::vector<std::string> params = graph::namesOf(type->params);
  if (std::ranges::count(params, sweep.param) > 0) return;
  params.emplace_back("enabled");
  throw InputError(fmt::format("--sweep {}: {} of graph {} has no parameter '{}'{}", sweep.name(), pass->type,
                               graph.file, sweep.param, suggestion(sweep.param, params)));
}

void checkSweeps(const BenchPart& part, const graph::Description& graph, Registry& registry) {
  std::set<std::string> names;
  for (const Sweep& sweep : part.sweeps) {
    if (!names.insert(sweep.name()).second) throw InputError(fmt::format("--sweep {}: given twice", sweep.name()));
    checkSweep(sweep, graph, registry);
    for (const auto* list : {&part.overrides.enable, &part.overrides.disable}) {
      if (sweep.isToggle() && std::ranges::count(*list, sweep.pass) > 0)
        throw InputError(fmt::format("--sweep {} and --{} {}: only one of them", sweep.name(),
                                     list == &part.overrides.enable ? "enable" : "disable", sweep.pass));
    }
    for (const std::string& set : part.overrides.set) {
      if (set.starts_with(sweep.name() + "="))
        throw InputError(fmt::format("--sweep {} and --set {}: only one of them", sweep.name(), set));
    }
  }
}

/// The parameters as they are compiled, and which passes are off.
std::map<std::string, ParamValue> parametersOf(const graph::CompiledGraph& compiled,
                                               const graph::Description& described) {
  std::map<std::string, ParamValue> all;
  for (const graph::CompiledPass& pass : compiled.passes)
    for (const auto& [name, value] : pass.params) all[pass.name + "." + name] = value;
  for (const graph::PassEntry& pass : described.passes)
    if (!pass.enabled) all[pass.name + ".enabled"] = false;
  return all;
}

class Expander {
 public:
  Expander(Laboratory& laboratory, const std::vector<BenchPart>& parts) : laboratory_(laboratory), parts_(parts) {}

  std::vector<Configuration> all() {
    for (size_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].graphs.empty()) throw InputError(where(parts_[p]) + "no graph is named");
      for (const std::string& file : parts_[p].graphs) graph(p, file);
    }
    if (!findings_.empty()) throw graph::GraphError(std::move(findings_));
    return std::move(result_);
  }

 private:
  static std::string where(const BenchPart& part) { return part.name.empty() ? "" : "sweep '" + part.name + "': "; }

  void graph(size_t p, const std::string& file) {
    const BenchPart& part = parts_[p];
    std::vector<graph::Diagnostic> found;
    const graph::Description description = graph::load(file, found);
    if (!found.empty()) return add(std::move(found));
    checkSweeps(part, description, laboratory_.registry());
    size_t count = 1;
    for (const Sweep& sweep : part.sweeps) {
      count *= sweep.values.size();
      if (result_.size() + count > kMostConfigurations)
        throw InputError(fmt::format("{}more than {} combinations of values", where(part), kMostConfigurations));
    }
    // The last sweep's value changes fastest.
    for (size_t i = 0; i < count; ++i) {
      std::vector<size_t> at(part.sweeps.size());
      size_t rest = i;
      for (size_t s = at.size(); s-- > 0; rest /= part.sweeps[s].values.size())
        at[s] = rest % part.sweeps[s].values.size();
      configuration(p, description, at);
    }
  }

  void configuration(size_t p, const graph::Description& description, const std::vector<size_t>& at) {
    const BenchPart& part = parts_[p];
    Configuration c;
    c.part = p;
    c.graph = description.file;
    c.overrides = part.overrides;
    c.label = std::filesystem::path(c.graph).filename().string();
    for (size_t s = 0; s < at.size(); ++s) {
      const Sweep& sweep = part.sweeps[s];
      const std::string& value = sweep.values[at[s]];
      if (sweep.isToggle())
        (value == "true" ? c.overrides.enable : c.overrides.disable).push_back(sweep.pass);
      else
        c.overrides.set.push_back(sweep.name() + "=" + value);
      c.label.append(" ").append(sweep.name()).append("=").append(value);
    }
    if (!part.name.empty()) c.label.insert(0, part.name + ": ");
    graph::Description changed = description;
    std::vector<graph::Diagnostic> found;
    graph::apply(changed, c.overrides, found);
    if (found.empty())
      c.compiled = graph::compile(changed, laboratory_.registry().catalog(), part.width, part.height, found);
    if (!found.empty()) return add(std::move(found));
    if (!part.name.empty()) c.sweeps.push_back(part.name);
    c.parameters = parametersOf(c.compiled, changed);
    settings(c);
    result_.push_back(std::move(c));
  }

  /// What was set for this configuration, with the types that the passes declare.
  static void settings(Configuration& c) {
    const auto add = [&](const std::string& name, const ParamValue& otherwise) {
      const auto known = c.parameters.find(name);
      c.settings[name] = known == c.parameters.end() ? otherwise : known->second;
    };
    for (const std::string& set : c.overrides.set) {
      const size_t equals = set.find('=');
      add(set.substr(0, equals), guessed(set.substr(equals + 1)));
    }
    for (const std::string& pass : c.overrides.enable) c.settings[pass + ".enabled"] = true;
    for (const std::string& pass : c.overrides.disable) c.settings[pass + ".enabled"] = false;
  }

  /// The same slip in a hundred configurations is one slip.
  void add(std::vector<graph::Diagnostic> found) {
    for (graph::Diagnostic& d : found)
      if (said_.insert(d.text()).second) findings_.push_back(std::move(d));
  }

  Laboratory& laboratory_;
  const std::vector<BenchPart>& parts_;
  std::vector<Configuration> result_;
  std::vector<graph::Diagnostic> findings_;
  std::set<std::string> said_;
};

}  // namespace

Sweep parseSweep(const std::string& text) {
  const size_t equals = text.find('='), dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0 || dot + 1 == equals)
    throw InputError(fmt::format("--sweep '{}': expected pass.param=a,b,c or pass.enabled=true,false", text));
  Sweep sweep{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), {}};
  for (size_t start = equals + 1; start <= text.size();) {
    const size_t comma = std::min(text.find(',', start), text.size());
    sweep.values.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  checkValues(sweep);
  return sweep;
}

void checkValues(const Sweep& sweep) {
  std::set<std::string> seen;
  if (sweep.values.empty()) throw InputError(fmt::format("--sweep {}: has no values", sweep.name()));
  for (const std::string& value : sweep.values) {
    if (value.empty()) throw InputError(fmt::format("--sweep {}: a value is empty", sweep.name()));
    if (!seen.insert(value).second)
      throw InputError(fmt::format("--sweep {}: the value {} is there twice", sweep.name(), value));
    if (sweep.isToggle() && value != "true" && value != "false")
      throw InputError(fmt::format("--sweep {}: '{}' is neither true nor false", sweep.name(), value));
  }
}

std::vector<Configuration> expand(Laboratory& laboratory, const std::vector<BenchPart>& parts) {
  return Expander(laboratory, parts).all();
}

}  // namespace weir::render
