#include "document.h"

#include <weir/core/error.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace weir::oracle {
namespace {

// Known: done in full, but for transmission, which Weir ignores by decision (docs/gltf.md): glass is an opaque
// dielectric.
const std::set<std::string> kKnown = {"KHR_lights_punctual",    "KHR_materials_emissive_strength",
                                      "KHR_materials_ior",      "KHR_materials_pbrSpecularGlossiness",
                                      "KHR_materials_specular", "KHR_materials_transmission",
                                      "KHR_materials_unlit",    "KHR_texture_transform"};

std::vector<unsigned char> readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

uint32_t word(const std::vector<unsigned char>& bytes, size_t at) {
  return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | uint32_t{bytes[at + 3]} << 24;
}

std::vector<unsigned char> fromBase64(std::string_view text) {
  std::vector<unsigned char> bytes;
  uint32_t bits = 0, count = 0;
  for (const char c : text) {
    uint32_t v = 0;
    if (c >= 'A' && c <= 'Z')
      v = c - 'A';
    else if (c >= 'a' && c <= 'z')
      v = c - 'a' + 26;
    else if (c >= '0' && c <= '9')
      v = c - '0' + 52;
    else if (c == '+')
      v = 62;
    else if (c == '/')
      v = 63;
    else
      break;
    bits = bits << 6 | v;
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<unsigned char>(bits >> (count -= 8)));
  }
  return bytes;
}

struct Component {
  size_t size;
  double largest;  // what a normalised 1 is
};

Component componentOf(int type) {
  switch (type) {
    case 5120:
      return {1, 127.0};
    case 5121:
      return {1, 255.0};
    case 5122:
      return {2, 32767.0};
    case 5123:
      return {2, 65535.0};
    case 5125:
      return {4, 4294967295.0};
    case 5126:
      return {4, 1.0};
    default:
      return {0, 0.0};
  }
}

template <typename T>
double load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double number(int type, const unsigned char* bytes) {
  switch (type) {
    case 5120:
      return load<int8_t>(bytes);
    case 5121:
      return load<uint8_t>(bytes);
    case 5122:
      return load<int16_t>(bytes);
    case 5123:
      return load<uint16_t>(bytes);
    case 5125:
      return load<uint32_t>(bytes);
    default:
      return load<float>(bytes);
  }
}

}  // namespace

void Document::fail(const std::string& place, const std::string& what) const {
  throw InputError(path_ + ": " + place + ": " + what);
}

Document::Document(const std::string& path) : path_(path) {
  const std::vector<unsigned char> bytes = readFile(path);
  std::vector<unsigned char> binary;
  try {
    if (bytes.size() >= 20 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
      const size_t length = word(bytes, 12);
      if (length > bytes.size() - 20) throw InputError(path + ": its JSON chunk is cut short");
      json_ = Json::parse(bytes.begin() + 20, bytes.begin() + 20 + static_cast<std::ptrdiff_t>(length));
      const size_t next = 20 + length;
      if (bytes.size() >= next + 8) {
        if (word(bytes, next) > bytes.size() - next - 8) throw InputError(path + ": its binary chunk is cut short");
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(next + 8);
        binary.assign(begin, begin + word(bytes, next));
      }
    } else {
      json_ = Json::parse(bytes);
    }
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      for (const Json& name : json_.value(list, Json::array()))
        if (!kKnown.contains(name.get<std::string>())) fail(list, "the oracle doesn't know " + name.get<std::string>());
    }
    const Json list = json_.value("buffers", Json::array());
    for (size_t i = 0; i < list.size(); ++i) {
      buffers_.push_back(list[i].contains("uri") ? readUri(list[i]["uri"], "buffers/" + std::to_string(i)) : binary);
      if (buffers_.back().size() < list[i].at("byteLength").get<size_t>())
        fail("buffers/" + std::to_string(i), "shorter than its byteLength");
    }
  } catch (const Json::exception& error) {
    throw InputError(path + ": " + error.what());
  }
}

std::vector<unsigned char> Document::readUri(const std::string& uri, const std::string& place) const {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) fail(place, "a data URI that isn't base64");
    return fromBase64(std::string_view(uri).substr(comma + 8));
  }
  return readFile((std::filesystem::path(path_).parent_path() / uri).string());
}

Document::View Document::view(size_t index) const {
  const Json& v = json_.at("bufferViews").at(index);
  const size_t buffer = v.at("buffer"), offset = v.value("byteOffset", size_t{0}), length = v.at("byteLength");
  const std::vector<unsigned char>& bytes = buffers_.at(buffer);
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail("bufferViews/" + std::to_string(index), "reaches beyond its buffer");
  return {bytes.data() + offset, length, v.value("byteStride", size_t{0})};
}

Values Document::accessor(size_t index) const {
  const std::string place = "accessors/" + std::to_string(index);
  const Json& a = json_.at("accessors").at(index);
  if (a.contains("sparse")) fail(place, "the oracle doesn't know sparse accessors");
  if (!a.contains("bufferView")) fail(place, "the oracle doesn't know accessors without a view");
  const int type = a.at("componentType");
  const Component component = componentOf(type);
  if (component.size == 0) fail(place, "unknown componentType");
  const std::string shape = a.at("type");
  Values values;
  values.components = shape == "SCALAR" ? 1 : shape == "VEC2" ? 2 : shape == "VEC3" ? 3 : shape == "VEC4" ? 4 : 0;
  if (shape == "MAT4" && component.size == 4) values.components = 16;  // smaller components are padded
  if (values.components == 0) fail(place, "the oracle doesn't know type " + shape);
  values.count = a.at("count");
  const View v = view(a["bufferView"]);
  const size_t offset = a.value("byteOffset", size_t{0}), size = component.size * values.components;
  const size_t stride = v.stride ? v.stride : size;
  if (values.count == 0 || stride > v.length || values.count > v.length / stride + 1 || offset > v.length ||
      (values.count - 1) * stride + size > v.length - offset)
    fail(place, "reaches beyond its view");
  const bool normalised = a.value("normalized", false);
  values.numbers.reserve(values.count * values.components);
  for (size_t i = 0; i < values.count; ++i) {
    for (size_t c = 0; c < values.components; ++c) {
      const double x = number(type, v.bytes + offset + i * stride + c * component.size);
      values.numbers.push_back(normalised ? std::max(x / component.largest, -1.0) : x);
    }
  }
  return values;
}

std::vector<unsigned char> Document::imageBytes(size_t image) const {
  const Json& i = json_.at("images").at(image);
  if (i.contains("uri")) return readUri(i["uri"], "images/" + std::to_string(image));
  const View v = view(i.at("bufferView"));
  return {v.bytes, v.bytes + v.length};
}

}  // namespace weir::oracle
