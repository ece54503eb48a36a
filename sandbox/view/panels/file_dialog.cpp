#include "view/panels/overlays.h"

#include "view/ui/style.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace weir::view {
namespace {

namespace fs = std::filesystem;

struct Wording {
  const char* title;
  const char* button;
  std::array<std::string_view, 4> extensions;  ///< of the files that are shown; none: all
};

Wording wordingOf(FileDialog::For purpose) {
  switch (purpose) {
    case FileDialog::For::OpenGraph:
      return {"Open a graph", "Open", {".json"}};
    case FileDialog::For::OpenScene:
      return {"Open a scene", "Open", {".gltf", ".glb"}};
    case FileDialog::For::OpenSecond:
      return {"Compare with a graph or a picture", "Open", {".json", ".exr", ".png"}};
    case FileDialog::For::OpenReference:
      return {"Measure errors against a graph or a picture", "Open", {".json", ".exr", ".hdr"}};
    case FileDialog::For::SaveTrail:
      return {"Save the points as CSV", "Save", {".csv"}};
    case FileDialog::For::SaveGraph:
      return {"Save the graph", "Save", {".json"}};
    case FileDialog::For::SaveShot:
      return {"Save the picture (.exr, .png)", "Save", {".exr", ".png"}};
    default:
      return {"Frames as PNG files into a folder", "Write", {"/"}};
  }
}

Request requestFor(const FileDialog& dialog) {
  switch (dialog.purpose) {
    case FileDialog::For::OpenGraph:
      return OpenGraph{dialog.path};
    case FileDialog::For::OpenScene:
      return OpenScene{dialog.path};
    case FileDialog::For::OpenSecond:
      return OpenSecond{dialog.path};
    case FileDialog::For::OpenReference:
      return SetReference{dialog.path};
    case FileDialog::For::SaveTrail:
      return SaveTrail{dialog.path};
    case FileDialog::For::SaveGraph:
      return SaveGraph{dialog.path};
    case FileDialog::For::SaveShot:
      return SaveShot{dialog.path};
    default:
      return SaveSequence{dialog.path, static_cast<uint32_t>(dialog.frames)};
  }
}

bool shown(const std::string& name, const Wording& wording) {
  return std::ranges::any_of(wording.extensions, [&](std::string_view e) { return !e.empty() && name.ends_with(e); });
}

}  // namespace

void FileDialog::open(For what, const std::string& start) {
  purpose = what;
  path = start;
  const fs::path parent = fs::path(start).parent_path();
  enter(parent.empty() ? "." : parent.string());
}

void FileDialog::enter(const std::string& folderPath) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(folderPath, error);
  folder = error ? folderPath : whole.string();
  folders.clear();
  files.clear();
  problem.clear();
  fs::directory_iterator entries(folder, fs::directory_options::skip_permission_denied, error);
  const Wording wording = wordingOf(purpose);
  constexpr size_t kMost = 5000;
  for (const fs::directory_iterator end; !error && entries != end && folders.size() + files.size() < kMost;
       entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    std::error_code ignored;
    if (name.starts_with(".")) continue;
    if (entries->is_directory(ignored))
      folders.push_back(name);
    else if (shown(name, wording))
      files.push_back(name);
  }
  if (error) problem = folder + ": " + error.message();
  std::ranges::sort(folders);
  std::ranges::sort(files);
}

Requests drawFileDialog(Ui& ui, glm::vec2 window, FileDialog& dialog) {
  Requests requests;
  if (dialog.purpose == FileDialog::For::None) return requests;
  const Marks::Scope scope(ui.marks, "file");
  const Wording wording = wordingOf(dialog.purpose);
  ImGui::SetNextWindowPos({window.x * 0.5f, window.y * 0.5f}, ImGuiCond_Appearing, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::min(560.0f * ui.scale, window.x), std::min(420.0f * ui.scale, window.y)},
                           ImGuiCond_Appearing);
  bool open = true, done = false;
  if (ImGui::Begin(wording.title, &open, ImGuiWindowFlags_NoCollapse)) {
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-90.0f * ui.scale);
    done = ImGui::InputText("##path", &dialog.path, ImGuiInputTextFlags_EnterReturnsTrue);
    ui.marks.last("path");
    ImGui::SameLine();
    done |= ImGui::Button(wording.button);
    ui.marks.last("done");
    if (dialog.purpose == FileDialog::For::SaveSequence) {
      ImGui::SetNextItemWidth(120.0f * ui.scale);
      ImGui::InputInt("frames", &dialog.frames);
      ui.marks.last("frames");
      dialog.frames = std::clamp(dialog.frames, 1, 1000000);
    }
    ImGui::TextDisabled("%s", dialog.folder.c_str());
    if (!dialog.problem.empty()) ImGui::TextColored(ImColor(palette().bad), "%s", dialog.problem.c_str());
    ImGui::BeginChild("entries", {0.0f, 0.0f}, true);
    std::string entered;
    if (ImGui::Selectable("../")) entered = (fs::path(dialog.folder) / "..").string();
    ui.marks.last("up");
    for (const std::string& name : dialog.folders) {
      if (ImGui::Selectable((name + "/").c_str())) entered = (fs::path(dialog.folder) / name).string();
      ui.marks.last(name);
    }
    for (const std::string& name : dialog.files) {
      const std::string whole = (fs::path(dialog.folder) / name).string();
      if (ImGui::Selectable(name.c_str(), whole == dialog.path)) dialog.path = whole;
      ui.marks.last(name);
    }
    ImGui::EndChild();
    if (!entered.empty()) {
      dialog.enter(entered);
      if (dialog.purpose == FileDialog::For::SaveSequence) dialog.path = dialog.folder;
    }
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)) &&
        ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows))
      open = false;
  }
  ImGui::End();
  if (done && !dialog.path.empty()) requests.push_back(requestFor(dialog));
  if (!open || (done && !dialog.path.empty())) dialog.purpose = FileDialog::For::None;
  return requests;
}

}  // namespace weir::view
