// A glTF scene in world space at one moment: triangles, materials, punctual lights, cameras. Sizes in metres, +Y up.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "document.h"
#include "texture.h"

namespace weir::oracle {

/// Corners so ordered that cross(p1 - p0, p2 - p0) is the front, whatever mirrors the node.
struct Triangle {
  std::array<glm::dvec3, 3> position;  ///< rounded to float: what both tracers see
  std::array<glm::dvec3, 3> normal;
  std::array<glm::dvec4, 3> tangent{};  ///< w: sign of the bitangent; zero where there is none
  std::array<std::array<glm::dvec2, 3>, 2> uv{};
  std::array<glm::dvec4, 3> color{glm::dvec4(1), glm::dvec4(1), glm::dvec4(1)};
  int material = 0;
};

struct Slot {
  const Texture* texture = nullptr;
  int set = 0;
  glm::dvec2 offset{0}, scale{1};
  explicit operator bool() const { return texture != nullptr; }
};

enum class Alpha : unsigned char { Opaque, Mask, Blend };

struct Material {
  glm::dvec4 baseColor{1};  ///< diffuse colour in specular-glossiness
  double metallic = 1, roughness = 1;
  glm::dvec3 specular{1};  ///< specular-glossiness: F0. KHR_materials_specular: its colour
  double specularWeight = 1, dielectricF0 = 0.04;
  glm::dvec3 emission{0};  ///< nit
  double normalScale = 1, cutoff = 0.5;
  Alpha alpha = Alpha::Opaque;
  bool doubleSided = false, glossy = false, unlit = false;
  Slot baseTexture, roughnessTexture, normalTexture, emissionTexture, specularTexture, specularColorTexture;
};

struct PunctualLight {
  enum class Kind : unsigned char { Point, Spot, Directional } kind = Kind::Point;
  glm::dvec3 position{0}, direction{0, 0, -1};
  glm::dvec3 intensity{1};  ///< candela; lux if directional
  double range = 0;         ///< 0: none
  double innerCone = 0, outerCone = 0.785398163397448;
};

struct Camera {
  std::string name;
  glm::dvec3 eye{0}, forward{0, 0, -1}, up{0, 1, 0};
  double verticalFov = 0.785398163397448;  ///< radians
};

/// A moment of a clip.
struct Moment {
  std::string clip;  ///< name
  double seconds = 0;
};

struct Model {
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<PunctualLight> lights;
  std::vector<Camera> cameras;
  std::vector<std::unique_ptr<Image>> images;
  std::vector<std::unique_ptr<Texture>> textures;
  glm::dvec3 low{0}, high{0};  ///< bounds of the triangles
};

/// Throws InputError; also for what the oracle doesn't know.
Model loadModel(const std::string& path, const std::optional<Moment>& moment = {});

/// `--camera`: empty for the file's first, a name, or ex,ey,ez,tx,ty,tz[,vfov degrees]. Throws InputError; also for a
/// scene without a camera: the one that frames it is a convention of the program's, not a truth.
Camera chooseCamera(const Model& model, const std::string& text);

// The parts of loadModel.
std::vector<Material> loadMaterials(const Document& document, Model& model);
/// World matrices of all nodes, and the morph weights that a clip has set.
struct Pose {
  std::vector<glm::dmat4> world;
  std::vector<bool> shown;  ///< part of the default scene
  std::vector<std::vector<double>> weights;
};
Pose poseOf(const Document& document, const std::optional<Moment>& moment);
void addMesh(const Document& document, const Pose& pose, size_t node, Model& model);

}  // namespace weir::oracle
