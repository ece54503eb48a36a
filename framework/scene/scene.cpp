// Bounds and cameras of a plain scene, and its summary.
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/scene/prepare_motion.h>
#include <weir/scene/prepared.h>
#include <weir/scene/scene.h>

#include <cmath>
#include <cstdlib>

namespace weir::scene {

void Bounds::add(const glm::vec3& p) {
  // A vertex that is not finite belongs to a triangle that will be dropped.
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return;
  low = empty ? p : glm::min(low, p);
  high = empty ? p : glm::max(high, p);
  empty = false;
}

Bounds worldBounds(const Scene& scene) {
  Bounds bounds;
  const MotionPlan plan(scene, nullptr);
  for (const Instance& instance : scene.instances) {
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
      glm::dmat4 toWorld(instance.toWorld);
      const auto add = [&](const Primitive& shape) {
        for (const glm::vec3& p : shape.positions) bounds.add(glm::vec3(toWorld * glm::dvec4(glm::dvec3(p), 1.0)));
      };
      if (deforms(scene, instance, primitive))
        add(plan.restShape(instance, primitive, toWorld));
      else
        add(primitive);
    }
  }
  return bounds;
}

Camera framingCamera(const Bounds& bounds, float aspect) {
  Camera camera;
  camera.name = "framing";
  const glm::vec3 half = bounds.empty ? glm::vec3(1.0f) : (bounds.high - bounds.low) * 0.5f;
  const float slope = std::tan(camera.verticalFov * 0.5f);
  // The front face of the box just fits, with a twentieth to spare; a scene that is one point gets a metre.
  float distance = std::max(half.y, half.x / aspect) / slope;
  if (!(distance > 0.0f)) distance = half.z > 0.0f ? half.z : 1.0f;
  camera.eye = bounds.centre() + glm::vec3(0.0f, 0.0f, half.z + 1.05f * distance);
  return camera;
}

namespace {

/// "a,b,c,..." to numbers; an empty result when any part is not a finite number.
std::vector<float> parseNumbers(const std::string& text) {
  std::vector<float> numbers;
  for (const char* at = text.c_str();;) {
    char* end = nullptr;
    const float value = std::strtof(at, &end);
    if (end == at || !std::isfinite(value)) return {};
    numbers.push_back(value);
    while (*end == ' ') ++end;
    if (*end == 0) return numbers;
    if (*end != ',') return {};
    at = end + 1;
  }
}

Camera lookAt(const std::vector<float>& n) {
  Camera camera;
  camera.name = "command line";
  camera.eye = {n[0], n[1], n[2]};
  const glm::dvec3 way = glm::dvec3(n[3], n[4], n[5]) - glm::dvec3(camera.eye);
  if (!(glm::length(way) > 0.0)) throw InputError("--camera: eye and target are the same point");
  const glm::dvec3 forward = glm::normalize(way);
  // Straight up or down has no horizon: -Z takes the place of up.
  const bool vertical = std::abs(forward.y) > 0.9999999;
  const glm::dvec3 horizon = vertical ? glm::dvec3(0.0, 0.0, -1.0) : glm::dvec3(0.0, 1.0, 0.0);
  camera.forward = glm::vec3(forward);
  camera.up = glm::vec3(glm::normalize(horizon - forward * glm::dot(horizon, forward)));
  if (n.size() == 7) {
    if (!(n[6] > 0.0f && n[6] < 180.0f))
      throw InputError("--camera: the field of view must lie between 0 and 180 degrees");
    camera.verticalFov = glm::radians(n[6]);
  }
  return camera;
}

}  // namespace

Camera chooseCamera(const Scene& scene, const std::string& text, float aspect, const Bounds* bounds) {
  if (text.empty() && scene.cameras.empty()) return framingCamera(bounds ? *bounds : worldBounds(scene), aspect);
  if (text.empty()) return scene.cameras.front();
  std::vector<std::string> names;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == text) return camera;
    names.push_back(camera.name);
  }
  const std::vector<float> numbers = parseNumbers(text);
  if (numbers.size() == 6 || numbers.size() == 7) return lookAt(numbers);
  std::string message =
      "--camera \"" + text + "\": neither a camera of " + scene.path + " nor ex,ey,ez,tx,ty,tz[,vfov]";
  if (const std::string near = nearestName(text, names); !near.empty()) {
    message += "; did you mean \"" + near + "\"?";
  } else if (!names.empty()) {
    message += "; its cameras are";
    for (size_t i = 0; i < names.size() && i < 8; ++i) message += (i ? ", \"" : " \"") + names[i] + "\"";
  }
  throw InputError(message);
}

SceneSummary summarize(const Scene& scene) {
  SceneSummary s;
  std::vector<uint64_t> perMesh;
  for (const Mesh& mesh : scene.meshes) {
    uint64_t triangles = 0;
    for (const Primitive& primitive : mesh.primitives) {
      const uint64_t count = primitive.indices.size() / 3;
      triangles += count;
      s.vertices += primitive.positions.size();
      s.coloredPrimitives += !primitive.colors.empty();
      if (primitive.material >= 0 && scene.materials[primitive.material].isEmissive()) s.emissiveTriangles += count;
    }
    s.primitives += static_cast<uint32_t>(mesh.primitives.size());
    s.storedTriangles += triangles;
    perMesh.push_back(triangles);
  }
  for (const Instance& instance : scene.instances) s.instancedTriangles += perMesh[instance.mesh];
  for (const Material& material : scene.materials) {
    s.maskedMaterials += material.alphaMode == AlphaMode::Mask;
    s.blendMaterials += material.alphaMode == AlphaMode::Blend;
    s.glossyMaterials += material.model == MaterialModel::SpecularGlossiness;
    s.unlitMaterials += material.model == MaterialModel::Unlit;
    for (const TextureSlot* slot : material.slots()) s.uvTransforms += *slot && !slot->transform.isIdentity();
  }
  for (const PunctualLight& light : scene.lights) {
    s.pointLights += light.kind == LightKind::Point;
    s.spotLights += light.kind == LightKind::Spot;
    s.directionalLights += light.kind == LightKind::Directional;
  }
  s.meshes = static_cast<uint32_t>(scene.meshes.size());
  s.instances = static_cast<uint32_t>(scene.instances.size());
  s.materials = static_cast<uint32_t>(scene.materials.size());
  s.textures = static_cast<uint32_t>(scene.textures.size());
  s.images = static_cast<uint32_t>(scene.images.size());
  s.cameras = static_cast<uint32_t>(scene.cameras.size());
  s.animations = static_cast<uint32_t>(scene.clips.size());
  s.bounds = worldBounds(scene);
  return s;
}

}  // namespace weir::scene
