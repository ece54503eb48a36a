// Words beside widgets, as all panels show them.
#pragma once

#include <cstdint>
#include <string>

namespace weir::view {

/// A tooltip over the last widget, also where that is disabled. None for an empty text.
void hint(const std::string& text);
/// Text over as many lines as it takes, in a colour of the palette. `right`: where lines end, in the window's own
/// coordinates; 0: where the window ends.
void wrapped(const std::string& text, uint32_t color, float right = 0.0f);

}  // namespace weir::view
