// What of Weir's models a scene uses. Shaders are compiled with just that: a scene pays for nothing that it lacks.
#pragma once

#include <string>

namespace weir::scene {

/// Each trait is a line `#define SCENE_<NAME> 1` at the head of every kernel and hit shader, before any declaration.
/// prepareScene() finds them; a new model adds its trait here, to traitDefines() and to where it is found.
struct SceneTraits {
  bool texturedLights = false;  ///< SCENE_TEXTURED_LIGHTS: some emissive triangle's radiance varies with its texture
  bool animated = false;  ///< SCENE_ANIMATED: instances, lights and acceleration structure differ from last frame's
  bool deforms = false;   ///< SCENE_DEFORMS: so do vertex positions (skins, morph targets); implies animated
  bool operator==(const SceneTraits&) const = default;
};

/// The #define lines of the traits that hold, in a fixed order.
std::string traitDefines(const SceneTraits& traits);

}  // namespace weir::scene
