// Small valid files with faults put in at random, from fixed seeds: each must become a scene or an InputError.
#include <random>

#include "compressed_files.h"

namespace weir::scene::test {
namespace {

using Random = std::mt19937;

size_t below(Random& random, size_t n) {
  return static_cast<size_t>(random()) % n;
}

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Bits turned, bytes overwritten, pieces cut out, copied elsewhere, or everything behind a place cut off.
std::string mutateBytes(std::string bytes, Random& random) {
  for (size_t n = 1 + below(random, 4); n-- > 0 && !bytes.empty();) {
    const size_t at = below(random, bytes.size()), length = 1 + below(random, std::min<size_t>(64, bytes.size() - at));
    switch (below(random, 8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(below(random, bytes.size()), bytes.substr(at, length));
        break;
      case 3:
        bytes.replace(at, length, std::string(length, static_cast<char>(random() % 2 ? 0xff : 0x00)));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
    }
  }
  return bytes;
}

void collect(json& value, std::vector<json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (auto& child : value) collect(child, all);
}

/// Values swapped, copied, dropped, or replaced by ones that no file should hold.
void mutateJson(json& root, Random& random) {
  static const json strange[] = {-1,    0,       1,    3.5, 255, 65536,         2147483647,     4294967296ull, 1e300,
                                 -1e38, nullptr, true, "",  "x", json::array(), json::object(), {0, 0, 0}};
  for (size_t n = 1 + below(random, 3); n-- > 0;) {
    std::vector<json*> all;
    collect(root, all);
    json& at = *all[1 + below(random, all.size() - 1)];
    switch (below(random, 4)) {
      case 0: {
        const json other = *all[1 + below(random, all.size() - 1)];
        at = other;
        break;
      }
      case 1:
        if (at.is_object() && !at.empty())
          at.erase(std::next(at.begin(), static_cast<ptrdiff_t>(below(random, at.size()))));
        else if (at.is_array() && !at.empty())
          at.erase(below(random, at.size()));
        break;
      case 2:
        if (at.is_number_integer())
          at = at.get<int64_t>() + static_cast<int64_t>(below(random, 5)) - 2;
        else if (at.is_array() && !at.empty())
          at.push_back(at[below(random, at.size())]);
        break;
      default:
        at = strange[below(random, std::size(strange))];
    }
  }
}

/// JSON text and the rest of a GLB.
std::pair<json, std::string> split(const std::string& glb) {
  uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  const size_t rest = 20 + size_t{length};
  return {json::parse(glb.substr(20, length)), rest + 8 <= glb.size() ? glb.substr(rest + 8) : std::string()};
}

std::string assemble(const json& j, const std::string& binary) {
  std::string text = j.dump(-1, ' ', true, json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');
  const auto u32 = [](size_t v) { return std::string{char(v), char(v >> 8), char(v >> 16), char(v >> 24)}; };
  return "glTF" + u32(2) + u32(28 + text.size() + binary.size()) + u32(text.size()) + "JSON" + text +
         u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

struct Outcome {
  int scenes = 0, refused = 0;
};

/// Anything but a sound scene or an InputError is a failure; a crash leaves its file in the temporary folder.
void tryFile(const TempFolder& folder, const std::string& bytes, Outcome& outcome) {
  const std::string path = folder.write("mutant.glb", bytes);
  try {
    const Scene scene = importGltf(path);
    const PreparedScene p = prepareScene(scene);
    for (const PackedTriangle& t : p.triangles)
      for (uint32_t v : t.v) ASSERT_LT(v, p.positions.size());
    for (const GpuLight& light : p.lights) ASSERT_TRUE(light.pdf >= 0.0f && light.pdf <= 1.0f);
    ++outcome.scenes;
  } catch (const InputError& e) {
    ASSERT_NE(std::string(e.what()), "");
    ++outcome.refused;
  }
}

/// A mesh with strided, normalised and sparse attributes, lights, cameras and a tree of nodes.
std::string everything() {
  const Grid grid(4);
  GltfText g;
  const int p = g.vec3(grid.positions), n = g.vec3(grid.normals), uv = g.accessor(grid.uvs, 5126, "VEC2", 25),
            i = g.accessor(grid.indices, 5125, "SCALAR", grid.indices.size());
  const int at = g.view<uint8_t>({3, 7, 20}), values = g.view<float>({1, 2, 3, 4, 5, 6, 7, 8, 9});
  g.j["accessors"][p]["sparse"] = {
      {"count", 3}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}};
  const int bytes = g.view(std::vector<uint8_t>(25 * 4, 127));
  g.j["bufferViews"][bytes]["byteStride"] = 4;
  g.j["accessors"].push_back(
      {{"bufferView", bytes}, {"componentType", 5120}, {"count", 25}, {"type", "VEC3"}, {"normalized", true}});
  const json quantised = {{"attributes", {{"POSITION", p}, {"NORMAL", 4}}}, {"indices", i}, {"mode", 5}};
  g.j["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", uv}}}, {"indices", i}, {"material", 0}},
         quantised}}}};
  g.j["materials"] = {{{"emissiveFactor", {1, 1, 0}}, {"doubleSided", true}, {"alphaMode", "MASK"}}};
  g.j["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
  g.j["extensionsUsed"] = {"KHR_lights_punctual", "KHR_mesh_quantization"};
  g.j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}},
                                                        {{"type", "directional"}}};
  g.j["nodes"] = {
      {{"mesh", 0}, {"children", {1, 2}}, {"scale", {1, -2, 3}}},
      {{"camera", 0}, {"translation", {0, 0, 9}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
      {{"mesh", 0},
       {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 5, 5, 1}},
       {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
  return g.glb();
}

/// The meshopt file as a GLB: its first buffer becomes the binary chunk.
std::string meshoptGlb() {
  GltfText g = meshoptFile(Grid(4));
  g.j["buffers"][0].erase("uri");
  g.binary.append((4 - g.binary.size() % 4) % 4, '\0');
  return assemble(g.j, g.binary);
}

std::vector<std::pair<std::string, std::string>> seeds() {
  return {{"triangle", GltfText::triangle().glb()},
          {"everything", everything()},
          {"draco", dracoFile(Grid(4)).glb()},
          {"draco sequential", dracoFile(Grid(4), true).glb()},
          {"meshopt", meshoptGlb()},
          {"cornell", readFile(WEIR_SOURCE_DIR "/scenes/cornell.glb")},
          {"alpha-mask", readFile(WEIR_SOURCE_DIR "/scenes/alpha-mask.glb")},
          {"cornell-moving", readFile(WEIR_SOURCE_DIR "/scenes/cornell-moving.glb")}};
}

TEST(Fuzz, SeedsAreValid) {
  const TempFolder folder;
  for (const auto& [name, bytes] : seeds()) EXPECT_NO_THROW(importGltf(folder.write("seed.glb", bytes))) << name;
}

TEST(Fuzz, BrokenBytes) {
  const TempFolder folder;
  for (const auto& [name, bytes] : seeds()) {
    SCOPED_TRACE(name);
    Random random(1);
    Outcome outcome;
    for (int i = 0; i < 400; ++i) tryFile(folder, mutateBytes(bytes, random), outcome);
    EXPECT_GT(outcome.refused, 0);
  }
}

// The container stays whole, so that faults get past it.
TEST(Fuzz, BrokenJson) {
  const TempFolder folder;
  for (const auto& [name, bytes] : seeds()) {
    SCOPED_TRACE(name);
    const auto [whole, binary] = split(bytes);
    Random random(2);
    Outcome outcome;
    for (int i = 0; i < 600; ++i) {
      json j = whole;
      mutateJson(j, random);
      tryFile(folder, assemble(j, binary), outcome);
    }
    EXPECT_GT(outcome.refused, 0);
    EXPECT_GT(outcome.scenes, 0);
  }
}

// Only what the JSON points at: vertex data, images, compressed streams.
TEST(Fuzz, BrokenData) {
  const TempFolder folder;
  for (const auto& [name, bytes] : seeds()) {
    SCOPED_TRACE(name);
    const auto [whole, binary] = split(bytes);
    const size_t start = bytes.size() - binary.size();
    Random random(3);
    Outcome outcome;
    for (int i = 0; i < 600; ++i) {
      std::string mutant = mutateBytes(binary, random);
      mutant.resize(binary.size());
      tryFile(folder, bytes.substr(0, start) + mutant, outcome);
    }
    EXPECT_GT(outcome.scenes + outcome.refused, 0);
  }
}

}  // namespace
}  // namespace weir::scene::test
