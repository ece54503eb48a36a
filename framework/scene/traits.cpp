#include <weir/scene/traits.h>

namespace weir::scene {

std::string traitDefines(const SceneTraits& traits) {
  std::string lines;
  const auto define = [&](bool holds, const char* name) {
    if (holds) lines += std::string("#define SCENE_") + name + " 1\n";
  };
  define(traits.texturedLights, "TEXTURED_LIGHTS");
  define(traits.animated, "ANIMATED");
  define(traits.deforms, "DEFORMS");
  return lines;
}

}  // namespace weir::scene
