// `--lights N`: see addGeneratedLights in lights.h for the formula.
#include <weir/core/error.h>
#include <weir/scene/lights.h>

namespace weir::scene {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection on 64 bits, so counters never collide.
uint64_t mix(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Number `dimension` of light `index`, uniform in [0,1), 24 bits so that it is exact in a float.
float uniform(uint32_t seed, uint32_t index, uint32_t dimension) {
  const uint64_t key = mix(mix(seed) ^ index) + dimension;
  return static_cast<float>(mix(key) >> 40) * 0x1p-24f;
}

}  // namespace

void addGeneratedLights(Scene& scene, uint32_t count, uint32_t seed) {
  if (count == 0) return;
  const Bounds bounds = worldBounds(scene);
  if (bounds.empty) throw InputError(scene.path + ": no geometry to spread lights in");
  const double radius = bounds.radius();

  std::vector<glm::vec3> colours(count);
  double total = 0.0;
  for (uint32_t i = 0; i < count; ++i) {
    colours[i] = {uniform(seed, i, 3), uniform(seed, i, 4), uniform(seed, i, 5)};
    total += luminance(colours[i]);
  }
  if (!(total > 0.0)) throw InputError("light seed " + std::to_string(seed) + " gives black lights only");
  const double scale = kGeneratedIntensity * radius * radius / total;

  scene.lights.reserve(scene.lights.size() + count);
  for (uint32_t i = 0; i < count; ++i) {
    PunctualLight light;
    light.kind = LightKind::Point;
    light.intensity = glm::vec3(glm::dvec3(colours[i]) * scale);
    light.position =
        glm::mix(bounds.low, bounds.high, glm::vec3(uniform(seed, i, 0), uniform(seed, i, 1), uniform(seed, i, 2)));
    scene.lights.push_back(light);
  }
}

}  // namespace weir::scene
