// What a texture lookup gives, in double precision: sRGB, wrapping, filters and levels from glTF 2.0 and Vulkan 1.3,
// chapter "Image Operations". Levels are means by area over the level before, before that is rounded.
#pragma once

#include <weir/scene/prepared.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <vector>

namespace weir::test {

double oracleSrgbToLinear(double code);

class TextureOracle {
 public:
  TextureOracle(const scene::Scene& scene, const scene::PreparedScene& prepared) : scene_(scene), prepared_(prepared) {}

  /// Texture `index` of PreparedScene::textures at transformed coordinates; `level` as textureLod takes it.
  glm::dvec4 sample(int32_t index, glm::dvec2 uv, double level = 0.0) const;
  glm::uvec2 size(int32_t index) const;
  uint32_t levels(int32_t index) const;
  /// One decoded texel of a level.
  glm::dvec4 texel(int32_t index, uint32_t level, int64_t x, int64_t y) const;

 private:
  struct Level {
    uint32_t width, height;
    std::vector<glm::dvec4> texels;
  };
  const std::vector<Level>& chain(int32_t index) const;
  glm::dvec4 filtered(int32_t index, uint32_t level, glm::dvec2 uv, scene::Filter filter) const;

  const scene::Scene& scene_;
  const scene::PreparedScene& prepared_;
  mutable std::map<int32_t, std::vector<Level>> chains_;
};

}  // namespace weir::test
