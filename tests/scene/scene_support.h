// What the tests of framework/scene share: small glTF files written on the spot, and where the large ones lie.
#pragma once

#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/scene/import.h>
#include <weir/scene/prepared.h>

#include <unistd.h>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace weir::scene::test {

namespace fs = std::filesystem;
using nlohmann::json;

/// A folder of its own for a test, removed at the end.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (fs::temp_directory_path() / "weir-scene-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  std::string write(const std::string& name, const std::string& bytes) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return (path_ / name).string();
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Assembles a glTF with one embedded buffer.
struct GltfText {
  json j = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", {{{"mesh", 0}}}}};
  std::string binary;

  template <class T>
  int view(const std::vector<T>& data) {
    while (binary.size() % 4) binary += '\0';
    j["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", data.size() * sizeof(T)}});
    binary.append(reinterpret_cast<const char*>(data.data()), data.size() * sizeof(T));
    return static_cast<int>(j["bufferViews"].size()) - 1;
  }
  template <class T>
  int accessor(const std::vector<T>& data, int componentType, const std::string& type, size_t count) {
    j["accessors"].push_back(
        {{"bufferView", view(data)}, {"componentType", componentType}, {"count", count}, {"type", type}});
    return static_cast<int>(j["accessors"].size()) - 1;
  }
  int vec3(const std::vector<float>& data) { return accessor(data, 5126, "VEC3", data.size() / 3); }

  /// A right triangle in the XY plane that faces +Z, indexed with 16 bits: accessors 0 and 1.
  static GltfText triangle() {
    GltfText g;
    g.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
    g.accessor<uint16_t>({0, 1, 2}, 5123, "SCALAR", 3);
    g.j["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
    return g;
  }

  static std::string base64(const std::string& bytes) {
    static const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
      uint32_t v = 0;
      for (size_t k = 0; k < 3; ++k) v = (v << 8) | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
      for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? alphabet[(v >> (18 - 6 * k)) & 63] : '=';
    }
    return out;
  }

  /// The file with its buffer inside; `j["buffers"]` is left alone when it is there already.
  std::string text() const {
    json out = j;
    if (!out.contains("buffers") && !binary.empty())
      out["buffers"] = {
          {{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}}};
    return out.dump();
  }
  /// The same as a GLB.
  std::string glb() const {
    json out = j;
    out["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = out.dump(), data = binary;
    text.append((4 - text.size() % 4) % 4, ' ');
    data.append((4 - data.size() % 4) % 4, '\0');
    const auto u32 = [](size_t v) { return std::string{char(v), char(v >> 8), char(v >> 16), char(v >> 24)}; };
    return "glTF" + u32(2) + u32(28 + text.size() + data.size()) + u32(text.size()) + "JSON" + text + u32(data.size()) +
           std::string("BIN\0", 4) + data;
  }
};

inline Scene load(const std::string& text, const ImportLimits& limits = {}) {
  const TempFolder folder;
  return importGltf(folder.write("test.gltf", text), limits);
}

/// The message of the InputError that loading must end in; a failure when it does not.
inline std::string refusal(const std::string& text, const ImportLimits& limits = {}) {
  try {
    load(text, limits);
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "was accepted: " << text.substr(0, 300);
  return {};
}

/// Folder of the large scenes; empty, and says so loudly, when this machine has none.
inline std::string sceneFolder() {
  const char* given = std::getenv("WEIR_SCENES");
  const std::string folder = given ? given : WEIR_SOURCE_DIR "/../shared/scenes";
  if (fs::exists(folder)) return folder;
  std::cerr << "\n*** NO SCENES AT " << folder
            << ": THE TESTS ON LARGE AND MALFORMED SCENES ARE SKIPPED. SET WEIR_SCENES. ***\n\n";
  return {};
}

}  // namespace weir::scene::test
