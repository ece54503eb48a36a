#include "view/document/model.h"

#include "view/document/words.h"

#include <weir/graph/params.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
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
    for (const PassEntry& entry : description_.passes)
      passes_[entry.name] = {&entry, input_.context.catalog.find(entry.type), {}, false};
    for (const std::string& name : order()) {
      indices_[name] = model_.passes.size();
      model_.passes.push_back(passOf(passes_.at(name)));
    }
    connect();
    findNeeded();
    for (PassModel& pass : model_.passes) pass.mustRun = mustRun(pass);
    place();
    if (passes_.contains(input_.choicesOf)) {
      model_.choicesOf = input_.choicesOf;
      model_.choices = fittingTypes(document_, input_.context, input_.choicesOf);
    }
    return std::move(model_);
  }

 private:
  /// Where a pass stands: running ones at odd numbers, others between them.
  struct Rank {
    size_t at = 0, sequence = 0;
    bool operator<(const Rank& other) const { return std::pair(at, sequence) < std::pair(other.at, other.sequence); }
  };
  struct Entry {
    const PassEntry* entry = nullptr;
    const PassDescription* type = nullptr;
    std::optional<Rank> rank;
    bool runs = false;
  };

  /// The passes that run, in their order, and each of the others behind the last thing that it reads, or before the
  /// first that reads it, so that it stands where it would run.
  std::vector<std::string> order() {
    size_t running = 0;
    if (input_.running)
      for (const graph::CompiledPass& pass : input_.running->passes)
        if (const auto found = passes_.find(pass.name); found != passes_.end()) {
          found->second.rank = Rank{2 * running++ + 1, 0};
          found->second.runs = true;
        }
    std::map<std::string, size_t, std::less<>> firstReader;
    for (const auto& [name, pass] : passes_)
      for (const InputEntry& in : pass.entry->inputs)
        if (pass.runs && in.source && !in.source->previous) {
          const auto [first, isNew] = firstReader.emplace(in.source->pass, pass.rank->at);
          first->second = std::min(first->second, pass.rank->at);
        }
    size_t sequence = 0;
    std::set<const PassEntry*> visited;
    for (const PassEntry& entry : description_.passes)
      rank(passes_.at(entry.name), 2 * running, firstReader, visited, sequence);
    std::vector<std::pair<Rank, std::string>> ranked;
    for (const auto& [name, pass] : passes_) ranked.emplace_back(*pass.rank, name);
    std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> names;
    for (auto& [unused, name] : ranked) names.push_back(std::move(name));
    return names;
  }

  /// Depth first, so that what a pass reads has its rank before it; a circle is cut where it closes.
  void rank(Entry& start, size_t last, const std::map<std::string, size_t, std::less<>>& firstReader,
            std::set<const PassEntry*>& visited, size_t& sequence) {
    std::vector<std::pair<Entry*, size_t>> path;  // and which input comes next
    const auto enter = [&](Entry& pass) {
      if (!pass.rank && visited.insert(pass.entry).second) path.emplace_back(&pass, 0);
    };
    enter(start);
    while (!path.empty()) {
      auto& [pass, next] = path.back();
      const std::vector<InputEntry>& inputs = pass->entry->inputs;
      if (next < inputs.size()) {
        const InputEntry& in = inputs[next++];
        const auto source = in.source && !in.source->previous ? passes_.find(in.source->pass) : passes_.end();
        if (source != passes_.end()) enter(source->second);
        continue;
      }
      size_t behind = 0;
      for (const InputEntry& in : inputs)
        if (in.source && !in.source->previous)
          if (const auto source = passes_.find(in.source->pass); source != passes_.end() && source->second.rank)
            behind = std::max(behind, (source->second.rank->at + 1) / 2 * 2);
      const auto reader = firstReader.find(pass->entry->name);
      const size_t alone = reader == firstReader.end() ? last : reader->second - 1;
      pass->rank = Rank{behind > 0 ? behind : alone, ++sequence};
      path.pop_back();
    }
  }

  PassModel passOf(const Entry& known) const {
    const PassEntry& entry = *known.entry;
    PassModel pass;
    pass.name = entry.name;
    pass.type = entry.type;
    pass.enabled = entry.enabled;
    pass.runs = known.runs && entry.enabled;
    if (!pass.runs) pass.reason = reasonOf(entry);
    const PassDescription* type = known.type;
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
    if (input_.running && input_.problems.empty())
      for (const graph::Skipped& skipped : input_.running->skipped)
        if (skipped.pass == entry.name) return skipped.reason;
    return entry.enabled ? "the graph can't run as it is written" : "it is disabled";
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

  /// Which outputs somebody would miss.
  void findNeeded() {
    for (const PassModel& pass : model_.passes) needed_.emplace_back(pass.outputs.size(), false);
    for (const EdgeModel& edge : model_.edges) {
      const PassModel &from = model_.passes[edge.from], &to = model_.passes[edge.to];
      const PortDescription& output = passes_.at(from.name).type->outputs[edge.output];
      if (to.enabled && (!output.absentWhenDisabled || to.inputs[edge.input].required))
        needed_[edge.from][edge.output] = true;
    }
    for (const graph::OutputEntry& out : description_.outputs) {
      if (!out.source || !indices_.contains(out.source->pass)) continue;
      const size_t pass = indices_.at(out.source->pass);
      const size_t output = indexOf(model_.passes[pass].outputs, out.source->port);
      if (output < needed_[pass].size()) needed_[pass][output] = true;
    }
  }

  /// Why nothing could stand for an output that is read.
  std::string mustRun(const PassModel& pass) const {
    const PassDescription* type = passes_.at(pass.name).type;
    for (size_t o = 0; o < pass.outputs.size(); ++o) {
      const PortDescription& output = type->outputs[o];
      if (!needed_[indices_.at(pass.name)][o]) continue;
      if (output.passesThrough.empty())
        return fmt::format("its '{}' is read, and nothing can stand for it", output.name);
      const size_t input = indexOf(pass.inputs, output.passesThrough);
      if (input < pass.inputs.size() && pass.inputs[input].port.empty())
        return fmt::format("its input '{}', which would stand for its '{}', is open", output.passesThrough,
                           output.name);
    }
    return "";
  }

  /// Each problem to the widget that can mend it.
  void place() {
    for (const Problem& problem : model_.problems) {
      const auto at = indices_.find(problem.pass);
      if (at == indices_.end()) continue;
      PassModel& pass = model_.passes[at->second];
      std::vector<std::string>* list = &pass.problems;
      for (ParamModel& param : pass.params)
        if (problem.place == "params." + param.description.name) list = &param.problems;
      for (PortModel& input : pass.inputs)
        if (problem.place == "inputs." + input.name) list = &input.problems;
      list->push_back(problem.message.empty() ? problem.text : problem.message);
    }
  }

  const ModelInput& input_;
  const Document& document_;
  const graph::Description& description_;
  std::map<std::string, Entry, std::less<>> passes_;
  std::map<std::string, size_t, std::less<>> indices_;
  std::vector<std::vector<bool>> needed_;  ///< by pass and output
  GraphModel model_;
};

}  // namespace

std::vector<Problem> problemsOf(const std::vector<graph::Diagnostic>& diagnostics) {
  std::vector<Problem> problems;
  for (const graph::Diagnostic& d : diagnostics) {
    Problem& problem = problems.emplace_back();
    problem.text = d.text();
    problem.message = graph::Diagnostic{"", 0, "", d.message, d.nearest}.text();
    // "passes.NAME.params.PARAM", "passes.NAME.inputs.PORT", "passes.NAME.type": names of passes have no dots.
    constexpr std::string_view kPasses = "passes.";
    if (!d.path.starts_with(kPasses)) continue;
    const std::string rest = d.path.substr(kPasses.size());
    const size_t dot = rest.find('.');
    problem.pass = rest.substr(0, dot);
    if (dot != std::string::npos) problem.place = rest.substr(dot + 1);
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
