#include "view/document/model.h"

#include "view/document/words.h"

#include <weir/graph/params.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace weir::view {
namespace {

using graph::InputEntry;
using graph::ParamEntry;
using graph::PassEntry;

class Builder {
 public:
  explicit Builder(const ModelInput& input)
      : input_(input), document_(input.document), description_(document_.description()) {}

  GraphModel build() {
    model_.name = description_.name;
    model_.file = document_.file();
    model_.changed = document_.changed();
    model_.undoes = document_.undoes();
    model_.redoes = document_.redoes();
    model_.problems = input_.problems;
    for (const PassEntry& entry : description_.passes) types_[entry.name] = input_.context.catalog.find(entry.type);
    for (const std::string& name : order()) {
      indices_[name] = model_.passes.size();
      model_.passes.push_back(passOf(*description_.find(name)));
    }
    connect();
    for (PassModel& pass : model_.passes) pass.mustRun = mustRun(pass);
    place();
    if (description_.find(input_.choicesOf)) {
      model_.choicesOf = input_.choicesOf;
      model_.choices = fittingTypes(document_, input_.context, input_.choicesOf);
    }
    return std::move(model_);
  }

 private:
  /// The passes that run, in their order, and each of the others behind the last thing that it reads, so that it stands
  /// where it would run.
  std::vector<std::string> order() {
    std::vector<std::string> names;
    if (input_.running)
      for (const graph::CompiledPass& pass : input_.running->passes)
        if (description_.find(pass.name)) names.push_back(pass.name);
    running_.insert(names.begin(), names.end());
    std::vector<const PassEntry*> open;
    for (const PassEntry& entry : description_.passes)
      if (!running_.contains(entry.name)) open.push_back(&entry);
    while (!open.empty()) {
      // One whose sources stand already, or where passes read each other in a circle any.
      const std::set<std::string, std::less<>> placed(names.begin(), names.end());
      auto next = std::find_if(open.begin(), open.end(), [&](const PassEntry* entry) {
        return std::all_of(entry->inputs.begin(), entry->inputs.end(), [&](const InputEntry& in) {
          return !in.source || in.source->previous || placed.contains(in.source->pass) ||
                 !description_.find(in.source->pass);
        });
      });
      if (next == open.end()) next = open.begin();
      names.insert(names.begin() + static_cast<std::ptrdiff_t>(placeOf(**next, names)), (*next)->name);
      open.erase(next);
    }
    return names;
  }

  size_t placeOf(const PassEntry& entry, const std::vector<std::string>& names) const {
    size_t behind = 0;
    for (const InputEntry& in : entry.inputs)
      if (in.source && !in.source->previous)
        for (size_t i = 0; i < names.size(); ++i)
          if (names[i] == in.source->pass) behind = std::max(behind, i + 1);
    if (behind > 0) return behind;
    for (size_t i = 0; i < names.size(); ++i)
      for (const InputEntry& in : description_.find(names[i])->inputs)
        if (in.source && !in.source->previous && in.source->pass == entry.name) return i;
    return names.size();
  }

  PassModel passOf(const PassEntry& entry) const {
    PassModel pass;
    pass.name = entry.name;
    pass.type = entry.type;
    pass.enabled = entry.enabled;
    pass.runs = running_.contains(entry.name) && entry.enabled;
    if (!pass.runs) pass.reason = reasonOf(entry);
    const PassDescription* type = types_.at(entry.name);
    pass.known = type != nullptr;
    if (!type) return pass;
    pass.doc = type->text;
    for (const ParamDescription& param : type->params) {
      pass.params.push_back(paramOf(param, entry));
      pass.changed += pass.params.back().changed ? 1 : 0;
    }
    for (const PortDescription& port : type->inputs) {
      PortModel& input = pass.inputs.emplace_back(portOf(port, {}));
      for (const InputEntry& in : entry.inputs)
        if (in.port == port.name && in.source) {
          input.port = in.source->pass + "." + in.source->port;
          input.previous = in.source->previous;
        }
    }
    for (const PortDescription& port : type->outputs) {
      PortModel& output = pass.outputs.emplace_back(portOf(port, pass.params));
      output.port = entry.name + "." + port.name;
    }
    return pass;
  }

  std::string reasonOf(const PassEntry& entry) const {
    if (input_.running)
      for (const graph::Skipped& skipped : input_.running->skipped)
        if (skipped.pass == entry.name) return skipped.reason;
    return entry.enabled ? "the graph has not been compiled since it is there" : "it is disabled";
  }

  static ParamModel paramOf(const ParamDescription& description, const PassEntry& entry) {
    ParamModel param;
    param.description = description;
    param.value = description.defaultValue;
    param.tooltip = paramWords(description);
    for (const ParamEntry& said : entry.params) {
      if (said.name != description.name) continue;
      param.written = true;
      if (const auto value = graph::readParam(description, said)) param.value = *value;
    }
    param.changed = param.value != description.defaultValue;
    return param;
  }

  static PortModel portOf(const PortDescription& description, const std::vector<ParamModel>& params) {
    PortModel port;
    port.name = description.name;
    port.doc = description.doc;
    port.required = description.required;
    port.type = portWords(description.type, params);
    return port;
  }

  template <typename Ports>
  static size_t indexOf(const Ports& ports, const std::string& name) {
    const auto found = std::find_if(ports.begin(), ports.end(), [&](const auto& port) { return port.name == name; });
    return static_cast<size_t>(found - ports.begin());
  }

  /// Edges as they are written: a disabled pass keeps its own.
  void connect() {
    for (const PassEntry& reader : description_.passes) {
      const size_t to = indices_.at(reader.name);
      for (const InputEntry& in : reader.inputs) {
        if (!in.source || !indices_.contains(in.source->pass)) continue;
        const size_t from = indices_.at(in.source->pass);
        const size_t output = indexOf(model_.passes[from].outputs, in.source->port);
        const size_t input = indexOf(model_.passes[to].inputs, in.port);
        if (output == model_.passes[from].outputs.size() || input == model_.passes[to].inputs.size()) continue;
        model_.passes[from].outputs[output].readers.push_back(reader.name + "." + in.port +
                                                              (in.source->previous ? " (next frame)" : ""));
        model_.edges.push_back({from, output, to, input, in.source->previous});
      }
    }
    for (const graph::OutputEntry& out : description_.outputs) {
      if (!out.source || !indices_.contains(out.source->pass)) continue;
      std::vector<PortModel>& outputs = model_.passes[indices_.at(out.source->pass)].outputs;
      const size_t output = indexOf(outputs, out.source->port);
      if (output < outputs.size()) outputs[output].readers.push_back("output " + out.name);
    }
  }

  /// Why nothing could stand for an output that is read.
  std::string mustRun(const PassModel& pass) const {
    const PassDescription* type = types_.at(pass.name);
    if (!type) return "";
    for (size_t o = 0; o < type->outputs.size(); ++o) {
      const PortDescription& output = type->outputs[o];
      if (!isNeeded(pass.outputs[o], output)) continue;
      if (output.passesThrough.empty())
        return fmt::format("its '{}' is read, and nothing can stand for it", output.name);
      const size_t input = indexOf(pass.inputs, output.passesThrough);
      if (input < pass.inputs.size() && pass.inputs[input].port.empty())
        return fmt::format("its input '{}', which would stand for its '{}', is open", output.passesThrough, output.name);
    }
    return "";
  }

  bool isNeeded(const PortModel& port, const PortDescription& output) const {
    for (const graph::OutputEntry& out : description_.outputs)
      if (out.source && out.source->pass + "." + out.source->port == port.port) return true;
    for (const EdgeModel& edge : model_.edges) {
      if (model_.passes[edge.from].outputs[edge.output].port != port.port || !model_.passes[edge.to].enabled) continue;
      if (!output.absentWhenDisabled || model_.passes[edge.to].inputs[edge.input].required) return true;
    }
    return false;
  }

  /// Each problem to the widget that can mend it.
  void place() {
    for (const Problem& problem : model_.problems) {
      const auto at = indices_.find(problem.pass);
      if (at == indices_.end()) continue;
      PassModel& pass = model_.passes[at->second];
      std::vector<std::string>* list = &pass.problems;
      for (ParamModel& param : pass.params)
        if (param.description.name == problem.param) list = &param.problems;
      for (PortModel& input : pass.inputs)
        if (problem.param == "inputs." + input.name) list = &input.problems;
      list->push_back(problem.text);
    }
  }

  const ModelInput& input_;
  const Document& document_;
  const graph::Description& description_;
  std::map<std::string, const PassDescription*, std::less<>> types_;
  std::map<std::string, size_t, std::less<>> indices_;
  std::set<std::string, std::less<>> running_;
  GraphModel model_;
};

}  // namespace

std::vector<Problem> problemsOf(const std::vector<graph::Diagnostic>& diagnostics) {
  std::vector<Problem> problems;
  for (const graph::Diagnostic& d : diagnostics) {
    Problem& problem = problems.emplace_back();
    problem.text = d.text();
    // "passes.NAME.params.PARAM", "passes.NAME.inputs.PORT", "passes.NAME.type": names of passes have no dots.
    constexpr std::string_view kPasses = "passes.", kParams = "params.";
    if (!d.path.starts_with(kPasses)) continue;
    const std::string rest = d.path.substr(kPasses.size());
    const size_t dot = rest.find('.');
    problem.pass = rest.substr(0, dot);
    if (dot == std::string::npos) continue;
    problem.param = rest.substr(dot + 1);
    if (problem.param.starts_with(kParams)) problem.param.erase(0, kParams.size());
  }
  return problems;
}

const PassModel* GraphModel::find(const std::string& pass) const {
  const auto found = std::find_if(passes.begin(), passes.end(), [&](const PassModel& p) { return p.name == pass; });
  return found == passes.end() ? nullptr : &*found;
}

GraphModel buildModel(const ModelInput& input) {
  return Builder(input).build();
}

}  // namespace weir::view
