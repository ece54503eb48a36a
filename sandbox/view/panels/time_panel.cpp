#include "view/panels/time_panel.h"

#include "view/ui/style.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace weir::view {
namespace {

/// A column of the window a frame, the newest at the right; passes from below in the order in which they run.
void drawStack(const TimeLog& log, const ImVec2& low, const ImVec2& high) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(low, high, IM_COL32(14, 16, 19, 255), 2.0f);
  const float width = (high.x - low.x) / static_cast<float>(TimeLog::kFrames);
  const float scale = (high.y - low.y) / log.longest();
  const size_t series = log.passes().size() + 1;
  // One rectangle for frames that are alike next to each other would be fewer, but the list is cheap as it is.
  draw.PushClipRect(low, high, true);
  draw.PrimReserve(0, 0);
  for (size_t back = 0; back < log.size(); ++back) {
    const float x = high.x - static_cast<float>(back + 1) * width;
    float y = high.y;
    for (size_t p = 0; p < series; ++p) {
      const float height = log.gpu(back, p) * scale;
      if (height < 0.05f) continue;
      const float top = std::max(y - height, low.y);
      draw.PrimReserve(6, 4);
      draw.PrimRect({x, top}, {x + width, y}, seriesColor(static_cast<unsigned>(p)));
      y = top;
      if (y <= low.y) break;
    }
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g ms", static_cast<double>(log.longest()));
  draw.AddText({low.x + 4.0f, low.y + 1.0f}, palette().faint, text.data());
  draw.PopClipRect();
}

void legend(Ui& ui, const TimeLog& log) {
  const size_t series = log.passes().size() + 1;
  if (!ImGui::BeginTable("passes", 4, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_ScrollY)) return;
  ImGui::TableSetupColumn("pass", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("median");
  ImGui::TableSetupColumn("p95");
  ImGui::TableSetupColumn("now");
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  const auto row = [&](unsigned index, const char* name, const TimeLog::Figures& figures, float now) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = 8.0f * ui.scale;
    if (index != ~0u)
      ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 3.0f * ui.scale},
                                                {at.x + side, at.y + 3.0f * ui.scale + side}, seriesColor(index));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + side + 4.0f * ui.scale);
    ImGui::TextUnformatted(name);
    ui.marks.last(name);
    for (const float value : {figures.median, figures.p95, now}) {
      ImGui::TableNextColumn();
      ImGui::Text("%.3f", static_cast<double>(value));
    }
  };
  const bool any = log.size() > 0;
  row(~0u, "frame", log.gpuFigures(), any ? log.gpuFrame(0) : 0.0f);
  for (unsigned p = 0; p < series; ++p) {
    const bool isScene = p + 1 == series;
    if (isScene && log.passFigures()[p].p95 <= 0.0f) continue;  // nothing moves
    row(p, isScene ? "(scene)" : log.passes()[p].c_str(), log.passFigures()[p], any ? log.gpu(0, p) : 0.0f);
  }
  ImGui::EndTable();
}

void bytes(const char* what, uint64_t count) {
  ImGui::Text("%-9s %8.1f MB", what, static_cast<double>(count) * 1e-6);
}

void figures(Ui& ui, const TimePanelModel& model, Requests& requests) {
  const TimeLog& log = *model.log;
  ImGui::Text("frame %u%s  %.1f/s", model.frames, model.paused ? " (paused)" : "",
              static_cast<double>(model.framesPerSecond));
  ui.marks.last("frame-number");
  ImGui::Text("CPU record %.3f ms", static_cast<double>(log.cpuFigures().median));
  ImGui::Text("CPU window %.3f ms", static_cast<double>(log.uiFigures().median));
  bool count = model.countsRays;
  if (ImGui::Checkbox("rays", &count)) requests.push_back(SetCountRays{count});
  ui.marks.last("count-rays");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Counts rays: an atomic add each, so that times are longer");
  if (model.countsRays) {
    ImGui::SameLine();
    ImGui::Text("%.3f M", static_cast<double>(model.rays) * 1e-6);
  }
  bytes("transient", model.transientBytes);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("%.1f MB more if nothing shared memory", static_cast<double>(model.savedBytes) * 1e-6);
  bytes("history", model.historyBytes);
  bytes("scene", model.sceneBytes);
  ImGui::TextDisabled("%s", model.device.c_str());
}

}  // namespace

Requests drawTimePanel(Ui& ui, const Rectangle& where, const TimePanelModel& model) {
  Requests requests;
  if (where.size().x < 1.0f || where.size().y < 1.0f) return requests;
  const Marks::Scope scope(ui.marks, "times");
  ImGui::SetNextWindowPos({where.low.x, where.low.y});
  ImGui::SetNextWindowSize({where.size().x, where.size().y});
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                      ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus;
  if (ImGui::Begin("times", nullptr, kFixed)) {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float left = 165.0f * ui.scale, right = std::min(285.0f * ui.scale, room.x * 0.45f);
    ImGui::BeginChild("figures", {left, 0.0f});
    figures(ui, model, requests);
    ImGui::EndChild();
    ImGui::SameLine();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float width = std::max(room.x - left - right - 16.0f * ui.scale, 10.0f);
    drawStack(*model.log, low, {low.x + width, low.y + room.y});
    ImGui::Dummy({width, room.y});
    ui.marks.last("plot");
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip(
          "%s", model.log->hasGpu() ? "GPU milliseconds of the last 300 frames, by pass" : "This device has no timers");
    ImGui::SameLine();
    ImGui::BeginChild("legend", {0.0f, 0.0f});
    legend(ui, *model.log);
    ImGui::EndChild();
  }
  ImGui::End();
  return requests;
}

}  // namespace weir::view
