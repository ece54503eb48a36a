#include "texture.h"

#include <weir/core/error.h>

#include <algorithm>
#include <cmath>

// A copy of its own, so that nothing of the framework's is linked.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace weir::oracle {
namespace {

/// IEC 61966-2-1.
double linearOf(int code) {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> t{};
    for (int i = 0; i < 256; ++i) {
      const double c = i / 255.0;
      t[static_cast<size_t>(i)] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return t;
  }();
  return table[static_cast<size_t>(code)];
}

int wrapped(int i, int side, Wrap wrap) {
  const auto modulo = [](int a, int b) { return ((a % b) + b) % b; };
  if (wrap == Wrap::Clamp) return std::clamp(i, 0, side - 1);
  if (wrap == Wrap::Repeat) return modulo(i, side);
  const int j = modulo(i, 2 * side);
  return j < side ? j : 2 * side - 1 - j;
}

}  // namespace

Image decodeImage(const std::vector<unsigned char>& bytes, const std::string& name) {
  Image image;
  int channels = 0;
  stbi_uc* texels =
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &image.width, &image.height, &channels, 4);
  if (texels == nullptr) throw InputError(name + ": " + stbi_failure_reason());
  image.texels.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  for (size_t i = 0; i < image.texels.size(); ++i)
    for (size_t c = 0; c < 4; ++c) image.texels[i][c] = texels[4 * i + c];
  stbi_image_free(texels);
  return image;
}

Texture::Texture(const Image& image, const Sampling& sampling, bool colour, bool weighted)
    : image_(&image), sampling_(sampling), colour_(colour), sizes_{{image.width, image.height}} {
  while (sampling_.levels && (sizes_.back().x > 1 || sizes_.back().y > 1)) addLevel(weighted);
}

/// Each texel is the mean over the area that it covers of the level before, which need not be whole texels.
void Texture::addLevel(bool weighted) {
  const glm::ivec2 from = sizes_.back(), to = glm::max(from / 2, glm::ivec2(1));
  const size_t before = sizes_.size() - 1;
  std::vector<glm::vec4> level(static_cast<size_t>(to.x) * static_cast<size_t>(to.y));
  const glm::dvec2 step = glm::dvec2(from) / glm::dvec2(to);
  for (int y = 0; y < to.y; ++y) {
    for (int x = 0; x < to.x; ++x) {
      const glm::dvec2 low = step * glm::dvec2(x, y), high = low + step;
      glm::dvec3 light(0), plain(0);
      double alpha = 0, area = 0;
      for (int j = static_cast<int>(low.y); j < std::min(from.y, static_cast<int>(std::ceil(high.y - 1e-9))); ++j) {
        for (int i = static_cast<int>(low.x); i < std::min(from.x, static_cast<int>(std::ceil(high.x - 1e-9))); ++i) {
          const double part = (std::min(high.x, i + 1.0) - std::max(low.x, double(i))) *
                              (std::min(high.y, j + 1.0) - std::max(low.y, double(j)));
          const glm::dvec4 t = texel(before, i, j);
          light += part * t.a * glm::dvec3(t);
          plain += part * glm::dvec3(t);
          alpha += part * t.a;
          area += part;
        }
      }
      const glm::dvec3 mean = weighted && alpha > 0 ? light / alpha : plain / area;
      level[static_cast<size_t>(y * to.x + x)] = glm::vec4(mean, alpha / area);
    }
  }
  levels_.push_back(std::move(level));
  sizes_.push_back(to);
}

glm::dvec4 Texture::texel(size_t level, int x, int y) const {
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(sizes_[level].x) + static_cast<size_t>(x);
  if (level > 0) return levels_[level - 1][i];
  const std::array<uint8_t, 4>& t = image_->texels[i];
  if (colour_) return {linearOf(t[0]), linearOf(t[1]), linearOf(t[2]), t[3] / 255.0};
  return glm::dvec4(t[0], t[1], t[2], t[3]) / 255.0;
}

glm::dvec4 Texture::filtered(size_t level, const glm::dvec2& uv, bool nearest) const {
  const glm::ivec2 size = sizes_[level];
  const auto fetch = [&](int x, int y) {
    return texel(level, wrapped(x, size.x, sampling_.s), wrapped(y, size.y, sampling_.t));
  };
  // Far from the origin an integer can't count texels.
  const glm::dvec2 p = glm::clamp(uv, -1e6, 1e6) * glm::dvec2(size) - (nearest ? 0.0 : 0.5);
  const glm::dvec2 floor = glm::floor(p), f = p - floor;
  const int x = static_cast<int>(floor.x), y = static_cast<int>(floor.y);
  if (nearest) return fetch(x, y);
  return glm::mix(glm::mix(fetch(x, y), fetch(x + 1, y), f.x), glm::mix(fetch(x, y + 1), fetch(x + 1, y + 1), f.x),
                  f.y);
}

glm::dvec4 Texture::at(const glm::dvec2& uv, double level) const {
  if (!(level > 0.0)) return filtered(0, uv, sampling_.nearest);
  const double last = static_cast<double>(sizes_.size() - 1), l = std::min(level, last);
  if (sampling_.nearestLevel) return filtered(static_cast<size_t>(std::lround(l)), uv, sampling_.nearestMinified);
  const auto low = static_cast<size_t>(l);
  const glm::dvec4 a = filtered(low, uv, sampling_.nearestMinified);
  const double f = l - static_cast<double>(low);
  return f > 0.0 ? glm::mix(a, filtered(low + 1, uv, sampling_.nearestMinified), f) : a;
}

}  // namespace weir::oracle
