#include "view/picture/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "../../../passes/common/layouts.h"
#include "view/picture/unpack.h"

namespace weir::view {
namespace {

using Rows = std::vector<Row>;

template <typename T>
T valueAt(std::span<const std::byte> bytes, size_t offset = 0) {
  T value{};
  if (offset + sizeof(T) <= bytes.size()) std::memcpy(&value, &bytes[offset], sizeof(T));
  return value;
}

std::string integerText(uint32_t value) {
  return fmt::format("{} ({:#010x})", value, value);
}
std::string vectorText(const glm::vec3& v) {
  return fmt::format("({}, {}, {})", numberText(v.x), numberText(v.y), numberText(v.z));
}

// ------------------------------------------------------------------------------------------------------- images

void colorRows(const glm::vec4& v, Rows& rows) {
  constexpr const char* kNames[] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c) rows.push_back({kNames[c], numberText(v[c])});
  rows.push_back({"luminance", numberText(scene::luminance(glm::vec3(v)))});
}

void imageRows(Format format, std::span<const std::byte> bytes, Rows& rows) {
  switch (format) {
    case Format::R32F:
      rows.push_back({"R", numberText(valueAt<float>(bytes))});
      break;
    case Format::RG32F: {
      const auto v = valueAt<glm::vec2>(bytes);
      rows.push_back({"R", numberText(v.x)});
      rows.push_back({"G", numberText(v.y)});
      rows.push_back({"length", numberText(glm::length(v))});
      break;
    }
    case Format::RGBA32F:
      colorRows(valueAt<glm::vec4>(bytes), rows);
      break;
    case Format::RGBA16F: {
      const auto halves = valueAt<glm::uvec2>(bytes);
      colorRows(glm::vec4(glm::unpackHalf2x16(halves.x), glm::unpackHalf2x16(halves.y)), rows);
      break;
    }
    case Format::RGBA8: {
      constexpr const char* kNames[] = {"R", "G", "B", "A"};
      for (size_t c = 0; c < 4; ++c) {
        const auto code = std::to_integer<uint32_t>(bytes[c]);
        rows.push_back({kNames[c], fmt::format("{:.4f} ({} of 255)", static_cast<float>(code) / 255.0f, code)});
      }
      break;
    }
    case Format::R32U:
      rows.push_back({"value", integerText(valueAt<uint32_t>(bytes))});
      break;
  }
}

// ------------------------------------------------------------------------------------------------------ layouts

void surfaceRows(const Probed& p, std::span<const std::byte> bytes, const std::string& prefix, Rows& rows) {
  const auto packed = valueAt<passes::PackedSurface>(bytes);
  if (!(packed.distance > 0.0f)) {
    rows.push_back(
        {prefix + "surface", std::isnan(packed.distance) ? "none: its distance is NaN" : "none: background"});
    return;
  }
  const SurfaceValues s = unpackSurface(packed, p.pixel.x, p.pixel.y, extentOf(p.resource), p.camera, p.f90);
  rows.push_back({prefix + "position", vectorText(s.position) + " m"});
  rows.push_back({prefix + "distance", numberText(s.distance) + " m"});
  rows.push_back({prefix + "shading normal", vectorText(s.shadingNormal)});
  rows.push_back({prefix + "geometric normal", vectorText(s.geometricNormal)});
  rows.push_back({prefix + "base colour", vectorText(s.baseColor)});
  rows.push_back({prefix + "metallic", numberText(s.metallic)});
  rows.push_back({prefix + "roughness",
                  fmt::format("{} (alpha {})", numberText(s.roughness), numberText(s.roughness * s.roughness))});
  rows.push_back({prefix + "diffuse albedo", vectorText(s.diffuse)});
  rows.push_back({prefix + "F0", vectorText(s.f0)});
  if (p.f90) rows.push_back({prefix + "F90", numberText(s.f90)});
  rows.push_back(
      {prefix + "sampled at", fmt::format("({:.3f}, {:.3f}) of the pixel", s.samplePlace.x, s.samplePlace.y)});
}

std::string lightText(uint32_t number, uint32_t place, std::span<const scene::GpuLight> lights) {
  if (lights.empty()) return fmt::format("light {}", number);
  if (number >= lights.size()) return fmt::format("light {}, and there are {}", number, lights.size());
  const scene::GpuLight& light = lights[number];
  switch (static_cast<scene::GpuLightKind>(light.kind & 0xffu)) {
    case scene::GpuLightKind::Point:
      return fmt::format("light {} (point) at {} m", number, vectorText(light.position));
    case scene::GpuLightKind::Spot:
      return fmt::format("light {} (spot) at {} m", number, vectorText(light.position));
    case scene::GpuLightKind::Directional:
      return fmt::format("light {} (directional) along {}", number, vectorText(light.a));
    case scene::GpuLightKind::Triangle: {
      const glm::vec2 at = placeOnTriangle(place);
      return fmt::format("light {} (triangle {}) at {} m", number, light.triangle,
                         vectorText(light.position + at.x * light.a + at.y * light.b));
    }
    case scene::GpuLightKind::Environment:
      return fmt::format("light {} (environment)", number);
  }
  return fmt::format("light {} (of a kind that nobody knows)", number);
}

bool isTriangle(uint32_t number, std::span<const scene::GpuLight> lights) {
  return number < lights.size() &&
         static_cast<scene::GpuLightKind>(lights[number].kind & 0xffu) == scene::GpuLightKind::Triangle;
}

void reservoirRows(std::span<const std::byte> bytes, std::span<const scene::GpuLight> lights, const std::string& prefix,
                   Rows& rows) {
  const auto r = valueAt<passes::Reservoir>(bytes);
  const std::string confidence = numberText(r.confidence) + (r.confidence == 1.0f ? " frame" : " frames");
  if (!(r.weight > 0.0f)) {
    if (std::isnan(r.weight)) {
      rows.push_back({prefix + "sample", "none: its W is NaN"});
    } else {
      rows.push_back(
          {prefix + "sample", r.confidence > 0.0f ? "none: nothing that lights this was found" : "none: empty"});
    }
    rows.push_back({prefix + "M", confidence});
    return;
  }
  const uint32_t number = r.light & ~(kSeenBit | kHiddenBit);
  const glm::vec2 place = unpackPlace(r.place);
  rows.push_back({prefix + "sample", lightText(number, r.place, lights)});
  rows.push_back({prefix + "place", fmt::format("({:.5f}, {:.5f})", place.x, place.y)});
  rows.push_back({prefix + "W", numberText(r.weight) + (isTriangle(number, lights) ? " m\u00b2" : "")});
  rows.push_back({prefix + "M", confidence});
  rows.push_back({prefix + "visibility", (r.light & kSeenBit) != 0     ? "seen by its shadow ray"
                                         : (r.light & kHiddenBit) != 0 ? "hidden in the last frame"
                                                                       : "not known"});
}

std::string componentText(const std::string& type, std::span<const std::byte> bytes, size_t offset) {
  if (type == "float" || type.starts_with("vec")) return numberText(valueAt<float>(bytes, offset));
  if (type.starts_with("i")) return std::to_string(valueAt<int32_t>(bytes, offset));
  return integerText(valueAt<uint32_t>(bytes, offset));
}

void fieldRows(const Layout& layout, std::span<const std::byte> bytes, const std::string& prefix, Rows& rows) {
  const std::vector<uint32_t> offsets = fieldOffsets(layout);
  for (size_t f = 0; f < offsets.size(); ++f) {
    const LayoutField& field = layout.fields[f];
    const uint32_t count = componentsOf(field.type);
    if (offsets[f] + 4 * count > bytes.size()) break;  // more than a probe reads
    std::string text;
    for (uint32_t i = 0; i < count; ++i)
      text += (i > 0 ? ", " : "") + componentText(field.type, bytes, offsets[f] + 4 * i);
    rows.push_back({prefix + field.name, count > 1 ? "(" + text + ")" : text});
  }
  for (size_t w = 0; offsets.empty() && 4 * w + 4 <= bytes.size(); ++w)
    rows.push_back({prefix + fmt::format("word {}", w), integerText(valueAt<uint32_t>(bytes, 4 * w))});
}

}  // namespace

std::string numberText(float value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0.0f ? "infinity" : "-infinity";
  return fmt::format("{:.6g}", value);
}

std::vector<Row> wordsOf(const Probed& p, std::span<const scene::GpuLight> lights) {
  Rows rows;
  const bool strip = !p.resource.isImage() && p.resource.type.fixedCount > 0;
  if (strip)
    rows.push_back({"element", std::to_string(uint64_t{p.pixel.y} * extentOf(p.resource).width + p.pixel.x)});
  else
    rows.push_back({"pixel", fmt::format("({}, {})", p.pixel.x, p.pixel.y)});
  if (p.resource.isImage()) {
    if (p.bytes.size() >= formatBytes(p.resource.type.format)) imageRows(p.resource.type.format, p.bytes, rows);
    return rows;
  }
  const Layout& layout = p.resource.type.layout;
  const size_t count = strip ? 1 : std::max(p.resource.perPixel, 1u);
  const size_t stride = layout.stride;
  for (size_t k = 0; k < count; ++k) {
    const size_t first = k * stride;
    if (first >= p.bytes.size() || (k > 0 && first + stride > p.bytes.size())) {
      rows.push_back({"further", fmt::format("{} more elements", count - k)});
      break;
    }
    const std::span<const std::byte> bytes =
        std::span(p.bytes).subspan(first, std::min(stride, p.bytes.size() - first));
    const std::string prefix = count > 1 ? fmt::format("[{}] ", k) : "";
    if (isPackedSurface(layout))
      surfaceRows(p, bytes, prefix, rows);
    else if (isReservoir(layout))
      reservoirRows(bytes, lights, prefix, rows);
    else
      fieldRows(layout, bytes, prefix, rows);
  }
  return rows;
}

}  // namespace weir::view
