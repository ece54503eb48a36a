#include "view/panels/layout.h"

#include <algorithm>

namespace weir::view {

Layout layoutOf(glm::vec2 window, float menuHeight, float scale, const LayoutState& state) {
  const float top = state.all ? menuHeight : 0.0f;
  float left = state.all && state.graph ? state.graphWidth * scale : 0.0f;
  float right = state.all && state.side ? state.sideWidth * scale : 0.0f;
  const float room = window.x * (2.0f / 3.0f);
  if (left + right > room) {
    const float shrink = room / (left + right);
    left *= shrink;
    right *= shrink;
  }
  const float bottom = state.all && state.times ? std::min(state.timesHeight * scale, (window.y - top) * 0.4f) : 0.0f;
  Layout layout;
  layout.graph = {{0.0f, top}, {left, window.y}};
  layout.side = {{window.x - right, top}, {window.x, window.y}};
  layout.times = {{left, window.y - bottom}, {window.x - right, window.y}};
  layout.picture = {{left, top}, {window.x - right, window.y - bottom}};
  return layout;
}

}  // namespace weir::view
