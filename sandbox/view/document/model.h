// The document as panels show it: passes in the order in which they run, with everything that their types say of
// parameters and ports. Plain data, built once for each change.
#pragma once

#include "view/document/document.h"
#include "view/document/swap.h"

#include <weir/graph/compile.h>

#include <cstddef>
#include <string>
#include <vector>

namespace weir::view {

/// Something that is wrong, and where: empty names stand for the graph as a whole.
struct Problem {
  std::string pass;
  std::string place;    ///< within the pass: "params.radius", "inputs.light", "type", "enabled"
  std::string text;     ///< complete, with its place
  std::string message;  ///< without it, for where the place is plain; empty: the same
};
/// With the pass from each finding's path.
std::vector<Problem> problemsOf(const std::vector<graph::Diagnostic>& diagnostics);

struct ParamModel {
  ParamDescription description;
  ParamValue value;      ///< as written, or the default where nothing fitting is
  bool changed = false;  ///< is not the default
  bool written = false;  ///< stands in the document
  std::string tooltip;   ///< doc, range, default, what a change costs
  std::vector<std::string> problems;
};

struct PortModel {
  std::string name, type, doc;  ///< type in words, "Reservoir, 2 a pixel"
  bool required = false;        ///< inputs
  /// Inputs: "pass.port" that is read, "" when open. Outputs: the port itself, in the same form.
  std::string port;
  bool previous = false;             ///< inputs: last frame's
  std::vector<std::string> readers;  ///< outputs: "pass.input", "output color"
  std::vector<std::string> problems;
};

struct PassModel {
  std::string name, type, doc;
  bool known = true;    ///< there is such a type; else it has no parameters and ports
  bool enabled = true;  ///< as written
  bool runs = false;
  std::string reason;   ///< why it does not
  std::string mustRun;  ///< why it can't be disabled; empty when it can
  std::vector<ParamModel> params;
  std::vector<PortModel> inputs, outputs;
  std::vector<std::string> problems;  ///< of the pass itself, its type, and things that there are none of
  size_t changed = 0;                 ///< parameters that are not at their default
};

/// From an output to an input, indices into the passes and their ports.
struct EdgeModel {
  size_t from = 0, output = 0, to = 0, input = 0;
  bool previous = false;
};

struct GraphModel {
  std::string name, file;
  bool changed = false;
  std::string undoes, redoes;  ///< what undo and redo would do; empty: nothing
  /// In the order in which they run; those that don't lie behind what they read.
  std::vector<PassModel> passes;
  std::vector<EdgeModel> edges;
  std::vector<Problem> problems;  ///< all of them
  std::string choicesOf;          ///< the pass that `choices` are for; empty: nobody asked
  std::vector<TypeChoice> choices;

  const PassModel* find(const std::string& pass) const;
};

struct ModelInput {
  const Document& document;
  const SwapContext& context;
  const graph::CompiledGraph* running = nullptr;  ///< the last that could be compiled
  std::vector<Problem> problems;                  ///< of the last try; any: what runs is not what the document says
  std::string choicesOf;                          ///< a pass whose choices of type are wanted, or empty
};
GraphModel buildModel(const ModelInput& input);

}  // namespace weir::view
