// A graph as its JSON says it, with the line of everything; not yet checked against any pass.
#pragma once

#include <weir/graph/diagnostic.h>
#include <weir/pass/description.h>

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace weir::graph {

/// A JSON scalar as it was written; numbers keep whether they were whole.
using RawValue = std::variant<std::nullptr_t, bool, int64_t, double, std::string>;
std::string toText(const RawValue& value);

struct ParamEntry {
  std::string name;
  RawValue value;
  int line = 0;        ///< of the value
  int nameLine = 0;    ///< of the key
  std::string origin;  ///< empty: the file; else "--set"
  std::string text;    ///< from --set: the value as written, for texts that look like numbers
};

/// "pass.port" or "pass.port@previous".
struct Reference {
  std::string pass, port;
  bool previous = false;
};
std::optional<Reference> parseReference(const std::string& text);

struct InputEntry {
  std::string port;
  std::string text;  ///< as written
  std::optional<Reference> source;
  int line = 0;      ///< of the reference
  int nameLine = 0;  ///< of the port
};

struct PassEntry {
  std::string name, type;
  bool enabled = true;
  std::vector<InputEntry> inputs;
  std::vector<ParamEntry> params;
  int line = 0, typeLine = 0, enabledLine = 0;
  bool inputsBroken = false;  ///< "inputs" could not be read: what is missing there has been said
  std::string enabledOrigin;  ///< who said `enabled`; empty: the file; else "--enable" or "--disable"
};

struct OutputEntry {
  std::string name;
  std::string text;
  std::optional<Reference> source;
  int line = 0;
};

/// More passes than this are refused. Sharing memory takes time and space by their square: at this many a second.
inline constexpr size_t kMostPasses = 4096;

struct Description {
  std::string file, name;
  bool broken = false;            ///< no JSON, or without passes: further checks would only make noise
  std::vector<PassEntry> passes;  ///< in the file's order, which means nothing
  std::vector<OutputEntry> outputs;
  PassEntry* find(const std::string& pass);
  const PassEntry* find(const std::string& pass) const;
};

/// Parses JSON. Structural findings (bad JSON, wrong kinds, unknown and repeated keys, malformed references) are
/// appended to `diagnostics`; what could be read is returned, so that later checks can report too.
Description parse(const std::string& json, const std::string& file, std::vector<Diagnostic>& diagnostics);
/// Reads the file first; InputError when it can't be read.
Description load(const std::string& path, std::vector<Diagnostic>& diagnostics);

/// What the command line changes.
struct Overrides {
  std::vector<std::string> set;  ///< "pass.param=value"
  std::vector<std::string> enable, disable;
};
/// Applies them; unknown passes and malformed texts become diagnostics.
void apply(Description& description, const Overrides& overrides, std::vector<Diagnostic>& diagnostics);

}  // namespace weir::graph
