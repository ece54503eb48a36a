// PackedSurface in the field's terms, unpacked by the functions that the passes use.
LAYOUT_STRUCT
#include "surface.glsl"

// What metallic-roughness materials of IOR 1.5 have for c_diff and F0, solved for base colour and metalness: c_diff = b (1 - m),
// F0 = 0.04 (1 - m) + b m, by their luminance for m (glTF 2.0, appendix B).
float metallicOf(vec3 diffuse, vec3 f0) {
  const float d = luminanceOf(diffuse), over = max(luminanceOf(f0) - 0.04, 0.0), b = d + over - 0.04;
  return clamp((sqrt(b * b + 0.16 * over) - b) / 0.08, 0.0, 1.0);
}

Value valueAt(uvec2 pixel) {
  uint first;
  if (!elementAt(pixel, first)) return nothing();
  const PackedSurface p = PackedSurface(uintBitsToFloat(words[first]), words[first + 1u], words[first + 2u], words[first + 3u],
                                        words[first + 4u], words[first + 5u]);
  if (settings.code == 0u) return wordOf(isSurface(p) ? 4u : 0u);
  if (settings.code == 1u && !isFinite(p.distance)) return numberOf(p.distance);
  if (!isSurface(p)) return nothing();
  const Surface s = unpackSurface(p, pixel, settings.camera, vec2(settings.extent));
  switch (settings.code) {
    case 1u: return numberOf(s.distance);
    case 2u: return colorOf(s.position);
    case 3u: return colorOf(unpackNormal(p.shadingNormal));
    case 4u: return colorOf(s.geometricNormal);
    case 5u: return colorOf(s.diffuse);
    case 6u: return colorOf(s.f0);
    case 7u: return numberOf(roughnessOf(p));
    case 8u: return numberOf(metallicOf(s.diffuse, s.f0));
    case 9u: return colorOf(s.diffuse + max(s.f0 - 0.04 * (1.0 - metallicOf(s.diffuse, s.f0)), 0.0));
    case 10u: return numberOf(dot(unpackNormal(p.shadingNormal), s.view));
    case 11u: return colorOf(vec3(unpackJitter(p.roughnessJitter), 0.0));
#ifdef SCENE_F90
    case 12u: return numberOf(s.f90);
#endif
    default: return nothing();
  }
}
