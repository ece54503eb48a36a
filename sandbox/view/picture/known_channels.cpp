#include "view/picture/known_channels.h"

#include "../../../passes/common/layouts.h"

namespace weir::view {

bool isPackedSurface(const Layout& layout) {
  static const uint64_t hash = layoutOf<passes::PackedSurface>().hash;
  return layout.hash == hash;
}

bool isReservoir(const Layout& layout) {
  static const uint64_t hash = layoutOf<passes::Reservoir>().hash;
  return layout.hash == hash;
}

std::vector<Channel> surfaceChannels(bool f90) {
  std::vector<Channel> all{
      {.name = "shading normal",
       .doc = "x, y, z as red, green, blue; world space",
       .shows = Shows::Color,
       .low = -1.0f,
       .code = 3},
      {.name = "geometric normal",
       .doc = "Of the triangle, facing the viewer; x, y, z as red, green, blue",
       .shows = Shows::Color,
       .low = -1.0f,
       .code = 4},
      {.name = "distance",
       .doc = "From the camera along the ray",
       .unit = "m",
       .high = 10.0f,
       .guessed = true,
       .code = 1},
      {.name = "position",
       .doc = "World space; x, y, z as red, green, blue",
       .unit = "m",
       .shows = Shows::Color,
       .low = -1.0f,
       .guessed = true,
       .code = 2},
      {.name = "base colour",
       .doc = "Of a metallic-roughness material of IOR 1.5 with this diffuse albedo and F0",
       .shows = Shows::Color,
       .encoded = true,
       .code = 9},
      {.name = "metallic", .doc = "Likewise, by luminance", .code = 8},
      {.name = "roughness", .doc = "Of the material; alpha is its square", .code = 7},
      {.name = "diffuse albedo", .doc = "c_diff of glTF 2.0", .shows = Shows::Color, .encoded = true, .code = 5},
      {.name = "F0", .doc = "Reflectance at normal incidence", .shows = Shows::Color, .encoded = true, .code = 6},
      {.name = "facing", .doc = "Cosine between shading normal and view", .code = 10},
      {.name = "sample place",
       .doc = "Where in the pixel it was sampled; 0.5: its centre",
       .unit = "px",
       .shows = Shows::Color,
       .code = 11},
      {.name = "hit", .doc = "Green: a surface, grey: background", .shows = Shows::State, .code = 0},
  };
  if (f90) all.push_back({.name = "F90", .doc = "Reflectance at grazing angles", .code = 12});
  for (Channel& c : all) c.reading = Reading::Surface;
  return all;
}

std::vector<Channel> reservoirChannels() {
  std::vector<Channel> all{
      {.name = "light",
       .doc = "Which light its sample is of: each in a colour of its own",
       .shows = Shows::Label,
       .code = 1},
      {.name = "W",
       .doc = "Unbiased contribution weight, in m\u00b2 on triangles; 0: no sample",
       .guessed = true,
       .logarithmic = true,
       .code = 3},
      {.name = "M", .doc = "Confidence, in fresh frames", .unit = "frames", .high = 20.0f, .guessed = true, .code = 4},
      {.name = "state",
       .doc = "Dark: empty. Blue: confidence without a sample. Grey: a sample. Green: seen by its shadow ray. Red: "
              "hidden in the last frame",
       .shows = Shows::State,
       .code = 0},
      {.name = "place",
       .doc = "Where on the light: both coordinates of the unit square as red and green",
       .shows = Shows::Color,
       .code = 2},
  };
  for (Channel& c : all) c.reading = Reading::Reservoir;
  return all;
}

}  // namespace weir::view
