// E(n·v, α): how much of the light that meets a GGX surface without absorption leaves it after a single reflection,
// that is, the directional albedo of the specular lobe of glTF 2.0, appendix B, with F = 1. The rest would have been
// reflected again; energy compensation (Turquin 2019, "Practical multiple scattering compensation for microfacet
// models") puts it back.
#pragma once

#include <cstdint>
#include <vector>

namespace weir::scene {

inline constexpr uint32_t kSpecularAlbedoColumns = 64, kSpecularAlbedoRows = 32;

/// Row by row, read bilinearly: row α · (rows - 1), column √(n·v (1 + α) / (n·v + α)) · (columns - 1). The square root
/// and n·v / α spread out what happens at grazing angles, where E falls and rises again within a few α. Against
/// quadrature, 7.2e-4 at most relative to E, at any angle and any α ≤ 1 (shaders/common/surface.glsl reads it).
std::vector<float> specularAlbedoTable();

}  // namespace weir::scene
