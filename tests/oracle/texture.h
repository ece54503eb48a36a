// Images as a sampler of glTF sees them: sRGB decoded before filtering, bilinear, wrapped, with levels of detail that
// are means over areas of the level before (docs/gltf.md, "Levels of detail").
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace weir::oracle {

/// An encoded picture's texels, 8 bits each.
struct Image {
  int width = 0, height = 0;
  std::vector<std::array<uint8_t, 4>> texels;
};
/// PNG or JPEG. Throws InputError that begins with `name`.
Image decodeImage(const std::vector<unsigned char>& bytes, const std::string& name);

enum class Wrap : unsigned char { Repeat, Clamp, Mirror };

struct Sampling {
  Wrap s = Wrap::Repeat, t = Wrap::Repeat;
  bool nearest = false;  ///< when magnified
  bool nearestMinified = false;
  bool levels = true;  ///< has levels at all
  bool nearestLevel = false;
};

/// An image with the use that is made of it.
class Texture {
 public:
  /// `colour`: RGB are sRGB codes. `weighted`: colours count as much as their alpha in the means.
  Texture(const Image& image, const Sampling& sampling, bool colour, bool weighted);

  /// λ <= 0 magnifies. RGBA, linear.
  glm::dvec4 at(const glm::dvec2& uv, double level = 0.0) const;
  double texels() const { return static_cast<double>(sizes_[0].x) * sizes_[0].y; }

 private:
  glm::dvec4 texel(size_t level, int x, int y) const;
  glm::dvec4 filtered(size_t level, const glm::dvec2& uv, bool nearest) const;
  void addLevel(bool weighted);

  const Image* image_;
  Sampling sampling_;
  bool colour_;
  std::vector<glm::ivec2> sizes_;
  std::vector<std::vector<glm::vec4>> levels_;  ///< from level 1 on
};

}  // namespace weir::oracle
