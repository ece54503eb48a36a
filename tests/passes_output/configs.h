// Configs for tests, written into a temporary folder: lookup tables of every kind, and a foreign scene_linear.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "support/device.h"

namespace weir::test {

/// A curve of `length` entries over [0, 1], unlike in each channel.
inline std::string curve1D(int length) {
  std::string text = fmt::format("Version 1\nFrom 0.0 1.0\nLength {}\nComponents 3\n{{\n", length);
  for (int i = 0; i < length; ++i) {
    const double x = i / double(length - 1);
    text += fmt::format("{:.7f} {:.7f} {:.7f}\n", std::pow(x, 0.5), std::pow(x, 0.6), 0.9 * x + 0.1 * x * x);
  }
  return text + "}\n";
}

/// A twist of colours, coarse enough that a filter's precision shows.
inline std::string cube3D(int edge) {
  std::string text = fmt::format("LUT_3D_SIZE {}\n", edge);
  for (int b = 0; b < edge; ++b) {
    for (int g = 0; g < edge; ++g) {
      for (int r = 0; r < edge; ++r) {
        const double n = edge - 1, x = r / n, y = g / n, z = b / n;
        text += fmt::format("{:.7f} {:.7f} {:.7f}\n", x * x * (1 - 0.3 * z), std::sqrt(y) * (0.8 + 0.2 * x),
                            0.1 + 0.9 * z * (1 - 0.5 * y));
      }
    }
  }
  return text;
}

/// Views "curve" (1D), "long" (1D, more entries than a texture is wide), "nearest", "cube" (3D), "tetrahedra", "both",
/// "live" (with a property meant to be set at run time).
inline std::string lutConfig(const TemporaryFolder& folder) {
  folder.write("luts/curve.spi1d", curve1D(17));
  folder.write("luts/long.spi1d", curve1D(9001));
  folder.write("luts/twist.cube", cube3D(5));
  folder.write("luts/live.ctf",
               "<?xml version=\"1.0\"?>\n<ProcessList version=\"1.5\" id=\"1\">\n"
               "<ExposureContrast inBitDepth=\"32f\" outBitDepth=\"32f\" style=\"linear\">\n"
               "<ECParams exposure=\"1.0\" contrast=\"1.0\" gamma=\"1.0\" pivot=\"0.18\" />\n"
               "<DynamicParameter param=\"EXPOSURE\" />\n</ExposureContrast>\n</ProcessList>\n");
  std::string views, spaces;
  auto add = [&](const char* name, const std::string& transforms) {
    views += fmt::format("    - !<View> {{name: {0}, colorspace: {0}}}\n", name);
    spaces +=
        fmt::format("  - !<ColorSpace>\n    name: {}\n    from_scene_reference: !<GroupTransform>\n      children:\n{}",
                    name, transforms);
  };
  auto file = [](const char* name, const char* interpolation) {
    return fmt::format("        - !<FileTransform> {{src: {}, interpolation: {}}}\n", name, interpolation);
  };
  add("curve", file("curve.spi1d", "linear"));
  add("long", file("long.spi1d", "linear"));
  add("nearest", file("curve.spi1d", "nearest"));
  add("cube", file("twist.cube", "linear"));
  add("tetrahedra", file("twist.cube", "tetrahedral"));
  add("both", file("curve.spi1d", "linear") + file("twist.cube", "best"));
  add("live", file("live.ctf", "linear"));
  return folder.write("luts.ocio",
                      "ocio_profile_version: 2\nsearch_path: luts\nroles: {scene_linear: lin, default: lin}\n"
                      "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
                      "displays:\n  screen:\n" +
                          views + "colorspaces:\n  - !<ColorSpace> {name: lin}\n" + spaces);
}

/// A config whose scene_linear isn't Weir's, with (or without) the role that says how the two relate.
inline std::string foreignConfig(const TemporaryFolder& folder, bool interchange) {
  const char* spaces = R"(file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: plain, colorspace: plain}
    - !<View> {name: untouched, colorspace: untouched}
colorspaces:
  - !<ColorSpace> {name: AP0}
  - !<ColorSpace>
    name: AP1
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: plain
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
        - !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace> {name: untouched, isdata: true}
)";
  return folder.write(
      "foreign.ocio",
      fmt::format("ocio_profile_version: 2\nsearch_path: \"\"\nroles: {{scene_linear: AP1, default: AP1{}}}\n{}",
                  interchange ? ", aces_interchange: AP0" : "", spaces));
}

}  // namespace weir::test
