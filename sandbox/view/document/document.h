// The graph that is being edited: a graph file's text, and edits that change only what they are about. Order, spaces,
// "$schema" and whatever else stands in the file stay as they are, so that what is saved differs from what was loaded
// by the edits alone. Knows no passes: whether the graph makes sense is graph::compile's to say.
#pragma once

#include <weir/graph/description.h>
#include <weir/pass/description.h>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace weir::view {

/// What a pass of one type said that the type after it has no place for.
struct Remembered {
  std::map<std::string, std::string> params, inputs;  ///< JSON values by name
  std::string before, after;                          ///< the whole pass as JSON, and what became of it
};

class Document {
 public:
  /// InputError when the file can't be read, GraphError with places when it is no graph: bad JSON, unknown keys, values
  /// of the wrong kind, malformed references. So whatever is in a document is sound as far as that.
  static Document load(const std::string& path);
  /// `file` stands for it in messages, and is where it is saved.
  static Document fromText(std::string text, std::string file);

  const std::string& file() const { return file_; }
  const std::string& text() const { return text_; }        ///< what saving writes
  const std::string& savedText() const { return saved_; }  ///< what the file has, as far as we know
  /// What the text says; lines are those of the text.
  const graph::Description& description() const { return description_; }
  /// Since it was loaded or saved.
  bool changed() const { return text_ != saved_; }

  /// InputError or RuntimeError when it can't be written; the file has then what it had.
  void save();
  void saveAs(const std::string& path);
  /// Takes what the file has now as an edit that can be undone. Throws as load(); everything then stays as it was.
  void reread();
  /// Whether somebody else changed the file, or took it away, since it was loaded or saved.
  bool fileDiffers() const;

  // Edits. InputError for a pass that there is none of; GraphError when the result would be no graph; nothing has
  // changed then. Each is a step of undo, unless it changes nothing.

  /// `continues`: goes on with the last step if that was about the same parameter, as while a slider is dragged.
  void setParam(const std::string& pass, const std::string& param, const ParamValue& value, bool continues = false);
  /// The same with the value as JSON.
  void setParamText(const std::string& pass, const std::string& param, const std::string& json, bool continues = false);
  /// Removes it, so that the default holds.
  void resetParam(const std::string& pass, const std::string& param);
  void setEnabled(const std::string& pass, bool enabled);
  /// "pass.port" or "pass.port@previous"; nothing: unconnected.
  void setInput(const std::string& pass, const std::string& port, const std::optional<std::string>& reference);
  void setOutput(const std::string& output, const std::optional<std::string>& reference);
  /// Only the word: what else must change with it is planSwap()'s to say.
  void setType(const std::string& pass, const std::string& type);
  /// InputError when there is such a pass.
  void addPass(const std::string& pass, const std::string& type);
  /// What read it reads nothing that exists then, which compiling reports.
  void removePass(const std::string& pass);
  /// Any other text as one step; `what` names it to the user.
  void replace(std::string text, const std::string& what);

  bool canUndo() const { return !undo_.empty(); }
  bool canRedo() const { return !redo_.empty(); }
  const std::string& undoes() const;  ///< what the next undo takes back, in words; empty when there is nothing
  const std::string& redoes() const;
  void undo();
  void redo();

  /// What a pass said while it was of that type; nullptr when nothing was left out. Undo does not touch it.
  const Remembered* remembered(const std::string& pass, const std::string& type) const;
  void remember(const std::string& pass, const std::string& type, Remembered what);

 private:
  struct Step {
    std::string text;  ///< on the other side of the step
    std::string what;
    std::string about;  ///< edits of the same thing may share a step
  };
  void edit(std::string text, std::string what, std::string about = "", bool continues = false);
  void requirePass(const std::string& pass) const;
  std::string spelling(const std::string& pass, const std::string& param, const ParamValue& value) const;
  void adopt(std::string text);
  void push(Step step);

  std::string file_, text_, saved_;
  graph::Description description_;
  std::vector<Step> undo_, redo_;
  std::map<std::pair<std::string, std::string>, Remembered> remembered_;
};

}  // namespace weir::view
