#include "view/picture/unpack.h"

#include <weir/scene/lights.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "../../../passes/common/layouts.h"

namespace weir::view {

glm::vec3 unpackNormal(uint32_t bits) {
  const glm::vec2 p = glm::unpackSnorm2x16(bits);
  glm::vec3 n(p, 1.0f - std::abs(p.x) - std::abs(p.y));
  if (n.z < 0.0f) {
    const glm::vec2 folded((1.0f - std::abs(p.y)) * (p.x >= 0.0f ? 1.0f : -1.0f),
                           (1.0f - std::abs(p.x)) * (p.y >= 0.0f ? 1.0f : -1.0f));
    n.x = folded.x;
    n.y = folded.y;
  }
  return glm::normalize(n);
}

glm::vec3 unpackAlbedo(uint32_t bits) {
  const glm::vec3 s(static_cast<float>(bits & 2047u) / 2047.0f, static_cast<float>((bits >> 11) & 2047u) / 2047.0f,
                    static_cast<float>(bits >> 22) / 1023.0f);
  return s * s;
}

SurfaceValues unpackSurface(const passes::PackedSurface& packed, uint32_t x, uint32_t y, const Extent& extent,
                            const execute::GpuCamera& camera, bool f90) {
  SurfaceValues s;
  const uint32_t bits = packed.roughnessJitter;
  s.samplePlace = (glm::vec2(bits & 255u, (bits >> 8) & 255u) + 0.5f) / 255.0f;
  const glm::vec2 ndc = (glm::vec2(x, y) + s.samplePlace) / glm::vec2(extent.width, extent.height) * 2.0f - 1.0f;
  const glm::vec3 direction =
      glm::normalize(glm::vec3(camera.forward) + ndc.x * glm::vec3(camera.right) - ndc.y * glm::vec3(camera.up));
  s.distance = packed.distance;
  s.position = glm::vec3(camera.origin) + packed.distance * direction;
  s.shadingNormal = unpackNormal(packed.shadingNormal);
  s.geometricNormal = unpackNormal(packed.geometricNormal);
  s.diffuse = unpackAlbedo(packed.diffuse);
  s.f0 = unpackAlbedo(packed.specular);
  s.roughness = f90 ? static_cast<float>(bits >> 22) / 1023.0f : static_cast<float>(bits >> 16) / 65535.0f;
  if (f90) s.f90 = static_cast<float>((bits >> 16) & 63u) / 63.0f;
  s.facing = -glm::dot(s.shadingNormal, direction);
  // As read_surface.glsl has it.
  const float over = std::max(scene::luminance(s.f0) - 0.04f, 0.0f), b = scene::luminance(s.diffuse) + over - 0.04f;
  s.metallic = std::clamp((std::sqrt(b * b + 0.16f * over) - b) / 0.08f, 0.0f, 1.0f);
  s.baseColor = s.diffuse + glm::max(s.f0 - 0.04f * (1.0f - s.metallic), glm::vec3(0.0f));
  return s;
}

glm::vec2 unpackPlace(uint32_t place) {
  return (glm::vec2(place & 0xffffu, place >> 16) + 0.5f) / 65536.0f;
}

glm::vec2 placeOnTriangle(uint32_t place) {
  const glm::vec2 u = unpackPlace(place);
  return u.x + u.y > 1.0f ? glm::vec2(1.0f - u.y, 1.0f - u.x) : u;
}

}  // namespace weir::view
