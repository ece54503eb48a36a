#include "support/texture_oracle.h"

#include <algorithm>
#include <cmath>

namespace weir::test {
namespace {

double linearToSrgb(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

/// Index of a texel after the sampler's wrap mode.
int64_t wrapped(int64_t i, int64_t size, scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::ClampToEdge:
      return std::clamp<int64_t>(i, 0, size - 1);
    case scene::Wrap::MirroredRepeat: {
      const int64_t m = ((i % (2 * size)) + 2 * size) % (2 * size);
      return m < size ? m : 2 * size - 1 - m;
    }
    default:
      return ((i % size) + size) % size;
  }
}

/// How much of [low, high) lies in texel i.
double overlap(double low, double high, int64_t i) {
  return std::max(0.0, std::min(high, static_cast<double>(i) + 1) - std::max(low, static_cast<double>(i)));
}

}  // namespace

double oracleSrgbToLinear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

glm::uvec2 TextureOracle::size(int32_t index) const {
  const scene::Image& image = scene_.images[prepared_.textures[index].image];
  return {image.width, image.height};
}

uint32_t TextureOracle::levels(int32_t index) const {
  return static_cast<uint32_t>(chain(index).size());
}

const std::vector<TextureOracle::Level>& TextureOracle::chain(int32_t index) const {
  std::vector<Level>& levels = chains_[index];
  if (!levels.empty()) return levels;
  const scene::PreparedTexture& t = prepared_.textures[index];
  const scene::Image& image = scene_.images[t.image];
  Level base{image.width, image.height, {}};
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    glm::dvec4 c;
    for (size_t k = 0; k < 4; ++k) c[static_cast<int>(k)] = image.rgba[i + k] / 255.0;
    for (int k = 0; k < 3 && t.content.srgb; ++k) c[k] = oracleSrgbToLinear(c[k]);
    base.texels.push_back(c);
  }
  levels.push_back(base);
  if (t.mipFilter == scene::MipFilter::None) return levels;
  const auto round = [](double code) { return std::floor(std::clamp(code, 0.0, 1.0) * 255.0 + 0.5) / 255.0; };
  for (uint32_t shift = 1; std::max(image.width, image.height) >> shift != 0; ++shift) {
    Level level{std::max(1u, image.width >> shift), std::max(1u, image.height >> shift), {}};
    const double sx = double(image.width) / level.width, sy = double(image.height) / level.height;
    for (uint32_t y = 0; y < level.height; ++y) {
      for (uint32_t x = 0; x < level.width; ++x) {
        glm::dvec4 sum(0.0);
        double colour = 0.0;
        for (auto j = static_cast<int64_t>(y * sy);
             j < std::min<int64_t>(image.height, std::llround(std::ceil((y + 1) * sy))); ++j) {
          for (auto i = static_cast<int64_t>(x * sx);
               i < std::min<int64_t>(image.width, std::llround(std::ceil((x + 1) * sx))); ++i) {
            const double area = overlap(x * sx, (x + 1) * sx, i) * overlap(y * sy, (y + 1) * sy, j) / (sx * sy);
            const glm::dvec4 c = base.texels[static_cast<size_t>(j) * image.width + static_cast<size_t>(i)];
            const double weight = area * (t.content.weightByAlpha ? 1.0 / 256 + c.a * 255 / 256 : 1.0);
            sum += glm::dvec4(glm::dvec3(c) * weight, c.a * area);
            colour += weight;
          }
        }
        sum = glm::dvec4(glm::dvec3(sum) / colour, sum.a);
        for (int k = 0; k < 4; ++k) {
          sum[k] = t.content.srgb && k < 3 ? oracleSrgbToLinear(round(linearToSrgb(sum[k]))) : round(sum[k]);
        }
        level.texels.push_back(sum);
      }
    }
    levels.push_back(level);
  }
  return levels;
}

glm::dvec4 TextureOracle::texel(int32_t index, uint32_t level, int64_t x, int64_t y) const {
  const scene::PreparedTexture& t = prepared_.textures[index];
  const Level& l = chain(index)[level];
  return l.texels[static_cast<size_t>(wrapped(y, l.height, t.wrapT) * l.width + wrapped(x, l.width, t.wrapS))];
}

glm::dvec4 TextureOracle::filtered(int32_t index, uint32_t level, glm::dvec2 uv, scene::Filter filter) const {
  const Level& l = chain(index)[level];
  const glm::dvec2 p = uv * glm::dvec2(l.width, l.height);
  if (filter == scene::Filter::Nearest) {
    return texel(index, level, static_cast<int64_t>(std::floor(p.x)), static_cast<int64_t>(std::floor(p.y)));
  }
  const glm::dvec2 base = glm::floor(p - 0.5), f = p - 0.5 - base;
  const auto x = static_cast<int64_t>(base.x), y = static_cast<int64_t>(base.y);
  const auto at = [&](int64_t i, int64_t j) { return texel(index, level, x + i, y + j); };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), f.x), glm::mix(at(0, 1), at(1, 1), f.x), f.y);
}

glm::dvec4 TextureOracle::sample(int32_t index, glm::dvec2 uv, double level) const {
  const scene::PreparedTexture& t = prepared_.textures[index];
  if (!(level > 0.0)) return filtered(index, 0, uv, t.magFilter);
  if (t.mipFilter == scene::MipFilter::None) return filtered(index, 0, uv, t.minFilter);
  const double most = levels(index) - 1.0, clamped = std::min(level, most);
  if (t.mipFilter == scene::MipFilter::Nearest) {
    return filtered(index, static_cast<uint32_t>(std::ceil(clamped + 0.5) - 1.0), uv, t.minFilter);
  }
  const auto low = static_cast<uint32_t>(std::floor(clamped));
  const uint32_t high = std::min(low + 1, levels(index) - 1);
  return glm::mix(filtered(index, low, uv, t.minFilter), filtered(index, high, uv, t.minFilter), clamped - low);
}

}  // namespace weir::test
