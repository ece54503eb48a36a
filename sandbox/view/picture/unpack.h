// Host counterparts of what shaders/common unpacks, for words: packing.glsl, surface.glsl, reservoir_bits.glsl and
// light_place.glsl.
#pragma once

#include <weir/execute/frame_constants.h>

#include <cstdint>
#include <glm/glm.hpp>

#include "view/picture/channels.h"

namespace weir::passes {
struct PackedSurface;
}

namespace weir::view {

glm::vec3 unpackNormal(uint32_t bits);
glm::vec3 unpackAlbedo(uint32_t bits);

/// Everything that channels show of a surface, in their units.
struct SurfaceValues {
  float distance = 0.0f;
  glm::vec3 position{0.0f}, shadingNormal{0.0f}, geometricNormal{0.0f};
  glm::vec3 diffuse{0.0f}, f0{0.0f}, baseColor{0.0f};
  float roughness = 0.0f, metallic = 0.0f, f90 = 1.0f, facing = 0.0f;
  glm::vec2 samplePlace{0.5f};
};
SurfaceValues unpackSurface(const passes::PackedSurface& packed, uint32_t x, uint32_t y, const Extent& extent,
                            const execute::GpuCamera& camera, bool f90);

inline constexpr uint32_t kSeenBit = 0x80000000u, kHiddenBit = 0x40000000u;  ///< of Reservoir::light

/// Place on a light as coordinates of the unit square, and as barycentrics of a triangle's vertices 1 and 2.
glm::vec2 unpackPlace(uint32_t place);
glm::vec2 placeOnTriangle(uint32_t place);

}  // namespace weir::view
