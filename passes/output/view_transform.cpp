#include "output/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <weir/core/error.h>
#include <weir/core/text.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "output/shader_text.h"

namespace weir::passes {
namespace {

namespace fs = std::filesystem;
namespace ocio = OCIO_NAMESPACE;

constexpr const char* kBuiltIn = "weir";
/// What configs call linear Rec.709 (which is linear sRGB): OpenColorIO's own, ACES 1.0 and 1.2, and Blender's.
constexpr const char* kLinearRec709[] = {
    "Linear Rec.709 (sRGB)",      "Linear Rec.709",         "lin_rec709", "lin_srgb", "Linear - Rec.709", "Linear sRGB",
    "Utility - Linear - Rec.709", "Utility - Linear - sRGB"};

struct Opened {
  ocio::ConstConfigRcPtr config;
  std::string name;  ///< for messages
};

/// `origin`: who named the file, for messages.
fs::path find(const std::string& origin, const std::string& file, const std::string& folder) {
  std::error_code error;
  if (fs::is_regular_file(file, error)) return file;
  fs::path beside = fs::path(folder) / file;
  if (!folder.empty() && fs::is_regular_file(beside, error)) return beside;
  std::string places = fs::absolute(file, error).string();
  if (!folder.empty() && fs::path(file).is_relative()) places += " or " + beside.string();
  throw InputError(fmt::format("{}: no file {}; \"{}\" is the built-in config", origin, places, kBuiltIn));
}

Opened open(const ViewChoice& choice) {
  std::string file = choice.config;
  std::string origin = "config";
  if (file.empty()) {
    if (const char* variable = std::getenv("OCIO"); variable != nullptr && *variable != '\0') {
      file = variable;
      origin = "config from $OCIO";
    }
  }
  if (file.empty() || file == kBuiltIn) {
    std::istringstream text(builtInConfig());
    return {ocio::Config::CreateFromStream(text), fmt::format("config {}", kBuiltIn)};
  }
  const std::string path = find(origin, file, choice.folder).string();
  try {
    return {ocio::Config::CreateFromFile(path.c_str()), fmt::format("config {}", path)};
  } catch (const ocio::Exception& e) {
    throw InputError(fmt::format("{}: OpenColorIO can't read {}: {}", origin, path, e.what()));
  }
}

/// `given`, or `standard` when it is empty; must be one of `choices`.
std::string choose(const char* param, const std::string& where, const std::string& given, const char* standard,
                   const std::vector<std::string>& choices) {
  const std::string name = given.empty() ? standard : given;
  // OpenColorIO ignores case in these names.
  for (const std::string& choice : choices) {
    if (editDistance(choice, name) == 0) return choice;
  }
  const std::string nearest = nearestName(name, choices);
  throw InputError(fmt::format("{}: \"{}\" is not in {}; there are: {}{}", param, name, where, fmt::join(choices, ", "),
                               nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest)));
}

std::string chooseDisplay(const Opened& from, const std::string& given) {
  std::vector<std::string> choices;
  for (int i = 0; i < from.config->getNumDisplays(); ++i) choices.push_back(from.config->getDisplay(i));
  return choose("display", from.name, given, from.config->getDefaultDisplay(), choices);
}

std::string chooseView(const Opened& from, const std::string& display, const std::string& given) {
  std::vector<std::string> choices;
  const int count = from.config->getNumViews(display.c_str());
  for (int i = 0; i < count; ++i) choices.push_back(from.config->getView(display.c_str(), i));
  return choose("view", fmt::format("display {} of {}", display, from.name), given,
                from.config->getDefaultView(display.c_str()), choices);
}

/// Whether the view shows its input as it is.
bool isRaw(const ocio::Config& config, const std::string& display, const std::string& view) {
  const auto space = config.getColorSpace(config.getDisplayViewColorSpaceName(display.c_str(), view.c_str()));
  return space && space->isData();
}

/// The colour space in which the picture enters the config; appends to `before` how it gets into it.
std::string enter(const Opened& from, const std::string& given, ocio::GroupTransform& before) {
  const ocio::Config& config = *from.config;
  if (!given.empty()) {
    if (config.getColorSpace(given.c_str())) return given;
    std::vector<std::string> choices;
    for (int i = 0; i < config.getNumColorSpaces(); ++i) choices.push_back(config.getColorSpaceNameByIndex(i));
    for (int i = 0; i < config.getNumRoles(); ++i) choices.push_back(config.getRoleName(i));
    return choose("space", from.name, given, "", choices);
  }
  if (config.hasRole(ocio::ROLE_INTERCHANGE_SCENE)) {
    const auto toAp1 = ocio::BuiltinTransform::Create();
    toAp1->setStyle("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD");
    toAp1->setDirection(ocio::TRANSFORM_DIR_INVERSE);
    const auto toAp0 = ocio::BuiltinTransform::Create();
    toAp0->setStyle("ACEScg_to_ACES2065-1");
    before.appendTransform(toAp1);
    before.appendTransform(toAp0);
    return ocio::ROLE_INTERCHANGE_SCENE;
  }
  for (const char* name : kLinearRec709) {
    if (config.getColorSpace(name)) return name;
  }
  if (config.hasRole(ocio::ROLE_SCENE_LINEAR)) return ocio::ROLE_SCENE_LINEAR;
  throw InputError(fmt::format(
      "space: {} says neither what linear Rec.709 nor what scene_linear is; name one of its spaces", from.name));
}

}  // namespace

ViewTransform makeViewTransform(const ViewChoice& choice) {
  // Everything that it would write is thrown, too.
  ocio::SetLoggingLevel(ocio::LOGGING_LEVEL_NONE);
  const Opened from = open(choice);
  try {
    const std::string display = chooseDisplay(from, choice.display);
    const std::string view = chooseView(from, display, choice.view);
    const auto transform = ocio::GroupTransform::Create();
    const bool raw = isRaw(*from.config, display, view);
    // A raw view has no use for the space; a wrong name is wrong all the same.
    const std::string space = raw && choice.space.empty() ? "" : enter(from, choice.space, *transform);
    if (!raw) {
      const auto shown = ocio::DisplayViewTransform::Create();
      shown->setSrc(space.c_str());
      shown->setDisplay(display.c_str());
      shown->setView(view.c_str());
      transform->appendTransform(shown);
    }
    const auto processor = from.config->getProcessor(transform);
    return shaderText(*processor, from.name);
  } catch (const ocio::Exception& e) {
    throw InputError(fmt::format("{}: {}", from.name, e.what()));
  }
}

}  // namespace weir::passes
