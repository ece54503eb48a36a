// How the window looks: one dark scheme, one font.
#pragma once

#include <cstdint>

namespace weir::view {

/// Sets colours and spaces and loads the font for a display of `scale`.
void applyStyle(float scale);

/// Colours of things that stand for something, as ImGui's 32-bit colours.
struct Palette {
  uint32_t good, warning, bad, faint, accent, changed;
};
const Palette& palette();
/// Distinct colours for as many series as there are: passes, settings.
uint32_t seriesColor(unsigned index);

}  // namespace weir::view
