// What the command line changes in a graph: --set, --enable, --disable.
#include <weir/graph/description.h>
#include <weir/graph/names.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace weir::graph {
namespace {

template <typename T>
std::optional<T> number(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A number too near to zero for a double, which a file may have too; from_chars has no value for it.
bool isTiny(const std::string& text) {
  double unused = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), unused);
  return error == std::errc::result_out_of_range && end == text.data() + text.size() &&
         std::abs(std::strtod(text.c_str(), nullptr)) < 1;
}

RawValue parseValue(const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  if (const auto whole = number<int64_t>(text)) return *whole;
  if (const auto real = number<double>(text); real && std::isfinite(*real)) return *real;
  if (isTiny(text)) return 0.0;
  return text;
}

class Applier {
 public:
  Applier(Description& description, std::vector<Diagnostic>& diagnostics)
      : d_(description), diagnostics_(diagnostics) {}

  void set(const std::string& text) {
    const size_t equals = text.find('='), dot = text.find('.');
    if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0 || dot + 1 == equals)
      return add("--set", text, "expected pass.param=value", "");
    ParamEntry param;
    param.name = text.substr(dot + 1, equals - dot - 1);
    param.text = text.substr(equals + 1);
    param.value = parseValue(param.text);
    param.origin = "--set";
    PassEntry* pass = find(text.substr(0, dot), "--set");
    if (!pass) return;
    const auto same = std::find_if(pass->params.begin(), pass->params.end(),
                                   [&](const ParamEntry& p) { return p.name == param.name; });
    if (same != pass->params.end())
      *same = std::move(param);
    else
      pass->params.push_back(std::move(param));
  }

  void enable(const std::string& name, bool enabled) {
    const char* flag = enabled ? "--enable" : "--disable";
    PassEntry* pass = find(name, flag);
    if (!pass) return;
    pass->enabled = enabled;
    pass->enabledLine = 0;
    pass->enabledOrigin = flag;
  }

  void add(const char* flag, std::string path, std::string message, std::string nearest) {
    diagnostics_.push_back({flag, 0, std::move(path), std::move(message), std::move(nearest)});
  }

 private:
  PassEntry* find(const std::string& name, const char* flag) {
    PassEntry* pass = d_.find(name);
    // When the file could not be read, nothing is known about its passes.
    if (!pass && !d_.broken) {
      if (names_.empty()) names_ = namesOf(d_.passes);
      add(flag, name, fmt::format("there is no pass '{}' in the graph; it has: {}", name, listed(names_)),
          nearest_.find(name, names_));
    }
    return pass;
  }

  Description& d_;
  std::vector<Diagnostic>& diagnostics_;
  std::vector<std::string> names_;  ///< of the passes, once a message needs them
  NearestNames nearest_;
};

}  // namespace

void apply(Description& description, const Overrides& overrides, std::vector<Diagnostic>& diagnostics) {
  Applier applier(description, diagnostics);
  for (const std::string& text : overrides.set) applier.set(text);
  for (const std::string& name : overrides.enable) applier.enable(name, true);
  for (const std::string& name : overrides.disable) {
    const bool both = std::count(overrides.enable.begin(), overrides.enable.end(), name) > 0;
    if (both)
      applier.add("--disable", name, "the pass is both enabled and disabled; expected one of the two", "");
    else
      applier.enable(name, false);
  }
}

}  // namespace weir::graph
