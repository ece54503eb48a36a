#include "view/panels/graph_edges.h"

#include "view/ui/style.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace weir::view {
namespace {

using Curve = std::array<ImVec2, 4>;

ImVec2 pointAt(const Curve& c, float t) {
  const float u = 1.0f - t;
  const std::array<float, 4> w = {u * u * u, 3.0f * u * u * t, 3.0f * u * t * t, t * t * t};
  ImVec2 p{0.0f, 0.0f};
  for (size_t i = 0; i < c.size(); ++i) p = {p.x + w[i] * c[i].x, p.y + w[i] * c[i].y};
  return p;
}

void drawDashed(ImDrawList& list, const Curve& curve, uint32_t color, float thickness, float low, float high) {
  constexpr float kDash = 4.0f;
  const float length = std::abs(curve[3].y - curve[0].y) + 2.0f * std::abs(curve[1].x - curve[0].x);
  const int pieces = std::clamp(static_cast<int>(length / kDash), 5, 400) | 1;  // odd: dashes at both ends
  ImVec2 from = curve[0];
  for (int i = 1; i <= pieces; ++i) {
    const ImVec2 to = pointAt(curve, static_cast<float>(i) / static_cast<float>(pieces));
    const bool seen = std::max(from.y, to.y) >= low && std::min(from.y, to.y) <= high;
    if (i % 2 == 1 && seen) list.AddLine(from, to, color, thickness);
    from = to;
  }
}

/// The tip of an edge that comes from the side.
void drawTip(ImDrawList& list, const ImVec2& at, float towards, float size, uint32_t color) {
  list.AddTriangleFilled(at, {at.x - towards * size * 1.6f, at.y - size}, {at.x - towards * size * 1.6f, at.y + size},
                         color);
}

uint32_t faded(uint32_t color, float alpha) {
  ImVec4 c = ImGui::ColorConvertU32ToFloat4(color);
  c.w *= alpha;
  return ImGui::ColorConvertFloat4ToU32(c);
}

}  // namespace

void drawEdges(const GraphModel& model, const std::vector<PassAnchors>& anchors, const std::string& highlighted,
               float left, float right) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float low = ImGui::GetWindowPos().y, high = low + ImGui::GetWindowSize().y;
  for (const EdgeModel& edge : model.edges) {
    const PassModel &from = model.passes[edge.from], &to = model.passes[edge.to];
    const PassAnchors &a = anchors[edge.from], &b = anchors[edge.to];
    const float fromY = a.outputs[edge.output], toY = b.inputs[edge.input];
    if (std::max(fromY, toY) < low || std::min(fromY, toY) > high) continue;
    const bool lit = highlighted.empty() || highlighted == from.name || highlighted == to.name;
    const float alpha = (lit ? 0.9f : 0.2f) * (from.enabled && to.enabled ? 1.0f : 0.4f);
    const uint32_t color =
        faded(edge.previous ? palette().warning : seriesColor(static_cast<unsigned>(edge.from)), alpha);
    const float thickness = !highlighted.empty() && lit ? 2.0f : 1.2f;
    // Longer edges keep further from the boxes, so that short ones cross fewer.
    const float span = std::abs(static_cast<float>(edge.to) - static_cast<float>(edge.from));
    const float room = edge.previous ? right : left, side = edge.previous ? 1.0f : -1.0f;
    const float reach = room * (0.35f + 0.6f * span / (span + 2.0f)) * 4.0f / 3.0f;  // a curve gets 3/4 of the way
    const float fromX = edge.previous ? a.box.high.x : a.box.low.x, toX = edge.previous ? b.box.high.x : b.box.low.x;
    const float outer = side < 0.0f ? std::min(fromX, toX) - reach : std::max(fromX, toX) + reach;
    const Curve curve = {ImVec2{fromX, fromY}, ImVec2{outer, fromY}, ImVec2{outer, toY}, ImVec2{toX, toY}};
    if (edge.previous)
      drawDashed(list, curve, color, thickness, low, high);
    else
      list.AddBezierCubic(curve[0], curve[1], curve[2], curve[3], color, thickness, 20);
    drawTip(list, curve[3], -side, 2.5f, color);
  }
}

}  // namespace weir::view
