// A pixel of a port in words.
#pragma once

#include <weir/scene/lights.h>

#include <span>
#include <string>
#include <vector>

#include "view/picture/probe.h"

namespace weir::view {

struct Row {
  std::string label, text;  ///< text: with its unit
};

/// What a pixel holds: channels of an image, a surface and its material, reservoirs with their lights, else the fields
/// of the layout. `lights`: the scene's, by the frame that was probed (PreparedScene::lights or SceneState::lights);
/// without them lights are numbers alone. Where a pixel has several elements, labels begin with their number.
std::vector<Row> wordsOf(const Probed& probed, std::span<const scene::GpuLight> lights);

/// As words show numbers: six digits, "NaN", "infinity".
std::string numberText(float value);

}  // namespace weir::view
