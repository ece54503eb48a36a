// JSON tree → Description. Checks structure only: which keys, of which kind, and whether references read as references.
#include <weir/core/text.h>
#include <weir/graph/description.h>
#include <weir/graph/json_tree.h>
#include <weir/graph/names.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

namespace weir::graph {
namespace {

constexpr int64_t kVersion = 1;
constexpr std::string_view kPrevious = "@previous";

const char* kind(const JsonValue& value) {
  return value.kindName();
}

template <typename T>
const T* as(const JsonValue& value) {
  return value.kind == JsonValue::Kind::Scalar ? std::get_if<T>(&value.scalar) : nullptr;
}

class Parser {
 public:
  Parser(const std::string& file, std::vector<Diagnostic>& diagnostics) : diagnostics_(diagnostics) { d_.file = file; }

  Description graph(const JsonValue& root) {
    d_.name = std::filesystem::path(d_.file).stem().string();
    if (!root.isObject()) {
      add(root.line, {}, fmt::format("a graph must be a JSON object, not {}", kind(root)));
      d_.broken = true;
      return std::move(d_);
    }
    bool hasPasses = false;
    static constexpr std::string_view kKeys[] = {"version", "name", "passes", "outputs", "$schema", "description"};
    const Path top;
    const Keys keys(*this, root, top, kKeys);
    // By name, as everywhere: what is said first must not depend on the file's order.
    for (const char* key : {"$schema", "description"})
      if (const JsonMember* member = keys.find(key)) expectText(member->value, {&top, key});
    if (const JsonMember* name = keys.find("name"); name && expectText(name->value, {&top, "name"}))
      d_.name = *as<std::string>(name->value);
    if (const JsonMember* member = keys.find("outputs")) outputs(member->value, {&top, "outputs"});
    if (const JsonMember* member = keys.find("passes")) hasPasses = passes(member->value, {&top, "passes"});
    if (const JsonMember* member = keys.find("version")) version(member->value);
    if (!keys.find("version"))
      add(root.line, {nullptr, "version"}, fmt::format("is missing; expected \"version\": {}", kVersion));
    if (!keys.find("passes")) add(root.line, {nullptr, "passes"}, "is missing; expected an object of passes");
    if (!keys.find("outputs"))
      add(root.line, {nullptr, "outputs"},
          "is missing; expected an object of at least one output, as \"color\": \"pass.port\"");
    d_.broken = !hasPasses;
    return std::move(d_);
  }

 private:
  /// "passes.a.inputs.x", put together only where something is said of it.
  struct Path {
    const Path* above = nullptr;
    std::string_view key;
    std::string text() const {
      std::string before = above ? above->text() : "";
      if (!before.empty()) before += '.';
      return before.append(key);
    }
  };

  /// The members of an object by known key. An unknown key is reported, and where it is a likely slip for a key that is
  /// absent, its value is read as that key's, so that one slip stays one finding.
  class Keys {
   public:
    Keys(Parser& parser, const JsonValue& object, const Path& path, std::span<const std::string_view> known)
        : known_(known) {
      bool allKnown = true;
      for (const JsonMember& member : object.members) {
        const size_t at = indexOf(member.key);
        if (at < known.size())
          members_[at] = &member;
        else
          allKnown = false;
      }
      if (!allKnown) report(parser, object, path);
    }
    const JsonMember* find(std::string_view key) const { return members_[indexOf(key)]; }

   private:
    static constexpr size_t kMost = 6;

    size_t indexOf(std::string_view key) const {
      return static_cast<size_t>(std::find(known_.begin(), known_.end(), key) - known_.begin());
    }

    void report(Parser& parser, const JsonValue& object, const Path& path) {
      const std::vector<std::string> known(known_.begin(), known_.end());
      for (const JsonMember& member : object.members) {
        if (indexOf(member.key) < known.size()) continue;
        const std::string nearest = nearestName(member.key, known);
        parser.add(member.line, {&path, member.key},
                   fmt::format("unknown key '{}'; expected one of: {}", member.key, listed(known)), nearest);
        if (nearest.empty() || !wouldFit(nearest, member.value)) continue;
        const JsonMember*& place = members_[indexOf(nearest)];
        if (!place) place = &member;
      }
    }

    static bool wouldFit(const std::string& key, const JsonValue& value) {
      const bool wantsObject = key == "passes" || key == "outputs" || key == "inputs" || key == "params";
      return wantsObject == value.isObject();
    }

    std::span<const std::string_view> known_;
    std::array<const JsonMember*, kMost + 1> members_{};  ///< by index into `known_`; one more, for what isn't known
  };

  void add(int line, const Path& path, std::string message, std::string nearest = "") {
    diagnostics_.push_back({d_.file, line, path.text(), std::move(message), std::move(nearest)});
  }

  bool expectText(const JsonValue& value, const Path& path) {
    if (as<std::string>(value)) return true;
    add(value.line, path, fmt::format("expected a text, not {}", kind(value)));
    return false;
  }

  bool expectObject(const JsonValue& value, const Path& path) {
    if (value.isObject()) return true;
    add(value.line, path, fmt::format("expected an object, not {}", kind(value)));
    return false;
  }

  void version(const JsonValue& value) {
    const int64_t* number = as<int64_t>(value);
    if (number && *number == kVersion) return;
    const std::string found = value.kind == JsonValue::Kind::Scalar ? toText(value.scalar) : kind(value);
    add(value.line, {nullptr, "version"},
        fmt::format("expected {}, the only version there is, not {}", kVersion, found));
  }

  bool passes(const JsonValue& value, const Path& path) {
    if (!expectObject(value, path)) return false;
    if (value.members.empty()) add(value.line, path, "there is no pass; expected at least one");
    d_.passes.reserve(value.members.size());
    for (const JsonMember& member : value.members) {
      const Path at{&path, member.key};
      if (!isName(member.key))
        add(member.line, at, fmt::format("'{}' can't be a pass's name; expected {}", member.key, kNameRule));
      PassEntry& entry = d_.passes.emplace_back();
      entry.name = member.key;
      entry.line = entry.typeLine = member.line;
      if (expectObject(member.value, at)) pass(member.value, at, entry);
    }
    return !value.members.empty();
  }

  void pass(const JsonValue& object, const Path& path, PassEntry& entry) {
    static constexpr std::string_view kKeys[] = {"type", "enabled", "inputs", "params"};
    const Keys keys(*this, object, path, kKeys);
    if (const JsonMember* member = keys.find("enabled")) enabled(member->value, {&path, "enabled"}, entry);
    if (const JsonMember* member = keys.find("inputs")) {
      const Path at{&path, "inputs"};
      entry.inputsBroken = !expectObject(member->value, at);
      entry.inputs.reserve(member->value.members.size());
      for (const JsonMember& input : member->value.members) entry.inputs.push_back(reference<InputEntry>(input, at));
    }
    if (const JsonMember* member = keys.find("params")) {
      const Path at{&path, "params"};
      if (expectObject(member->value, at))
        for (const JsonMember& param : member->value.members) parameter(param, {&at, param.key}, entry);
    }
    if (const JsonMember* member = keys.find("type"))
      type(member->value, {&path, "type"}, entry);
    else
      add(entry.line, {&path, "type"}, "is missing; expected a type, as \"plugin.Pass\"");
  }

  void enabled(const JsonValue& value, const Path& path, PassEntry& entry) {
    entry.enabledLine = value.line;
    if (const bool* on = as<bool>(value))
      entry.enabled = *on;
    else
      add(value.line, path, fmt::format("expected true or false, not {}", kind(value)));
  }

  void type(const JsonValue& value, const Path& path, PassEntry& entry) {
    entry.typeLine = value.line;
    if (!expectText(value, path)) return;
    entry.type = *as<std::string>(value);
    if (entry.type.empty()) add(value.line, path, "expected a type, as \"plugin.Pass\", not an empty text");
  }

  void parameter(const JsonMember& member, const Path& path, PassEntry& entry) {
    if (member.value.kind != JsonValue::Kind::Scalar) {
      add(member.value.line, path, fmt::format("expected a number, a text, true or false, not {}", kind(member.value)));
      return;
    }
    ParamEntry param;
    param.name = member.key;
    param.value = member.value.scalar;
    param.line = member.value.line;
    param.nameLine = member.line;
    entry.params.push_back(std::move(param));
  }

  static void setName(InputEntry& entry, const JsonMember& member) {
    entry.port = member.key;
    entry.nameLine = member.line;
  }
  static void setName(OutputEntry& entry, const JsonMember& member) { entry.name = member.key; }

  /// A malformed reference leaves `source` empty, which later checks take as "said already".
  template <typename Entry>
  Entry reference(const JsonMember& member, const Path& path) {
    const Path at{&path, member.key};
    Entry entry;
    setName(entry, member);
    entry.line = member.value.line;
    if (!expectText(member.value, at)) return entry;
    entry.text = *as<std::string>(member.value);
    entry.source = parseReference(entry.text);
    if (!entry.source)
      add(entry.line, at,
          fmt::format("'{}' is no reference; expected \"pass.port\" or \"pass.port@previous\"", entry.text),
          likelyReference(entry.text));
    return entry;
  }

  /// For "pass.port@prev".
  static std::string likelyReference(const std::string& text) {
    const std::string withSuffix = text.substr(0, text.find('@')) + std::string(kPrevious);
    return text.find('@') != std::string::npos && parseReference(withSuffix) ? withSuffix : "";
  }

  void outputs(const JsonValue& value, const Path& path) {
    if (!expectObject(value, path)) return;
    if (value.members.empty()) add(value.line, path, "there is no output; expected at least one");
    for (const JsonMember& member : value.members) {
      if (!isName(member.key))
        add(member.line, {&path, member.key},
            fmt::format("'{}' can't be an output's name; expected {}", member.key, kNameRule));
      d_.outputs.push_back(reference<OutputEntry>(member, path));
    }
  }

  Description d_;
  std::vector<Diagnostic>& diagnostics_;
};

template <typename Passes>
auto* findPass(Passes& passes, const std::string& name) {
  const auto found =
      std::find_if(passes.begin(), passes.end(), [&](const PassEntry& pass) { return pass.name == name; });
  return found == passes.end() ? nullptr : &*found;
}

}  // namespace

std::string toText(const RawValue& value) {
  if (std::holds_alternative<std::nullptr_t>(value)) return "null";
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<int64_t>(&value)) return fmt::format("{}", *v);
  if (const auto* v = std::get_if<double>(&value)) return fmt::format("{}", *v);
  return std::get<std::string>(value);
}

std::optional<Reference> parseReference(const std::string& text) {
  Reference reference;
  std::string_view rest = text;
  if (rest.ends_with(kPrevious)) {
    reference.previous = true;
    rest.remove_suffix(kPrevious.size());
  }
  const size_t dot = rest.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  reference.pass = rest.substr(0, dot);
  reference.port = rest.substr(dot + 1);
  if (!isName(reference.pass) || !isName(reference.port)) return std::nullopt;
  return reference;
}

PassEntry* Description::find(const std::string& pass) {
  return findPass(passes, pass);
}
const PassEntry* Description::find(const std::string& pass) const {
  return findPass(passes, pass);
}

Description parse(const std::string& json, const std::string& file, std::vector<Diagnostic>& diagnostics) {
  JsonValue root;
  if (readJson(json, file, root, diagnostics)) return Parser(file, diagnostics).graph(root);
  Description description;
  description.file = file;
  description.broken = true;
  return description;
}

Description load(const std::string& path, std::vector<Diagnostic>& diagnostics) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path + ": is a folder; expected a graph's JSON file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": can't be read; expected a graph's JSON file");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw InputError(path + ": reading failed");
  return parse(text, path, diagnostics);
}

}  // namespace weir::graph
