// The `weir render` that gives the picture of a view.
#pragma once

#include "view/document/document.h"

#include <weir/graph/compile.h>
#include <weir/render/render.h>

#include <optional>
#include <string>
#include <vector>

namespace weir::view {

/// As a POSIX shell reads it: one word, whatever is in it.
std::string shellQuoted(const std::string& word);

struct RenderCommand {
  std::string text;  ///< one line
  /// Not empty: why the graph must be written to its file first for the command to mean this graph.
  std::string saveFirst;
  std::vector<std::string> unsaid;  ///< what of the view no option can say, in words
};

/// `view` has everything but the graph: scene, size, frames, seed, outputs, device. Edits since the graph was loaded
/// become --set, --enable and --disable where these can say them. `camera`: the window's; without one, the view's own
/// words. `graphFile`: the caller writes the document's text there, so that the command names it and no edits.
RenderCommand renderCommand(const Document& document, const graph::PassCatalog& catalog,
                            const render::RenderOptions& view, const std::optional<scene::Camera>& camera,
                            const std::optional<std::string>& graphFile = std::nullopt);

}  // namespace weir::view
