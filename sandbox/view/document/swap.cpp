#include "view/document/swap.h"

#include "view/document/json_text.h"

#include <weir/core/error.h>
#include <weir/graph/params.h>

#include <fmt/format.h>

#include <array>
#include <optional>
#include <set>
#include <utility>

namespace weir::view {
namespace {

using graph::Description;
using graph::InputEntry;
using graph::ParamEntry;
using graph::PassEntry;
using graph::Reference;

std::string textOf(const Reference& reference) {
  return fmt::format("{}.{}{}", reference.pass, reference.port, reference.previous ? "@previous" : "");
}

/// What is wrong with a text, each finding without its line, which edits move.
std::set<std::string> findingsOf(const Description& description, const SwapContext& context) {
  std::vector<graph::Diagnostic> diagnostics;
  graph::compile(description, context.catalog, context.width, context.height, diagnostics);
  std::set<std::string> texts;
  for (const graph::Diagnostic& d : diagnostics) texts.insert(d.path + ": " + d.message);
  return texts;
}

class Planner {
 public:
  Planner(const Document& document, const SwapContext& context, const std::string& pass, const std::string& type)
      : document_(document), context_(context), description_(document.description()), type_(find(type)) {
    plan_.pass = pass;
    plan_.type = type;
    pass_ = description_.find(pass);
    if (!pass_) throw InputError(fmt::format("{}: there is no pass '{}'", document.file(), pass));
    plan_.from = pass_->type;
  }

  SwapPlan plan() {
    if (!type_) {
      const std::string problem = context_.catalog.problem ? context_.catalog.problem(plan_.type) : "";
      return refuse(problem.empty() ? fmt::format("there is no type '{}'", plan_.type) : problem);
    }
    if (const std::string missing = missingOutput(); !missing.empty()) return refuse(missing);
    plan_.outputsFit = true;
    plan_.remembered.before = passText(document_.text());
    const Remembered* earlier = document_.remembered(plan_.pass, plan_.type);
    std::string text = withMember(document_.text(), at(), "type", quoted(plan_.type));
    text = connect(moveParams(text, earlier), earlier);
    // Nothing happened since it was swapped the other way: it is then as it was, spaces and order too.
    if (earlier && earlier->after == plan_.remembered.before) {
      const std::string back = withMember(document_.text(), {"passes"}, plan_.pass, earlier->before);
      if (problemOf(back).empty()) return accept(back);
    }
    if (const std::string open = openInput(text); !open.empty()) return refuse(open);
    const std::string problem = problemOf(text);
    return problem.empty() ? accept(text) : refuse(problem);
  }

 private:
  const PassDescription* find(const std::string& type) const { return context_.catalog.find(type); }
  JsonPath at() const { return {"passes", plan_.pass}; }
  JsonPath at(const char* group) const { return {"passes", plan_.pass, group}; }
  std::string passText(const std::string& json) const { return std::string(valueText(json, at())); }

  SwapPlan refuse(const std::string& reason) {
    plan_.reason = reason;
    return std::move(plan_);
  }
  SwapPlan accept(const std::string& text) {
    plan_.possible = true;
    plan_.text = text;
    plan_.remembered.after = passText(text);
    return std::move(plan_);
  }

  /// What the pass's readers need and the new type lacks.
  std::string missingOutput() const {
    for (const PassEntry& reader : description_.passes) {
      const PassDescription* readerType = reader.name == plan_.pass ? nullptr : find(reader.type);
      if (!readerType) continue;
      for (const InputEntry& input : reader.inputs) {
        if (!input.source || input.source->pass != plan_.pass) continue;
        const PortDescription* port = readerType->findInput(input.port);
        const PortDescription* output = type_->findOutput(input.source->port);
        if (!output)
          return fmt::format("{} reads its '{}', which {} has not", reader.name, input.source->port, plan_.type);
        if (port && !compatible(output->type, port->type))
          return fmt::format("{} reads its '{}' as {}, which {} makes as {}", reader.name, output->name,
                             describe(port->type), plan_.type, describe(output->type));
      }
    }
    for (const graph::OutputEntry& output : description_.outputs) {
      if (!output.source || output.source->pass != plan_.pass) continue;
      const PortDescription* has = type_->findOutput(output.source->port);
      const PassDescription* old = find(plan_.from);
      const PortDescription* had = old ? old->findOutput(output.source->port) : nullptr;
      if (!has)
        return fmt::format("the graph's output '{}' is its '{}', which {} has not", output.name, output.source->port,
                           plan_.type);
      if (had && !compatible(has->type, had->type))
        return fmt::format("the graph's output '{}' is {}, which {} makes as {}", output.name, describe(had->type),
                           plan_.type, describe(has->type));
    }
    return "";
  }

  std::string dropMember(const std::string& json, const char* group, const std::string& key) {
    plan_.dropped.push_back(fmt::format("{}.{}", group, key));
    return withoutMember(json, at(group), key);
  }

  std::string withGroup(const std::string& json, const char* group, const std::string& key, const std::string& value) {
    const std::string text = valueText(json, at(group)).empty() ? withMember(json, at(), group, "{}") : json;
    return withMember(text, at(group), key, value);
  }

  std::string withoutEmpty(const std::string& json, const char* group) const {
    return valueText(json, at(group)) == "{}" ? withoutMember(json, at(), group) : json;
  }

  bool paramFits(const ParamEntry& entry) const {
    const PassDescription* old = find(plan_.from);
    const ParamDescription* was = old ? old->findParam(entry.name) : nullptr;
    const ParamDescription* is = type_->findParam(entry.name);
    return is && (!was || was->type == is->type) && graph::readParam(*is, entry);
  }

  std::string moveParams(std::string json, const Remembered* earlier) {
    for (const ParamEntry& entry : pass_->params) {
      if (paramFits(entry)) continue;
      plan_.remembered.params[entry.name] = valueText(document_.text(), {"passes", plan_.pass, "params", entry.name});
      json = dropMember(json, "params", entry.name);
    }
    if (earlier)
      for (const auto& [name, value] : earlier->params)
        if (type_->findParam(name) && valueText(json, {"passes", plan_.pass, "params", name}).empty())
          json = withGroup(json, "params", name, value);
    return withoutEmpty(json, "params");
  }

  /// The output that a reference means once the pass has its new type.
  const PortDescription* outputOf(const Reference& reference) const {
    if (reference.pass == plan_.pass) return type_->findOutput(reference.port);
    const PassEntry* pass = description_.find(reference.pass);
    const PassDescription* type = pass ? find(pass->type) : nullptr;
    return type ? type->findOutput(reference.port) : nullptr;
  }

  bool fits(const Reference& reference, const PortDescription& input) const {
    if (reference.pass == plan_.pass && !reference.previous) return false;
    const PortDescription* output = outputOf(reference);
    return output && compatible(output->type, input.type);
  }

  std::string connect(std::string json, const Remembered* earlier) {
    std::vector<Reference> dropped;
    std::set<std::string> connected;
    for (const InputEntry& entry : pass_->inputs) {
      const PortDescription* input = type_->findInput(entry.port);
      if (input && entry.source && fits(*entry.source, *input)) {
        connected.insert(entry.port);
        continue;
      }
      if (entry.source) dropped.push_back(*entry.source);
      plan_.remembered.inputs[entry.port] = valueText(document_.text(), {"passes", plan_.pass, "inputs", entry.port});
      json = dropMember(json, "inputs", entry.port);
    }
    for (const PortDescription& input : type_->inputs) {
      if (connected.contains(input.name)) continue;
      std::optional<Reference> source = rememberedSource(input, earlier);
      if (!source && input.required) source = guess(input, dropped);
      if (!source) continue;
      json = withGroup(json, "inputs", input.name, quoted(textOf(*source)));
      plan_.added.push_back(fmt::format("inputs.{} ← {}", input.name, textOf(*source)));
    }
    return withoutEmpty(json, "inputs");
  }

  std::optional<Reference> rememberedSource(const PortDescription& input, const Remembered* earlier) const {
    if (!earlier) return std::nullopt;
    const auto found = earlier->inputs.find(input.name);
    if (found == earlier->inputs.end()) return std::nullopt;
    const std::string& json = found->second;  // a reference in quotes, which has nothing to escape
    std::optional<Reference> reference = graph::parseReference(json.substr(1, json.size() - 2));
    return reference && fits(*reference, input) ? reference : std::nullopt;
  }

  /// A required input's source, where only one comes into question.
  std::optional<Reference> guess(const PortDescription& input, const std::vector<Reference>& dropped) const {
    std::vector<Reference> elsewhere, named;
    for (const PassEntry& pass : description_.passes) {
      if (pass.name == plan_.pass) continue;
      for (const InputEntry& entry : pass.inputs)
        if (entry.port == input.name && entry.source) elsewhere.push_back(*entry.source);
      named.push_back({pass.name, input.name, false});
    }
    const std::array<const std::vector<Reference>*, 3> pools = {&dropped, &elsewhere, &named};
    for (const std::vector<Reference>* pool : pools)
      if (std::optional<Reference> only = onlyOne(*pool, input)) return only;
    return std::nullopt;
  }

  std::optional<Reference> onlyOne(const std::vector<Reference>& pool, const PortDescription& input) const {
    std::optional<Reference> found;
    for (const Reference& reference : pool) {
      if (!fits(reference, input)) continue;
      if (found && textOf(*found) != textOf(reference)) return std::nullopt;
      found = reference;
    }
    return found;
  }

  std::string openInput(const std::string& json) const {
    for (const PortDescription& input : type_->inputs)
      if (input.required && valueText(json, {"passes", plan_.pass, "inputs", input.name}).empty())
        return fmt::format("its input '{}' ({}) has no one source in this graph", input.name, describe(input.type));
    return "";
  }

  /// The first finding that the graph does not have as it is.
  std::string problemOf(const std::string& json) const {
    std::vector<graph::Diagnostic> diagnostics;
    const Description description = graph::parse(json, document_.file(), diagnostics);
    if (!diagnostics.empty()) return diagnostics.front().text();
    const std::set<std::string> after = findingsOf(description, context_);
    if (after.empty()) return "";
    const std::set<std::string> before = findingsOf(description_, context_);
    for (const std::string& finding : after)
      if (!before.contains(finding)) return finding;
    return "";
  }

  const Document& document_;
  const SwapContext& context_;
  const Description& description_;
  const PassDescription* type_;
  const PassEntry* pass_ = nullptr;
  SwapPlan plan_;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string changesOf(const SwapPlan& plan) {
  std::string text;
  if (!plan.dropped.empty()) text += "leaves out " + joined(plan.dropped);
  if (!plan.added.empty()) text += (text.empty() ? "adds " : "; adds ") + joined(plan.added);
  return text;
}

}  // namespace

SwapPlan planSwap(const Document& document, const SwapContext& context, const std::string& pass,
                  const std::string& type) {
  return Planner(document, context, pass, type).plan();
}

std::vector<TypeChoice> fittingTypes(const Document& document, const SwapContext& context, const std::string& pass) {
  const graph::PassEntry* entry = document.description().find(pass);
  if (!entry) throw InputError(fmt::format("{}: there is no pass '{}'", document.file(), pass));
  std::vector<TypeChoice> choices;
  for (const std::string& type : context.catalog.types()) {
    const PassDescription* description = context.catalog.find(type);
    if (!description) continue;
    TypeChoice choice;
    choice.type = type;
    choice.doc = description->text;
    choice.current = type == entry->type;
    choice.possible = true;
    if (!choice.current) {
      const SwapPlan plan = planSwap(document, context, pass, type);
      if (!plan.outputsFit) continue;
      choice.possible = plan.possible;
      choice.reason = plan.reason;
      choice.changes = changesOf(plan);
    }
    choices.push_back(std::move(choice));
  }
  return choices;
}

void swapType(Document& document, const SwapContext& context, const std::string& pass, const std::string& type) {
  SwapPlan plan = planSwap(document, context, pass, type);
  if (plan.from == type) return;
  if (!plan.possible) throw InputError(fmt::format("{} can't be {}: {}", pass, type, plan.reason));
  document.replace(plan.text, fmt::format("{} as {}", pass, type));
  document.remember(pass, plan.from, std::move(plan.remembered));
}

}  // namespace weir::view
