// What `weir view` is asked for on the command line.
#pragma once

#include <weir/render/render.h>

#include <glm/glm.hpp>
#include <optional>
#include <string>

namespace weir::view {

struct ViewOptions {
  render::RenderOptions render;  ///< graph, overrides, scene, seed, outputs to write at the end, device, …
  bool sizeGiven = false;        ///< pictures of render.width x render.height, whatever the window's size
  bool framesGiven = false;      ///< pauses after render.frames
  glm::ivec2 window{1600, 900};  ///< window coordinates
  std::string script;            ///< file; empty: none
  std::string pacing = "vsync";  ///< or "newest", "immediate"
  float scale = 0.0f;            ///< of fonts and spaces; 0: the display's own
  std::string reference;         ///< graph or picture that errors are measured against; empty: none yet
  std::string second;            ///< graph or picture for the right side; empty: none
};

/// Opens the window and returns when it is closed. Throws InputError, graph::GraphError, RuntimeError: what is wrong
/// with the command line, the machine or a script; what the user does in the window never ends it.
void view(const ViewOptions& options);

}  // namespace weir::view
