// The part of glTF 2.0's JSON schema that decides whether the importer can trust a file's structure.
// One table, so that what is checked can be read beside the specification (appendix "JSON Schema Reference").
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/scene/gltf_file.h>

#include <cmath>
#include <limits>

namespace weir::scene {
namespace {

using nlohmann::json;

enum class Kind {
  Index,
  Indices,
  IndexMap,
  IndexMaps,
  Integer,
  Integers,
  Number,
  Numbers,
  String,
  Strings,
  Bool,
  Object,
  Objects
};

struct Rule {
  const char* key;
  Kind kind;
  bool required = false;
  const char* target = nullptr;  // Index...: the array it points into
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  size_t length = 0;                         // Numbers: how many; 0: any
  const std::vector<Rule>* inner = nullptr;  // Object...
};

constexpr double kMaxInt = 2147483647.0;
constexpr double kMaxSize = 9007199254740992.0;  // 2^53: sums of two stay exact in 64 bits

Rule index(const char* key, const char* target, bool required = false) {
  return {key, Kind::Index, required, target};
}
Rule integer(const char* key, double low, double high, bool required = false) {
  return {key, Kind::Integer, required, nullptr, low, high};
}
Rule number(const char* key, bool required = false) {
  return {key, Kind::Number, required};
}
Rule numbers(const char* key, size_t length) {
  return {.key = key, .kind = Kind::Numbers, .length = length};
}
Rule text(const char* key, bool required = false) {
  return {key, Kind::String, required};
}
Rule object(const char* key, const std::vector<Rule>& inner, bool required = false) {
  return {.key = key, .kind = Kind::Object, .required = required, .inner = &inner};
}
Rule objects(const char* key, const std::vector<Rule>& inner, bool required = false) {
  return {.key = key, .kind = Kind::Objects, .required = required, .inner = &inner};
}

const std::vector<Rule>& rootRules() {
  static const std::vector<Rule> nothing;
  static const std::vector<Rule> sparseIndices = {index("bufferView", "bufferViews", true),
                                                  integer("byteOffset", 0, kMaxInt),
                                                  integer("componentType", 5121, 5125, true)};
  static const std::vector<Rule> sparseValues = {index("bufferView", "bufferViews", true),
                                                 integer("byteOffset", 0, kMaxInt)};
  static const std::vector<Rule> sparse = {integer("count", 1, kMaxInt, true), object("indices", sparseIndices, true),
                                           object("values", sparseValues, true)};
  static const std::vector<Rule> accessor = {index("bufferView", "bufferViews"),
                                             integer("byteOffset", 0, kMaxSize),
                                             integer("componentType", 5120, 5126, true),
                                             {"normalized", Kind::Bool},
                                             integer("count", 1, kMaxSize, true),
                                             text("type", true),
                                             numbers("min", 0),
                                             numbers("max", 0),
                                             object("sparse", sparse),
                                             text("name")};
  static const std::vector<Rule> buffer = {integer("byteLength", 1, kMaxSize, true), text("uri"), text("name")};
  static const std::vector<Rule> meshopt = {index("buffer", "buffers", true),
                                            integer("byteOffset", 0, kMaxSize),
                                            integer("byteLength", 1, kMaxSize, true),
                                            integer("byteStride", 1, 256, true),
                                            integer("count", 1, kMaxInt, true),
                                            text("mode", true),
                                            text("filter")};
  static const std::vector<Rule> viewExtensions = {object("EXT_meshopt_compression", meshopt)};
  static const std::vector<Rule> bufferView = {index("buffer", "buffers", true),
                                               integer("byteOffset", 0, kMaxSize),
                                               integer("byteLength", 1, kMaxSize, true),
                                               integer("byteStride", 4, 252),
                                               integer("target", 0, kMaxInt),
                                               object("extensions", viewExtensions),
                                               text("name")};
  static const std::vector<Rule> perspective = {number("yfov", true), number("znear", true), number("aspectRatio"),
                                                number("zfar")};
  static const std::vector<Rule> camera = {text("type", true), object("perspective", perspective),
                                           object("orthographic", nothing), text("name")};
  static const std::vector<Rule> image = {index("bufferView", "bufferViews"), text("uri"), text("mimeType"),
                                          text("name")};
  static const std::vector<Rule> textureTransform = {numbers("offset", 2), number("rotation"), numbers("scale", 2),
                                                     integer("texCoord", 0, kMaxInt)};
  static const std::vector<Rule> textureInfoExtensions = {object("KHR_texture_transform", textureTransform)};
  static const std::vector<Rule> textureInfo = {index("index", "textures", true), integer("texCoord", 0, kMaxInt),
                                                number("scale"), number("strength"),
                                                object("extensions", textureInfoExtensions)};
  static const std::vector<Rule> metallic = {numbers("baseColorFactor", 4), number("metallicFactor"),
                                             number("roughnessFactor"), object("baseColorTexture", textureInfo),
                                             object("metallicRoughnessTexture", textureInfo)};
  static const std::vector<Rule> strength = {number("emissiveStrength")};
  static const std::vector<Rule> glossiness = {numbers("diffuseFactor", 4), numbers("specularFactor", 3),
                                               number("glossinessFactor"), object("diffuseTexture", textureInfo),
                                               object("specularGlossinessTexture", textureInfo)};
  static const std::vector<Rule> ior = {number("ior")};
  static const std::vector<Rule> specular = {number("specularFactor"), numbers("specularColorFactor", 3),
                                             object("specularTexture", textureInfo),
                                             object("specularColorTexture", textureInfo)};
  static const std::vector<Rule> materialExtensions = {
      object("KHR_materials_emissive_strength", strength), object("KHR_materials_ior", ior),
      object("KHR_materials_pbrSpecularGlossiness", glossiness), object("KHR_materials_specular", specular),
      object("KHR_materials_unlit", nothing)};
  static const std::vector<Rule> material = {object("pbrMetallicRoughness", metallic),
                                             object("normalTexture", textureInfo),
                                             object("occlusionTexture", textureInfo),
                                             object("emissiveTexture", textureInfo),
                                             numbers("emissiveFactor", 3),
                                             text("alphaMode"),
                                             number("alphaCutoff"),
                                             {"doubleSided", Kind::Bool},
                                             object("extensions", materialExtensions),
                                             text("name")};
  static const std::vector<Rule> draco = {index("bufferView", "bufferViews", true),
                                          {"attributes", Kind::Integers, true, nullptr, 0, kMaxInt}};
  static const std::vector<Rule> primitiveExtensions = {object("KHR_draco_mesh_compression", draco)};
  static const std::vector<Rule> primitive = {{"attributes", Kind::IndexMap, true, "accessors"},
                                              index("indices", "accessors"),
                                              index("material", "materials"),
                                              integer("mode", 0, 6),
                                              {"targets", Kind::IndexMaps, false, "accessors"},
                                              object("extensions", primitiveExtensions)};
  static const std::vector<Rule> mesh = {objects("primitives", primitive, true), numbers("weights", 0), text("name")};
  static const std::vector<Rule> skin = {{"joints", Kind::Indices, true, "nodes"},
                                         index("inverseBindMatrices", "accessors"),
                                         index("skeleton", "nodes"),
                                         text("name")};
  static const std::vector<Rule> animationTarget = {index("node", "nodes"), text("path", true)};
  static const std::vector<Rule> channel = {integer("sampler", 0, kMaxInt, true),
                                            object("target", animationTarget, true)};
  static const std::vector<Rule> animationSampler = {index("input", "accessors", true),
                                                     index("output", "accessors", true), text("interpolation")};
  static const std::vector<Rule> animation = {objects("channels", channel, true),
                                              objects("samplers", animationSampler, true), text("name")};
  static const std::vector<Rule> nodeLight = {integer("light", 0, kMaxInt, true)};
  static const std::vector<Rule> nodeExtensions = {object("KHR_lights_punctual", nodeLight)};
  static const std::vector<Rule> node = {index("camera", "cameras"),
                                         {"children", Kind::Indices, false, "nodes"},
                                         index("mesh", "meshes"),
                                         index("skin", "skins"),
                                         numbers("matrix", 16),
                                         numbers("rotation", 4),
                                         numbers("scale", 3),
                                         numbers("translation", 3),
                                         numbers("weights", 0),
                                         object("extensions", nodeExtensions),
                                         text("name")};
  static const std::vector<Rule> sampler = {integer("magFilter", 0, kMaxInt), integer("minFilter", 0, kMaxInt),
                                            integer("wrapS", 0, kMaxInt), integer("wrapT", 0, kMaxInt), text("name")};
  static const std::vector<Rule> texture = {index("sampler", "samplers"), index("source", "images"),
                                            object("extensions", nothing), text("name")};
  static const std::vector<Rule> scene = {{"nodes", Kind::Indices, false, "nodes"}, text("name")};
  static const std::vector<Rule> asset = {text("version", true), text("minVersion")};
  static const std::vector<Rule> spot = {number("innerConeAngle"), number("outerConeAngle")};
  static const std::vector<Rule> light = {text("type", true), numbers("color", 3),  number("intensity"),
                                          number("range"),    object("spot", spot), text("name")};
  static const std::vector<Rule> lights = {objects("lights", light, true)};
  static const std::vector<Rule> rootExtensions = {object("KHR_lights_punctual", lights)};
  static const std::vector<Rule> root = {object("asset", asset, true),
                                         {"extensionsUsed", Kind::Strings},
                                         {"extensionsRequired", Kind::Strings},
                                         object("extensions", rootExtensions),
                                         index("scene", "scenes"),
                                         objects("accessors", accessor),
                                         objects("animations", animation),
                                         objects("buffers", buffer),
                                         objects("bufferViews", bufferView),
                                         objects("cameras", camera),
                                         objects("images", image),
                                         objects("materials", material),
                                         objects("meshes", mesh),
                                         objects("nodes", node),
                                         objects("samplers", sampler),
                                         objects("scenes", scene),
                                         objects("skins", skin),
                                         objects("textures", texture)};
  return root;
}

class Checker {
 public:
  explicit Checker(const GltfFile& file) : file_(file) {}

  void checkObject(const json& value, const std::vector<Rule>& rules, const std::string& place) {
    if (!value.is_object()) fail(place, "an object", value);
    for (const Rule& rule : rules) {
      const auto found = value.find(rule.key);
      if (found != value.end()) {
        checkValue(*found, rule, place + "/" + rule.key);
      } else if (rule.required) {
        file_.fail(place.empty() ? "/" : place, std::string("lacks \"") + rule.key + "\"");
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& expected, const json& value) const {
    std::string got = value.dump(-1, ' ', true, json::error_handler_t::replace);
    if (got.size() > 40) got = got.substr(0, 37) + "...";
    file_.fail(place, "expected " + expected + ", got " + got);
  }

  void checkInteger(const json& value, double low, double high, const std::string& what,
                    const std::string& place) const {
    // glTF allows integers written as 3.0; tinygltf does not read those, so neither do we.
    if (!value.is_number_integer()) fail(place, what, value);
    const double number = value.get<double>();
    if (number < low || number > high) fail(place, what, value);
  }

  static std::string range(const Rule& rule) {
    return "an integer from " + std::to_string(int64_t(rule.low)) + " to " + std::to_string(int64_t(rule.high));
  }

  void checkIndex(const json& value, const char* target, const std::string& place) const {
    const auto array = file_.json().find(target);
    const size_t size = array != file_.json().end() && array->is_array() ? array->size() : 0;
    const std::string what = "an index into the " + std::to_string(size) + " " + target;
    if (size == 0) fail(place, what, value);
    checkInteger(value, 0, static_cast<double>(size) - 1, what, place);
  }

  void checkNumber(const json& value, const std::string& place) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(place, "a finite number", value);
  }

  void checkArray(const json& value, const std::string& place) const {
    if (!value.is_array()) fail(place, "an array", value);
  }

  void checkValue(const json& value, const Rule& rule, const std::string& place) {
    const auto at = [&](size_t i) { return place + "/" + std::to_string(i); };
    switch (rule.kind) {
      case Kind::Index:
        return checkIndex(value, rule.target, place);
      case Kind::Indices:
        checkArray(value, place);
        for (size_t i = 0; i < value.size(); ++i) checkIndex(value[i], rule.target, at(i));
        return;
      case Kind::IndexMap:
        if (!value.is_object()) fail(place, "an object", value);
        for (const auto& [key, entry] : value.items()) checkIndex(entry, rule.target, place + "/" + key);
        return;
      case Kind::IndexMaps:
        checkArray(value, place);
        for (size_t i = 0; i < value.size(); ++i) {
          if (!value[i].is_object()) fail(at(i), "an object", value[i]);
          for (const auto& [key, entry] : value[i].items()) checkIndex(entry, rule.target, at(i) + "/" + key);
        }
        return;
      case Kind::Integer:
        return checkInteger(value, rule.low, rule.high, range(rule), place);
      case Kind::Integers:
        if (!value.is_object()) fail(place, "an object", value);
        for (const auto& [key, entry] : value.items())
          checkInteger(entry, rule.low, rule.high, range(rule), place + "/" + key);
        return;
      case Kind::Number:
        return checkNumber(value, place);
      case Kind::Numbers:
        checkArray(value, place);
        if (rule.length && value.size() != rule.length) fail(place, std::to_string(rule.length) + " numbers", value);
        for (size_t i = 0; i < value.size(); ++i) checkNumber(value[i], at(i));
        return;
      case Kind::String:
        if (!value.is_string()) fail(place, "a string", value);
        return;
      case Kind::Strings:
        checkArray(value, place);
        for (size_t i = 0; i < value.size(); ++i)
          if (!value[i].is_string()) fail(at(i), "a string", value[i]);
        return;
      case Kind::Bool:
        if (!value.is_boolean()) fail(place, "true or false", value);
        return;
      case Kind::Object:
        return checkObject(value, *rule.inner, place);
      case Kind::Objects:
        checkArray(value, place);
        for (size_t i = 0; i < value.size(); ++i) checkObject(value[i], *rule.inner, at(i));
        return;
    }
  }

  const GltfFile& file_;
};

}  // namespace

void checkGltfSchema(const GltfFile& file) {
  Checker(file).checkObject(file.json(), rootRules(), "");
}

}  // namespace weir::scene
