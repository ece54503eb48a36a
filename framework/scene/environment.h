// Light from all around: a picture of the whole sphere of directions, and the table that picks directions from it.
//
// The picture is equirectangular: columns are longitudes, rows latitudes, +Y at the top. Its middle shows -Z, a quarter
// of its width to the right of that +X: what a camera without rotation sees when it turns to the right. A direction d
// lies at  u = 1/2 + (atan2(d.x, -d.z) + rotation) / 2π,  v = acos(d.y) / π.
// Radiance between the texels' centres is interpolated linearly, round the seam and constant beyond the first and last
// row's. Everything that asks for it asks for that one function, so that estimators and backgrounds agree.
#pragma once

#include <weir/image/image.h>

#include <cstdint>
#include <string>
#include <vector>

namespace weir::scene {

struct Environment {
  std::string path;  ///< as given by the user
  uint32_t width = 0, height = 0;
  /// RGBA, half floats, row 0 (+Y) at the top; the largest lies in [2^14, 2^15), so that as many of the dark ones as
  /// can be keep their precision. Empty: there is none, or it is black all over.
  std::vector<uint16_t> texels;
  float unit = 1.0f;      ///< nit of a texel value of 1, a power of two
  float rotation = 0.0f;  ///< radians about +Y, counter-clockwise as seen from above
  uint64_t mended = 0;    ///< texels that were negative or not finite and count as black
  bool shines() const { return !texels.empty(); }
};

/// Texels times `scale`, 0 or more, rounded to half floats. What is negative, infinite or no number becomes 0.
Environment makeEnvironment(const image::Picture& picture, float scale = 1.0f, float rotation = 0.0f);

/// An OpenEXR or Radiance file. Throws InputError: a file that can't be read, a PNG, a scale that is negative or not
/// finite, a rotation that is not finite.
Environment readEnvironment(const std::string& path, float scale, float degrees);

/// A cell of the table: an alias cell (Vose 1991), and steradian / probability of what it stands for: the reciprocal of
/// the density of directions in it.
struct EnvironmentCell {
  float threshold = 1.0f;
  uint32_t alias = 0;
  float spread = 0.0f;
};
static_assert(sizeof(EnvironmentCell) == 12);

/// Cells are blocks of block² texels (fewer at the right and lower end), row by row. A cell is picked in proportion to
/// ∫ luminance dω over it, the interpolated radiance's, so that every direction with light has a density; within the
/// cell directions are uniform in solid angle.
struct EnvironmentTable {
  uint32_t columns = 0, rows = 0, block = 1;
  std::vector<EnvironmentCell> cells;  ///< empty when the environment doesn't shine
  double integral = 0.0;               ///< ∫ luminance dω over the sphere: nit · sr
};

/// At most `mostCells` cells, and no more than 65536 a side: a place on the environment has 16 bits a side.
EnvironmentTable tabulate(const Environment& environment, uint64_t mostCells = uint64_t{1} << 21);

/// What stands before the cells on the device, 32 bytes.
struct GpuEnvironment {
  uint32_t columns = 0, rows = 0, block = 1, width = 0, height = 0;
  float unit = 1.0f, rotation = 0.0f;
  uint32_t pad = 0;
};
static_assert(sizeof(GpuEnvironment) == 32);

}  // namespace weir::scene
