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

/// The mean over the area that each texel of the next level covers.
template <typename Level>
Level halved(const Level& from) {
  Level to{std::max(1u, from.width / 2), std::max(1u, from.height / 2), {}};
  const double sx = double(from.width) / to.width, sy = double(from.height) / to.height;
  for (uint32_t y = 0; y < to.height; ++y) {
    for (uint32_t x = 0; x < to.width; ++x) {
      glm::dvec4 sum(0.0);
      for (auto j = static_cast<int64_t>(y * sy); j < from.height && double(j) < (y + 1) * sy; ++j) {
        for (auto i = static_cast<int64_t>(x * sx); i < from.width && double(i) < (x + 1) * sx; ++i) {
          sum += overlap(x * sx, (x + 1) * sx, i) * overlap(y * sy, (y + 1) * sy, j) / (sx * sy) *
                 from.texels[static_cast<size_t>(j) * from.width + static_cast<size_t>(i)];
        }
      }
      to.texels.push_back(sum);
    }
  }
  return to;
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
  // Exact levels have colours multiplied by what they count for; those that are read are divided and rounded.
  Level exact{image.width, image.height, {}}, read = exact;
  const auto counts = [&](double alpha) { return t.content.weightByAlpha ? 1.0 / 256 + alpha * 255 / 256 : 1.0; };
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    glm::dvec4 c;
    for (size_t k = 0; k < 4; ++k) c[static_cast<int>(k)] = image.rgba[i + k] / 255.0;
    for (int k = 0; k < 3 && t.content.srgb; ++k) c[k] = oracleSrgbToLinear(c[k]);
    read.texels.push_back(c);
    exact.texels.emplace_back(glm::dvec3(c) * counts(c.a), c.a);
  }
  levels.push_back(read);
  if (t.mipFilter == scene::MipFilter::None) return levels;
  const auto round = [](double code) { return std::floor(std::clamp(code, 0.0, 1.0) * 255.0 + 0.5) / 255.0; };
  while (exact.texels.size() > 1) {
    exact = halved(exact);
    read = exact;
    for (glm::dvec4& c : read.texels) {
      c = glm::dvec4(glm::dvec3(c) / counts(c.a), c.a);
      for (int k = 0; k < 4; ++k) {
        c[k] = t.content.srgb && k < 3 ? oracleSrgbToLinear(round(linearToSrgb(c[k]))) : round(c[k]);
      }
    }
    levels.push_back(read);
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
