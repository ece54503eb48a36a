#include <weir/scene/traits.h>

namespace weir::scene {

std::string traitDefines(const SceneTraits& traits) {
  std::string lines;
  const auto define = [&](bool holds, const char* name) {
    if (holds) lines += std::string("#define SCENE_") + name + " 1\n";
  };
  define(traits.texturedLights, "TEXTURED_LIGHTS");
  define(traits.triangleLights, "TRIANGLE_LIGHTS");
  define(traits.shapedLights, "SHAPED_LIGHTS");
  define(traits.alphaLights, "ALPHA_LIGHTS");
  define(traits.blend, "BLEND");
  define(traits.vertexColors, "VERTEX_COLORS");
  define(traits.uvSets, "UV_SETS");
  define(traits.uvTransforms, "UV_TRANSFORMS");
  define(traits.mipmaps, "MIPMAPS");
  define(traits.specularGlossiness, "SPECULAR_GLOSSINESS");
  define(traits.dielectricSpecular, "DIELECTRIC_SPECULAR");
  define(traits.unlit, "UNLIT");
  define(traits.f90, "F90");
  define(traits.environment, "ENVIRONMENT");
  define(traits.energyCompensation, "ENERGY_COMPENSATION");
  define(traits.animated, "ANIMATED");
  define(traits.deforms, "DEFORMS");
  return lines;
}

}  // namespace weir::scene
