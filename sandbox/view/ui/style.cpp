#include "view/ui/style.h"

#include <imgui.h>

#include <array>
#include <filesystem>

namespace weir::view {
namespace {

void colours(ImGuiStyle& style) {
  ImGui::StyleColorsDark(&style);
  const ImVec4 panel(0.105f, 0.115f, 0.13f, 0.97f), field(0.18f, 0.195f, 0.22f, 1.0f),
      hover(0.25f, 0.275f, 0.31f, 1.0f), accent(0.16f, 0.47f, 0.62f, 1.0f), bright(0.22f, 0.60f, 0.78f, 1.0f);
  const auto set = [&style](ImGuiCol_ which, const ImVec4& colour) { style.Colors[which] = colour; };
  set(ImGuiCol_WindowBg, panel);
  set(ImGuiCol_PopupBg, ImVec4(0.09f, 0.10f, 0.115f, 0.99f));
  set(ImGuiCol_FrameBg, field);
  set(ImGuiCol_FrameBgHovered, hover);
  set(ImGuiCol_FrameBgActive, hover);
  set(ImGuiCol_TitleBg, panel);
  set(ImGuiCol_TitleBgActive, field);
  set(ImGuiCol_MenuBarBg, panel);
  set(ImGuiCol_Button, field);
  set(ImGuiCol_ButtonHovered, accent);
  set(ImGuiCol_ButtonActive, bright);
  set(ImGuiCol_Header, field);
  set(ImGuiCol_HeaderHovered, accent);
  set(ImGuiCol_HeaderActive, bright);
  set(ImGuiCol_SliderGrab, accent);
  set(ImGuiCol_SliderGrabActive, bright);
  set(ImGuiCol_CheckMark, bright);
  set(ImGuiCol_Tab, panel);
  set(ImGuiCol_TabHovered, accent);
  set(ImGuiCol_TabActive, field);
  set(ImGuiCol_Separator, ImVec4(0.3f, 0.32f, 0.35f, 0.6f));
}

}  // namespace

void applyStyle(float scale) {
  ImGuiStyle style;
  colours(style);
  style.WindowRounding = 0.0f;
  style.FrameRounding = 3.0f;
  style.GrabRounding = 3.0f;
  style.TabRounding = 3.0f;
  style.WindowPadding = {8.0f, 6.0f};
  style.FramePadding = {5.0f, 2.0f};
  style.ItemSpacing = {6.0f, 4.0f};
  style.IndentSpacing = 14.0f;
  style.ScrollbarSize = 11.0f;
  style.WindowBorderSize = 1.0f;
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;

  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  // Latin, and the Greek, arrows and mathematics that units and parameters are written with.
  static constexpr std::array<ImWchar, 13> kGlyphs = {0x20,   0xff,   0x370,  0x3ff,  0x2010, 0x2030, 0x207b,
                                                      0x2089, 0x2190, 0x2193, 0x2208, 0x226a, 0};
  constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  std::error_code ignored;
  // Without the font's package the built-in one serves, which has Latin alone.
  if (!std::filesystem::exists(kFont, ignored) ||
      atlas.AddFontFromFileTTF(kFont, 13.5f * scale, nullptr, kGlyphs.data()) == nullptr) {
    ImFontConfig config;
    config.SizePixels = 13.0f * scale;
    atlas.AddFontDefault(&config);
  }
  atlas.Build();
}

const Palette& palette() {
  static constexpr Palette kPalette = {IM_COL32(120, 200, 120, 255), IM_COL32(235, 190, 90, 255),
                                       IM_COL32(240, 110, 100, 255), IM_COL32(150, 155, 165, 255),
                                       IM_COL32(70, 175, 220, 255),  IM_COL32(255, 205, 110, 255)};
  return kPalette;
}

uint32_t seriesColor(unsigned index) {
  // Okabe and Ito's colours, which people with any colour vision can tell apart, on a dark ground.
  static constexpr std::array<uint32_t, 8> kColors = {IM_COL32(86, 180, 233, 255),  IM_COL32(230, 159, 0, 255),
                                                      IM_COL32(0, 158, 115, 255),   IM_COL32(240, 228, 66, 255),
                                                      IM_COL32(204, 121, 167, 255), IM_COL32(213, 94, 0, 255),
                                                      IM_COL32(0, 114, 178, 255),   IM_COL32(190, 190, 190, 255)};
  return kColors[index % kColors.size()];
}

}  // namespace weir::view
