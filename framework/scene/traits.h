// What of Weir's models a scene uses. Shaders are compiled with just that: a scene pays for nothing that it lacks.
#pragma once

#include <string>

namespace weir::scene {

/// Each trait is a line `#define SCENE_<NAME> 1` at the head of every kernel and hit shader, before any declaration.
/// prepareScene() finds them; a new model adds its trait here, to traitDefines() and to where it is found.
struct SceneTraits {
  bool texturedLights = false;  ///< SCENE_TEXTURED_LIGHTS: some emissive triangle's radiance varies with its texture
  bool triangleLights = false;  ///< SCENE_TRIANGLE_LIGHTS: some light is an emissive triangle
  bool shapedLights = false;    ///< SCENE_SHAPED_LIGHTS: some punctual light isn't a point that shines without a range
  bool alphaLights = false;     ///< SCENE_ALPHA_LIGHTS: some emissive triangle's coverage varies over it
  bool blend = false;           ///< SCENE_BLEND: some material blends, so that rays may come through in part
  bool vertexColors = false;    ///< SCENE_VERTEX_COLORS: some triangle's base colour is scaled by its vertices'
  bool uvSets = false;          ///< SCENE_UV_SETS: some texture is read at the second set of coordinates
  bool uvTransforms = false;    ///< SCENE_UV_TRANSFORMS: some texture's coordinates are transformed
  bool mipmaps = false;         ///< SCENE_MIPMAPS: some texture's filter depends on how much of it a pixel covers
  bool specularGlossiness = false;  ///< SCENE_SPECULAR_GLOSSINESS: some material is of that model
  bool dielectricSpecular = false;  ///< SCENE_DIELECTRIC_SPECULAR: some metallic-roughness material's F0 isn't 0.04
  bool unlit = false;               ///< SCENE_UNLIT: some material shows its base colour as it is
  bool f90 = false;                 ///< SCENE_F90: some surface reflects less than all light at grazing angles
  bool environment = false;         ///< SCENE_ENVIRONMENT: light from all around, scene/environment.h
  bool energyCompensation = false;  ///< SCENE_ENERGY_COMPENSATION: asked for, and some surface has a specular lobe
  bool animated = false;  ///< SCENE_ANIMATED: instances, lights and acceleration structure differ from last frame's
  bool deforms = false;   ///< SCENE_DEFORMS: so do vertex positions (skins, morph targets); implies animated
  bool operator==(const SceneTraits&) const = default;
};

/// The #define lines of the traits that hold, in a fixed order.
std::string traitDefines(const SceneTraits& traits);

}  // namespace weir::scene
