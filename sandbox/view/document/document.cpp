#include "view/document/document.h"

#include "view/document/json_text.h"

#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/graph/names.h>
#include <weir/render/write_file.h>

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace weir::view {
namespace {

/// Steps of undo, and bytes of all their texts: the oldest go first.
constexpr size_t kMostSteps = 256, kMostBytes = size_t{32} << 20u;

std::string readFile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(path + ": is a folder; expected a graph's JSON file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": can't be read; expected a graph's JSON file");
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw InputError(path + ": reading failed");
  return text;
}

graph::Description parse(const std::string& text, const std::string& file) {
  std::vector<graph::Diagnostic> diagnostics;
  graph::Description description = graph::parse(text, file, diagnostics);
  if (!diagnostics.empty()) throw graph::GraphError(std::move(diagnostics));
  return description;
}

std::string jsonOf(const ParamValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return quoted(*text);
  if (const auto* number = std::get_if<float>(&value); number && !std::isfinite(*number))
    throw InputError(fmt::format("{} is no number that a graph can have", *number));
  return toText(value);
}

/// Without the member, and without its object if that was all it had.
std::string pruned(const std::string& json, const std::string& pass, const char* group, const std::string& key) {
  std::string text = withoutMember(json, {"passes", pass, group}, key);
  return valueText(text, {"passes", pass, group}) == "{}" ? withoutMember(text, {"passes", pass}, group) : text;
}

std::string withinPass(const std::string& json, const std::string& pass, const char* group, const std::string& key,
                       const std::string& value) {
  if (valueText(json, {"passes", pass, group}).empty())
    return withMember(json, {"passes", pass}, group, fmt::format("{{ {}: {} }}", quoted(key), value));
  return withMember(json, {"passes", pass, group}, key, value);
}

}  // namespace

Document Document::load(const std::string& path) {
  return fromText(readFile(path), path);
}

Document Document::fromText(std::string text, std::string file) {
  Document document;
  document.file_ = std::move(file);
  document.adopt(std::move(text));
  document.saved_ = document.text_;
  return document;
}

void Document::adopt(std::string text) {
  description_ = parse(text, file_);
  text_ = std::move(text);
}

// -------------------------------------------------------------------------------------------------------- files

void Document::save() {
  saveAs(file_);
}

void Document::saveAs(const std::string& path) {
  render::checkWritable(path);
  render::writeTextFile(path, text_);
  saved_ = text_;
  if (path == file_) return;
  file_ = path;
  adopt(text_);
}

void Document::reread() {
  const std::string text = readFile(file_);
  edit(text, "the file as it was changed");
  saved_ = text;
}

bool Document::fileDiffers() const {
  try {
    return readFile(file_) != saved_;
  } catch (const InputError&) {
    return true;
  }
}

// -------------------------------------------------------------------------------------------------------- edits

void Document::requirePass(const std::string& pass) const {
  if (description_.find(pass)) return;
  const std::vector<std::string> names = graph::namesOf(description_.passes);
  const std::string nearest = nearestName(pass, names);
  throw InputError(fmt::format("{}: there is no pass '{}'; it has: {}{}", file_, pass, graph::listed(names),
                               nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest)));
}

void Document::edit(std::string text, std::string what, std::string about, bool continues) {
  if (text == text_) return;
  std::string before = text_;
  adopt(std::move(text));
  const bool joins = continues && redo_.empty() && !undo_.empty() && !about.empty() && undo_.back().about == about;
  redo_.clear();
  if (!joins) push({std::move(before), std::move(what), std::move(about)});
}

void Document::push(Step step) {
  undo_.push_back(std::move(step));
  size_t bytes = 0, kept = 0;
  while (kept < undo_.size() && kept < kMostSteps && bytes <= kMostBytes)
    bytes += undo_[undo_.size() - ++kept].text.size();
  undo_.erase(undo_.begin(), undo_.end() - static_cast<std::ptrdiff_t>(kept));
}

/// As the file has it where that is the same number: a value that comes back leaves no change.
std::string Document::spelling(const std::string& pass, const std::string& param, const ParamValue& value) const {
  if (const auto* number = std::get_if<float>(&value)) {
    const std::string_view written = valueText(saved_, {"passes", pass, "params", param});
    double was = 0;
    const auto [end, error] = std::from_chars(written.data(), written.data() + written.size(), was);
    const bool whole = error == std::errc() && end == written.data() + written.size();
    if (whole && static_cast<float>(was) == *number) return std::string(written);
  }
  return jsonOf(value);
}

void Document::setParam(const std::string& pass, const std::string& param, const ParamValue& value, bool continues) {
  requirePass(pass);
  setParamText(pass, param, spelling(pass, param, value), continues);
}

void Document::setParamText(const std::string& pass, const std::string& param, const std::string& json,
                            bool continues) {
  requirePass(pass);
  const std::string name = fmt::format("{}.{}", pass, param);
  edit(withinPass(text_, pass, "params", param, json), name, name, continues);
}

void Document::resetParam(const std::string& pass, const std::string& param) {
  requirePass(pass);
  edit(pruned(text_, pass, "params", param), fmt::format("reset of {}.{}", pass, param));
}

void Document::setEnabled(const std::string& pass, bool enabled) {
  requirePass(pass);
  const JsonPath at = {"passes", pass};
  // A file that says nothing says that it is enabled: to say so takes the word away again that was not there.
  const bool unsaid = valueText(saved_, {"passes", pass, "enabled"}).empty();
  edit(enabled && unsaid ? withoutMember(text_, at, "enabled") : withMember(text_, at, "enabled", toText(enabled)),
       fmt::format("{} {}", pass, enabled ? "enabled" : "disabled"));
}

void Document::setInput(const std::string& pass, const std::string& port, const std::optional<std::string>& reference) {
  requirePass(pass);
  edit(reference ? withinPass(text_, pass, "inputs", port, quoted(*reference)) : pruned(text_, pass, "inputs", port),
       fmt::format("what {}.{} reads", pass, port));
}

void Document::setOutput(const std::string& output, const std::optional<std::string>& reference) {
  edit(reference ? withMember(text_, {"outputs"}, output, quoted(*reference))
                 : withoutMember(text_, {"outputs"}, output),
       fmt::format("output {}", output));
}

void Document::setType(const std::string& pass, const std::string& type) {
  requirePass(pass);
  edit(withMember(text_, {"passes", pass}, "type", quoted(type)), fmt::format("{} as {}", pass, type));
}

void Document::addPass(const std::string& pass, const std::string& type) {
  if (description_.find(pass)) throw InputError(fmt::format("{}: there is a pass '{}' already", file_, pass));
  edit(withMember(text_, {"passes"}, pass, fmt::format("{{ \"type\": {} }}", quoted(type))),
       fmt::format("new pass {}", pass));
}

void Document::removePass(const std::string& pass) {
  requirePass(pass);
  edit(withoutMember(text_, {"passes"}, pass), fmt::format("removal of {}", pass));
}

void Document::replace(std::string text, const std::string& what) {
  edit(std::move(text), what);
}

// --------------------------------------------------------------------------------------------------------- undo

const std::string& Document::undoes() const {
  static const std::string kNothing;
  return undo_.empty() ? kNothing : undo_.back().what;
}

const std::string& Document::redoes() const {
  static const std::string kNothing;
  return redo_.empty() ? kNothing : redo_.back().what;
}

void Document::undo() {
  if (undo_.empty()) return;
  Step step = std::move(undo_.back());
  undo_.pop_back();
  redo_.push_back({text_, step.what, step.about});
  adopt(std::move(step.text));
}

void Document::redo() {
  if (redo_.empty()) return;
  Step step = std::move(redo_.back());
  redo_.pop_back();
  push({text_, step.what, step.about});
  adopt(std::move(step.text));
}

const Remembered* Document::remembered(const std::string& pass, const std::string& type) const {
  const auto found = remembered_.find({pass, type});
  return found == remembered_.end() ? nullptr : &found->second;
}

void Document::remember(const std::string& pass, const std::string& type, Remembered what) {
  remembered_[{pass, type}] = std::move(what);
}

}  // namespace weir::view
