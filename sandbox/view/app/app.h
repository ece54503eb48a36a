// The window's main loop: events, panels, requests, a frame of the graph, a frame of the window. What is asked for is
// carried out in app_requests.cpp, and what is drawn is in app_panels.cpp.
#pragma once

#include "view/app/options.h"
#include "view/app/picture_view.h"
#include "view/app/recent_files.h"
#include "view/app/scene_loader.h"
#include "view/compare/comparison.h"
#include "view/document/document.h"
#include "view/document/edits.h"
#include "view/document/model.h"
#include "view/engine/camera_control.h"
#include "view/engine/engine.h"
#include "view/engine/messages.h"
#include "view/input/script.h"
#include "view/panels/graph_panel.h"
#include "view/panels/layout.h"
#include "view/panels/overlays.h"
#include "view/panels/requests.h"
#include "view/panels/scene_panel.h"
#include "view/panels/time_panel.h"
#include "view/ui/platform.h"
#include "view/window/presenter.h"

#include <weir/pass/registry.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace weir::view {

class App {
 public:
  explicit App(const ViewOptions& options);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  void run();

 private:
  using Clock = std::chrono::steady_clock;

  // app.cpp
  void frame();
  void drawUi();
  void renderFrame();
  void present();
  void followFiles(bool now);
  void followScene();
  void followSize();
  std::vector<execute::FrameTimes> takeTimes();
  glm::uvec2 wantedSize() const;
  /// Runs what a user asked for; what goes wrong is a message of that topic.
  template <typename Work>
  bool guard(const std::string& topic, Work work);
  void graphChanged();
  void sceneChanged();
  void startScript();
  void writeMeasurement(const std::string& file);
  std::string title() const;

  // app_events.cpp
  void handle(const Event& event);
  void handleKey(const Event& event);
  void handleShortcut(const Event& event);
  void handleMouse(const Event& event);
  void handleDrop(const std::vector<std::string>& files);
  void fly(double seconds);
  bool overPicture(glm::vec2 at) const;
  glm::vec2 toCanvas(glm::vec2 at) const;

  // app_panels.cpp
  Requests drawMenu(Ui& ui);
  void drawFileMenu(Ui& ui, Requests& requests);
  void drawTimeMenu(Ui& ui, Requests& requests);
  Requests drawPanels(Ui& ui);
  Requests drawSide(Ui& ui);
  void drawPictureTab(Ui& ui, Requests& requests);
  void drawCompareTab(Ui& ui, Requests& requests);
  void drawGraph(Ui& ui);
  void drawSplitLine(Ui& ui);

  // app_compare.cpp
  /// References that come with Weir, where they are found: what they are of, and the file.
  static std::vector<std::pair<std::string, std::string>> bundledReferences();
  void compare(bool isNew, const std::vector<execute::FrameTimes>& times);
  void setReference(const std::string& file);
  void showReference();
  void tellTurned(const Edit& edit, const std::string& before);
  std::string valueOf(const Edit& edit) const;

  // app_requests.cpp
  void carryOut(const Request& request);
  void carryOutEdit(const Edit& edit);
  /// What the document says runs from now on, if it compiles.
  void runDocument();
  void openGraph(const std::string& file);
  void openScene(const std::string& file);
  void openSecond(const std::string& file);
  bool saveGraph(const std::string& file);
  void saveShot(const std::string& file);
  void writeOutput(const std::string& output, const std::string& file);
  void chooseCamera(int index);
  void reloadStage(const render::StageOptions& options);
  void continueSequence();
  std::string renderCommandText();
  void writeOutputsAtEnd();

  ViewOptions options_;
  Marks marks_;
  Messages messages_;
  WindowSystem system_;
  Window window_;
  Registry registry_;
  gpu::Device device_;
  shader::Compiler compiler_;
  Document document_;
  graph::PassCatalog catalog_;
  std::unique_ptr<UiPlatform> platform_;
  std::unique_ptr<Presenter> presenter_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<PictureView> picture_;
  std::unique_ptr<CameraControl> camera_;
  std::unique_ptr<Comparison> comparison_;  ///< refers to the engine's scene: it goes before that
  std::string referenceFile_;
  ComparisonState comparisonState_;
  int comparisonAge_ = 0;
  bool showsReference_ = false;
  std::vector<std::pair<std::string, std::string>> references_;  ///< that come with Weir: what of, and file
  SceneLoader loader_;
  RecentFiles recent_;
  std::unique_ptr<ScriptPlayer> script_;

  // What panels show.
  float scale_ = 1.0f, menuHeight_ = 20.0f;
  LayoutState layoutState_;
  Layout layout_;
  GraphModel graphModel_;
  GraphPanelState graphState_;
  std::vector<Problem> graphProblems_;
  std::string choicesOf_;  ///< a pass whose types the next model should list
  TimeLog times_;
  SceneModel sceneModel_;
  ScenePanelState sceneState_;
  std::vector<bool> canMove_;
  FileDialog files_;
  bool help_ = false, asksToClose_ = false, quit_ = false;
  bool closes_ = false;  ///< once the graph is saved
  Requests requests_;
  std::vector<Edit> edits_;

  // The mouse on the picture.
  glm::vec2 mouse_{0.0f};
  enum class Drag : uint8_t { None, Orbit, Look, Pan, Move, Split };
  Drag drag_ = Drag::None;
  Modifiers held_;
  std::set<Key> keys_;
  std::optional<PixelPlace> pinned_;
  std::optional<std::string> shownPort_;  ///< asked for in a panel

  // Size of the pictures: it follows the window once that is still.
  float renderScale_ = 1.0f;
  glm::uvec2 fixedSize_{0}, askedSize_{0};
  int stillFrames_ = 0;

  // A sequence that is being written.
  struct Sequence {
    std::string folder;
    uint32_t frames = 0, next = 0;
  };
  std::optional<Sequence> sequence_;

  std::string shotFile_;
  Clock::time_point lastFrame_ = Clock::now(), lastPoll_ = Clock::now();
  double frameSeconds_ = 0.0;
  float framesPerSecond_ = 0.0f;
};

}  // namespace weir::view
