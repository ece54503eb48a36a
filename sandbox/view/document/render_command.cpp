#include "view/document/render_command.h"

#include "view/document/camera_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace weir::view {
namespace {

using graph::Description;
using graph::ParamEntry;
using graph::PassEntry;

/// Options that turn the saved graph into the edited one, or why none can.
struct Edits {
  std::vector<std::pair<std::string, std::string>> options;
  std::string unsayable;
};

class Differ {
 public:
  Differ(const Description& saved, const Description& edited, const graph::PassCatalog& catalog)
      : saved_(saved), edited_(edited), catalog_(catalog) {}

  Edits edits() {
    if (wiring(saved_) != wiring(edited_)) return unsayable("passes, their types or what they read have changed");
    for (const PassEntry& pass : edited_.passes) {
      const PassEntry& was = *saved_.find(pass.name);
      if (pass.enabled != was.enabled) edits_.options.emplace_back(pass.enabled ? "--enable" : "--disable", pass.name);
      for (const ParamEntry& param : pass.params) {
        const ParamEntry* before = find(was, param.name);
        if (!before || before->value != param.value) set(pass, param.name, graph::toText(param.value));
      }
      for (const ParamEntry& param : was.params)
        if (!find(pass, param.name)) reset(pass, param.name);
    }
    return std::move(edits_);
  }

 private:
  using Wiring = std::map<std::string, std::string>;

  static Wiring wiring(const Description& description) {
    Wiring all;
    for (const PassEntry& pass : description.passes) {
      all[pass.name] = pass.type;
      for (const graph::InputEntry& input : pass.inputs) all[pass.name + "." + input.port] = input.text;
    }
    for (const graph::OutputEntry& output : description.outputs) all["=" + output.name] = output.text;
    return all;
  }

  static const ParamEntry* find(const PassEntry& pass, const std::string& name) {
    for (const ParamEntry& param : pass.params)
      if (param.name == name) return &param;
    return nullptr;
  }

  Edits unsayable(const std::string& why) {
    edits_.unsayable = why;
    return std::move(edits_);
  }

  void set(const PassEntry& pass, const std::string& param, const std::string& value) {
    if (value.find('\0') != std::string::npos)
      edits_.unsayable = fmt::format("{}.{} has a character that no command line can have", pass.name, param);
    edits_.options.emplace_back("--set", fmt::format("{}.{}={}", pass.name, param, value));
  }

  void reset(const PassEntry& pass, const std::string& param) {
    const PassDescription* type = catalog_.find(pass.type);
    const ParamDescription* description = type ? type->findParam(param) : nullptr;
    if (description)
      set(pass, param, toText(description->defaultValue));
    else
      edits_.unsayable = fmt::format("{}.{} has been taken out", pass.name, param);
  }

  const Description &saved_, &edited_;
  const graph::PassCatalog& catalog_;
  Edits edits_;
};

class Words {
 public:
  explicit Words(const std::string& program) : text_(program) {}

  void word(const std::string& word) { (text_ += ' ') += shellQuoted(word); }
  void option(const char* name, const std::string& value) {
    // A value that looks like an option itself has to be tied to its own.
    if (value.starts_with('-'))
      word(fmt::format("{}={}", name, value));
    else
      word(name), word(value);
  }
  template <typename Number>
  void number(const char* name, Number value, Number standard) {
    if (value != standard) option(name, fmt::format("{}", value));
  }
  void text(const char* name, const std::string& value, const std::string& standard = "") {
    if (value != standard) option(name, value);
  }
  void flag(const char* name, bool on) {
    if (on) word(name);
  }
  const std::string& line() const { return text_; }

 private:
  std::string text_;
};

void addStage(Words& words, const render::StageOptions& stage, const std::string& camera) {
  const render::StageOptions standard;
  words.number("--lights", stage.lights, standard.lights);
  if (stage.lights > 0) words.number("--light-seed", stage.lightSeed, standard.lightSeed);
  words.flag("--replace-lights", stage.replaceLights);
  words.text("--environment", stage.environment);
  words.number("--environment-scale", stage.environmentScale, standard.environmentScale);
  words.number("--environment-rotation", stage.environmentRotation, standard.environmentRotation);
  words.text("--camera", camera);
  words.flag("--energy-compensation", stage.energyCompensation);
  if (!stage.animate) return;
  words.flag("--animate", true);
  words.text("--clip", stage.clip);
  words.number("--time", stage.time, standard.time);
  words.number("--time-step", stage.timeStep, standard.timeStep);
}

void addFrames(Words& words, const render::RenderOptions& view) {
  const render::RenderOptions standard;
  words.option("--size", fmt::format("{}x{}", view.width, view.height));
  words.number("--frames", view.frames, standard.frames);
  words.number("--average", view.average, standard.average);
  words.number("--restarts", view.restarts, standard.restarts);
  words.number("--first-frame", view.firstFrame, standard.firstFrame);
  words.number("--seed", view.seed, standard.seed);
  if (view.exposure) words.option("--exposure", fmt::format("{}", *view.exposure));
  words.text("--trace", view.trace, standard.trace);
  words.text("--device", view.device);
  words.flag("--validate", view.validation);
  words.text("--stats", view.statistics);
  for (const std::string& folder : view.pluginPaths) words.option("--plugin-path", folder);
  for (const auto& [output, file] : view.outputs) words.option("--out", output + "=" + file);
  for (const auto& [output, file] : view.errors) words.option("--stderr", output + "=" + file);
}

}  // namespace

std::string shellQuoted(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=@%+";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'')
      text += "'\\''";
    else
      text += c;
  }
  return text + "'";
}

RenderCommand renderCommand(const Document& document, const graph::PassCatalog& catalog,
                            const render::RenderOptions& view, const std::optional<scene::Camera>& camera,
                            const std::optional<std::string>& graphFile) {
  RenderCommand command;
  Words words("weir render");
  const std::string& file = graphFile ? *graphFile : document.file();
  words.word(file.starts_with('-') ? "./" + file : file);
  if (!graphFile) {
    std::vector<graph::Diagnostic> unused;
    const Description saved = graph::parse(document.savedText(), document.file(), unused);
    const Edits edits = Differ(saved, document.description(), catalog).edits();
    command.saveFirst = edits.unsayable;
    if (document.fileDiffers()) command.saveFirst = fmt::format("{} is not as it was read", document.file());
    if (command.saveFirst.empty())
      for (const auto& [option, value] : edits.options) words.option(option.c_str(), value);
  }
  words.option("--scene", view.stage.scene);
  std::string place = view.stage.camera;
  if (camera) {
    const CameraWords said = cameraWords(*camera);
    place = said.text;
    if (!said.level) command.unsaid.emplace_back("the camera's roll about its axis");
  }
  addStage(words, view.stage, place);
  addFrames(words, view);
  command.text = words.line();
  return command;
}

}  // namespace weir::view
