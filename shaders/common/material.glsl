// glTF's material models: how a place on a surface reflects.
//   metallic-roughness    glTF 2.0, appendix B, with KHR_materials_ior and KHR_materials_specular (SCENE_DIELECTRIC_SPECULAR)
//   specular-glossiness   KHR_materials_pbrSpecularGlossiness (SCENE_SPECULAR_GLOSSINESS)
//   unlit                 KHR_materials_unlit (SCENE_UNLIT): not at all
#ifndef WEIR_MATERIAL
#define WEIR_MATERIAL

#include "texture_level.glsl"

struct Reflection {
  vec3 diffuse;  // c_diff
  vec3 f0;
  float f90;
  float roughness;
};

// `base` is the base or diffuse colour with all that scales it.
Reflection reflectionOf(uint material, vec3 base, Lookup at) {
  const Material m = sceneMaterials[material];
#ifdef SCENE_UNLIT
  if ((m.flags & kMaterialUnlit) != 0u) return Reflection(vec3(0.0), vec3(0.0), 0.0, 1.0);
#endif
#ifdef SCENE_SPECULAR_GLOSSINESS
  if ((m.flags & kMaterialSpecularGlossiness) != 0u) {
    const Specular s = sceneSpeculars[material];
    vec4 specular = vec4(s.f0, m.roughness);  // its fourth part is the glossiness
    if (s.colorTexture >= 0) specular *= look(s.colorTexture, at);
    const float most = max(specular.r, max(specular.g, specular.b));
    return Reflection(base * (1.0 - most), specular.rgb, 1.0, 1.0 - specular.a);
  }
#endif
  float metallic = m.metallic, roughness = m.roughness, weight = 1.0;
  if (m.metallicRoughnessTexture >= 0) {
    const vec4 mr = look(m.metallicRoughnessTexture, at);
    roughness *= mr.g;
    metallic *= mr.b;
  }
  vec3 f0 = vec3(0.04);
#ifdef SCENE_DIELECTRIC_SPECULAR
  const Specular s = sceneSpeculars[material];
  f0 = s.f0;
  weight = s.weight;
  if (s.colorTexture >= 0) f0 *= look(s.colorTexture, at).rgb;
  if (s.weightTexture >= 0) weight *= look(s.weightTexture, at).a;
  f0 = min(f0, 1.0) * weight;
#endif
  return Reflection(base * (1.0 - metallic), mix(f0, base, metallic), mix(weight, 1.0, metallic), roughness);
}

#endif
