#include "view/picture/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "view/picture/known_channels.h"

namespace weir::view {
namespace {

constexpr std::array<const char*, 4> kColorNames{"R", "G", "B", "A"};
constexpr std::array<const char*, 4> kAxes{"x", "y", "z", "w"};

Channel imageChannel(const char* name, const char* doc, uint32_t code, Shows shows, Meaning meaning) {
  Channel c;
  c.name = name;
  c.doc = doc;
  c.code = code;
  c.shows = shows;
  c.exposed = c.encoded = meaning == Meaning::Radiance && std::string_view(name) != "A";
  return c;
}

std::vector<Channel> colorChannels(Meaning meaning) {
  std::vector<Channel> all;
  all.push_back(imageChannel("RGB", "Red, green and blue together", 4, Shows::Color, meaning));
  all.push_back(imageChannel("luminance", "Luminance of linear Rec.709", 5, Shows::Number, meaning));
  for (uint32_t c = 0; c < 4; ++c)
    all.push_back(imageChannel(kColorNames[c], c == 3 ? "Alpha" : "One colour alone", c, Shows::Number, meaning));
  return all;
}

std::vector<Channel> vectorChannels(Meaning meaning) {
  std::vector<Channel> all;
  all.push_back(imageChannel("direction",
                             "Hue: where the vector goes (right is red, down yellow-green). Brightness: how far", 7,
                             Shows::Direction, meaning));
  all.back().high = 8.0f;
  all.push_back(imageChannel("length", "Length of the vector (R, G)", 6, Shows::Number, meaning));
  all.back().high = 8.0f;
  for (uint32_t c = 0; c < 2; ++c) {
    all.push_back(
        imageChannel(kColorNames[c], c == 0 ? "First component" : "Second component", c, Shows::Number, meaning));
    all.back().low = -8.0f;
    all.back().high = 8.0f;
  }
  for (Channel& c : all) c.exposed = c.encoded = false;
  return all;
}

std::vector<Channel> imageChannels(const graph::Resource& resource, Meaning meaning) {
  switch (resource.type.format) {
    case Format::R32F: {
      std::vector<Channel> one{imageChannel("R", "The one value", 0, Shows::Number, meaning)};
      one[0].guessed = meaning == Meaning::Data;
      return one;
    }
    case Format::RG32F:
      return vectorChannels(meaning);
    case Format::R32U: {
      std::vector<Channel> two(2);
      two[0] = {.name = "label", .doc = "Each integer in a colour of its own", .shows = Shows::Label};
      two[1] = {.name = "value", .doc = "The integer as a number", .high = 255.0f, .guessed = true};
      for (Channel& c : two) c.reading = Reading::Integers;
      return two;
    }
    case Format::RGBA32F:
    case Format::RGBA16F:
    case Format::RGBA8:
      break;
  }
  return colorChannels(meaning);
}

bool isFloat(const std::string& type) {
  return type == "float" || type.starts_with("vec");
}
bool isSignedInteger(const std::string& type) {
  return type.starts_with("i");
}

/// Codes of read_words.glsl.
enum WordCode : uint32_t { kFloat = 0, kUint = 1, kInt = 2, kBits = 3, kVec2 = 4, kVec3 = 5 };

void addIntegers(std::vector<Channel>& all, const std::string& name, bool isSigned, uint32_t word) {
  all.push_back({.name = name, .doc = "The integer as a number", .high = 255.0f, .guessed = true});
  all.back().code = isSigned ? kInt : kUint;
  all.push_back({.name = name + " label", .doc = "Each integer in a colour of its own", .shows = Shows::Label});
  all.back().code = kUint;
  all.push_back(
      {.name = name + " bits", .doc = "Upper 11 bits red, the 11 below green, lower 10 blue", .shows = Shows::Color});
  all.back().code = kBits;
  for (size_t i = all.size() - 3; i < all.size(); ++i) all[i].word = word;
}

std::vector<Channel> fieldChannels(const Layout& layout) {
  std::vector<Channel> all;
  const std::vector<uint32_t> offsets = fieldOffsets(layout);
  for (size_t f = 0; f < offsets.size(); ++f) {
    const LayoutField& field = layout.fields[f];
    const uint32_t count = componentsOf(field.type), word = offsets[f] / 4;
    if (isFloat(field.type) && count > 1) {
      Channel c{
          .name = field.name, .doc = fmt::format("{} as a colour", field.type), .shows = Shows::Color, .guessed = true};
      if (count == 2) c.doc = "Hue: where the vector goes. Brightness: how far", c.shows = Shows::Direction;
      c.code = count == 2 ? kVec2 : kVec3;
      c.word = word;
      all.push_back(std::move(c));
    }
    for (uint32_t i = 0; i < count; ++i) {
      const std::string name = count == 1 ? field.name : field.name + "." + kAxes[i];
      if (!isFloat(field.type)) {
        addIntegers(all, name, isSignedInteger(field.type), word + i);
        continue;
      }
      all.push_back({.name = name, .doc = "A float of the element", .guessed = true, .code = kFloat, .word = word + i});
    }
  }
  // A layout of fields that nobody knows is words still.
  const uint32_t bare = all.empty() ? layout.stride / 4 : 0;
  for (uint32_t w = 0; w < bare; ++w) addIntegers(all, fmt::format("word {}", w), false, w);
  for (Channel& c : all) c.reading = Reading::Words;
  return all;
}

}  // namespace

Extent extentOf(const graph::Resource& resource) {
  if (resource.isImage() || resource.type.fixedCount == 0) return {resource.width, resource.height};
  if (resource.elements == 0) return {};
  const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(resource.elements))));
  return {columns, static_cast<uint32_t>((resource.elements + columns - 1) / columns)};
}

Meaning meaningOf(const graph::CompiledGraph& graph, const graph::Resource& resource) {
  if (resource.producer >= graph.passes.size()) return Meaning::Data;
  const graph::CompiledPass& pass = graph.passes[resource.producer];
  for (size_t i = 0; i < pass.outputs.size(); ++i)
    if (&graph.resources[pass.outputs[i].resource] == &resource) return pass.description->outputs[i].meaning;
  return Meaning::Data;
}

std::vector<Channel> channelsOf(const graph::Resource& resource, Meaning meaning, bool f90) {
  if (resource.isImage()) return imageChannels(resource, meaning);
  const Layout& layout = resource.type.layout;
  std::vector<Channel> all;
  if (isPackedSurface(layout))
    all = surfaceChannels(f90);
  else if (isReservoir(layout))
    all = reservoirChannels();
  else
    all = fieldChannels(layout);
  for (Channel& c : all) c.layout = layout.hash;
  return all;
}

bool belongs(const Channel& channel, const graph::Resource& resource) {
  switch (channel.reading) {
    case Reading::Image:
      return resource.isImage() && resource.type.format != Format::R32U;
    case Reading::Integers:
      return resource.isImage() && resource.type.format == Format::R32U;
    default:
      return !resource.isImage() && channel.layout == resource.type.layout.hash;
  }
}

const Channel* findChannel(const std::vector<Channel>& channels, const std::string& name) {
  const auto found = std::ranges::find(channels, name, &Channel::name);
  return found == channels.end() ? nullptr : &*found;
}

uint32_t componentsOf(const std::string& type) {
  if (type == "float" || type == "uint" || type == "int") return 1;
  const std::string_view stem = std::string_view(type).substr(0, type.empty() ? 0 : type.size() - 1);
  if (stem != "vec" && stem != "uvec" && stem != "ivec") return 0;
  return type.back() >= '2' && type.back() <= '4' ? static_cast<uint32_t>(type.back() - '0') : 0;
}

std::vector<uint32_t> fieldOffsets(const Layout& layout) {
  std::vector<uint32_t> offsets;
  uint32_t next = 0;
  for (const LayoutField& field : layout.fields) {
    const uint32_t count = componentsOf(field.type);
    const uint32_t align = count == 3 ? 16 : 4 * count;
    if (count == 0) break;
    next = (next + align - 1) / align * align;
    if (next + 4 * count > layout.stride) break;  // not what std430 makes of it
    offsets.push_back(next);
    next += 4 * count;
  }
  return offsets;
}

}  // namespace weir::view
