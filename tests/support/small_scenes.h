// Small scenes built in memory, and cameras that look at them.
#pragma once

#include <weir/scene/scene.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace weir::test {

inline scene::Camera lookAt(const glm::vec3& eye, const glm::vec3& target, float degrees = 60.0f) {
  scene::Camera camera;
  camera.eye = eye;
  camera.forward = glm::normalize(target - eye);
  const glm::vec3 horizon = std::abs(camera.forward.y) > 0.99f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  camera.up = glm::normalize(horizon - camera.forward * glm::dot(horizon, camera.forward));
  camera.verticalFov = glm::radians(degrees);
  return camera;
}

/// Corners counter-clockwise as seen from the front; texture coordinates (0,1) (1,1) (1,0) (0,0).
inline scene::Primitive quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
                             int material = -1) {
  scene::Primitive p;
  p.positions = {a, b, c, d};
  const glm::vec3 normal = glm::normalize(glm::cross(b - a, d - a));
  p.normals = {normal, normal, normal, normal};
  p.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  p.indices = {0, 1, 2, 0, 2, 3};
  p.material = material;
  return p;
}

/// Unit sphere with smooth normals that point outwards; u goes round, v from pole to pole.
inline scene::Primitive sphere(uint32_t rings, uint32_t segments, int material = -1) {
  scene::Primitive p;
  for (uint32_t r = 0; r <= rings; ++r) {
    for (uint32_t s = 0; s <= segments; ++s) {
      const float u = static_cast<float>(s) / static_cast<float>(segments);
      const float v = static_cast<float>(r) / static_cast<float>(rings);
      const float theta = 3.14159265f * v, phi = 6.28318531f * u;
      const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      p.positions.push_back(n);
      p.normals.push_back(glm::normalize(n));
      p.uv0.emplace_back(u, v);
    }
  }
  const uint32_t row = segments + 1;
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < segments; ++s) {
      const uint32_t a = r * row + s, b = a + row;
      if (r + 1 < rings) p.indices.insert(p.indices.end(), {a, b, b + 1});
      if (r > 0) p.indices.insert(p.indices.end(), {a, b + 1, a + 1});
    }
  }
  p.material = material;
  return p;
}

/// A scene under construction; every method that adds something returns its index.
struct Builder {
  scene::Scene scene;

  Builder() { scene.path = "built in memory"; }
  int material(const scene::Material& m) {
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
  }
  int mesh(std::vector<scene::Primitive> primitives) {
    scene.meshes.push_back({"", std::move(primitives)});
    return static_cast<int>(scene.meshes.size()) - 1;
  }
  void place(int mesh, const glm::mat4& toWorld = glm::mat4(1.0f)) { scene.instances.push_back({mesh, -1, toWorld}); }
  void add(scene::Primitive primitive, const glm::mat4& toWorld = glm::mat4(1.0f)) {
    place(mesh({std::move(primitive)}), toWorld);
  }
  /// An image by a function of its texels, with a sampler.
  int texture(uint32_t width, uint32_t height, const std::function<glm::u8vec4(uint32_t, uint32_t)>& texel,
              scene::Filter filter = scene::Filter::Linear, scene::Wrap wrap = scene::Wrap::Repeat) {
    scene::Image image{"image " + std::to_string(scene.images.size()), width, height, {}};
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        const glm::u8vec4 t = texel(x, y);
        image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
      }
    }
    scene.images.push_back(std::move(image));
    scene.textures.push_back({static_cast<int>(scene.images.size()) - 1, wrap, wrap, filter, filter});
    return static_cast<int>(scene.textures.size()) - 1;
  }
};

/// Numbers that look random and are the same on every machine.
inline uint32_t hashOf(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}
/// Uniform in [0, 1).
inline double uniformOf(uint32_t x) {
  return hashOf(x) / 4294967296.0;
}

/// Everything times a factor: lights that fall off with the square of the distance grow with it, so pictures stay
/// alike.
inline scene::Scene scaled(scene::Scene scene, float factor) {
  for (scene::Instance& i : scene.instances) {
    for (int c = 0; c < 4; ++c) i.toWorld[c] *= glm::vec4(glm::vec3(factor), 1.0f);
  }
  for (scene::PunctualLight& light : scene.lights) {
    light.position *= factor;
    light.range *= factor;
    if (light.kind != scene::LightKind::Directional) light.intensity *= factor * factor;
  }
  for (scene::Camera& camera : scene.cameras) camera.eye *= factor;
  return scene;
}

}  // namespace weir::test
