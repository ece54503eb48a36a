// A display and view of an OpenColorIO config as GLSL. Needs no device.
// Source: OpenColorIO 2 (opencolorio.org), its GPU path; ACES 1.0 SDR output transform of the Academy, built into it.
#pragma once

#include <weir/pass/pass.h>

#include <string>
#include <utility>
#include <vector>

namespace weir::passes {

/// What to show a picture with. Empty texts take the defaults.
struct ViewChoice {
  std::string config;   ///< a file, from the current folder or else `folder`; "": $OCIO, else weir; "weir": built in
  std::string display;  ///< "": the config's default
  std::string view;     ///< "": the display's default
  std::string space;    ///< colour space of the picture; "": linear Rec.709, see makeViewTransform
  std::string folder;   ///< where a config that isn't in the current folder is looked for, too
};

struct ViewTransform {
  /// Defines `vec4 viewTransform(vec4)`; reads texture_<name> of each texture below.
  std::string glsl;
  std::vector<std::pair<std::string, TextureData>> textures;  ///< 1D lookup tables are 2D textures
};

/// InputError, naming the choices and the nearest: a config that can't be read, no such display, view or space, or a
/// transform that wants values set at run time.
///
/// Pictures are linear Rec.709, whatever the config's own scene_linear is (ACEScg in most). With an empty `space` the
/// way into the config is its role aces_interchange; without one, a space with one of the usual names of linear
/// Rec.709; without that, its role scene_linear as it is. A view of data ("Raw") gets the picture untouched.
ViewTransform makeViewTransform(const ViewChoice& choice);

/// Weir's own config: displays sRGB and Rec.1886, views "ACES SDR", "Standard" (the display's curve alone) and "Raw".
std::string builtInConfig();

}  // namespace weir::passes
