// Reads a plugin's manifest; the only file in this room that knows JSON.
#include <weir/core/error.h>
#include <weir/pass/plugin_loader.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace weir {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

[[noreturn]] void fail(const fs::path& file, const std::string& text) {
  throw InputError(fmt::format("{}: {}", file.string(), text));
}

Json parse(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "the plugin manifest can't be read");
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    fail(file, fmt::format("the plugin manifest is not valid JSON: {}", error.what()));
  }
}

const Json& member(const Json& json, const char* key, const fs::path& file) {
  const auto found = json.find(key);
  if (found == json.end()) fail(file, fmt::format("the plugin manifest has no '{}'", key));
  return *found;
}

std::string text(const Json& json, const char* key, const fs::path& file) {
  const Json& value = member(json, key, file);
  if (!value.is_string() || value.get_ref<const std::string&>().empty())
    fail(file, fmt::format("'{}' in the plugin manifest must be a text that is not empty", key));
  return value.get<std::string>();
}

}  // namespace

PluginManifest readManifest(const fs::path& file) {
  const Json json = parse(file);
  if (!json.is_object()) fail(file, "the plugin manifest must be a JSON object");
  PluginManifest manifest;
  manifest.file = file;
  manifest.name = text(json, "name", file);
  if (manifest.name.find_first_of("./") != std::string::npos)
    fail(file, fmt::format("the plugin name '{}' must not contain '.' or '/'", manifest.name));
  // operator/ keeps an absolute right side, so a manifest may point anywhere.
  manifest.library = file.parent_path() / text(json, "library", file);
  manifest.buildTag = text(json, "buildTag", file);
  const Json& abi = member(json, "abi", file);
  if (!abi.is_number_unsigned() || abi.get<uint64_t>() > UINT32_MAX)
    fail(file, "'abi' in the plugin manifest must be a whole number");
  manifest.abi = abi.get<uint32_t>();
  if (json.contains("shaders")) manifest.shaders = file.parent_path() / text(json, "shaders", file);
  return manifest;
}

}  // namespace weir
