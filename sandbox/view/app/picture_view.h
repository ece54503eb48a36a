// The picture in the middle of the window: which ports of the graphs are shown, how, and where on the canvas.
#pragma once

#include "view/engine/engine.h"
#include "view/panels/picture_panel.h"
#include "view/picture/port_picture.h"
#include "view/picture/probe.h"
#include "view/picture/range_meter.h"
#include "view/picture/uploaded_picture.h"

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace weir::view {

/// A port that is shown, with all that the panel says of it.
struct ShownSide {
  std::vector<std::string> ports;
  std::string port, what, problem;
  std::vector<Channel> channels;
  size_t channel = 0;
  PictureMode mode;
  uint32_t elements = 1;
  std::optional<Measurement> measured;
  Extent extent;
};

class PictureView {
 public:
  static constexpr uint32_t kSlots = 2;  ///< as the presenter's
  PictureView(const gpu::Device& device, shader::Compiler& compiler);

  /// After the graph or scene changed: what is shown stays if it is still there, else the graph's picture is. Asks the
  /// engine to keep what it shows.
  void follow(Engine& engine);
  /// Any other port, "pass.port" or "pass.port@previous". Throws as compiling does; what was shown then stays.
  void show(Engine& engine, const std::string& port);
  void setChannel(size_t channel);
  void setMode(const PictureMode& mode);
  void resetMode();
  void measure() { measureWanted_ = true; }
  const ShownSide& a() const { return a_; }
  /// A port with the meaning Radiance, to compare radiance with; empty where the graph has none.
  static std::string radiancePort(const graph::CompiledGraph& graph);

  /// The right side: none, the second graph's port of the same name (or its picture), a picture, or a port of somebody
  /// else's that is asked for each frame.
  using Source = std::function<std::optional<execute::Executor::Located>()>;
  void showNothingBeside();
  void showSecond(Engine& engine);
  void showPicture(const gpu::Device& device, const image::Picture& picture, const std::string& name);
  void showSource(Source source, const std::string& name);
  bool beside() const { return kind_ != Beside::Nothing; }
  const std::string& besideName() const { return besideName_; }
  bool split = false;
  float splitAt = 0.5f;  ///< of the picture's width

  // ------------------------------------------------------------------------------------------------ placement
  bool fitted() const { return fitted_; }
  float zoom() const { return placement_.scaleX; }
  void setZoom(float zoom);  ///< canvas pixels for one; 0: fit
  void zoomAbout(glm::vec2 canvasPoint, float factor);
  void move(glm::vec2 canvasPixels);
  std::optional<PixelPlace> pixelAt(glm::vec2 canvasPoint) const;

  /// `rect` of the canvas; `canvas` in VK_IMAGE_LAYOUT_GENERAL. `probe`: a pixel to say in words.
  void compose(VkCommandBuffer commands, uint32_t slot, const gpu::Image& canvas, const Rect& rect, Engine& engine,
               std::optional<PixelPlace> probe);
  const std::vector<Row>& words() const { return words_; }
  /// Every file that the window's shaders were read from.
  std::set<std::string> files() const { return pictures_.files(); }

 private:
  enum class Beside : uint8_t { Nothing, Second, Picture, Source };
  void list();
  /// What the slot's last frame brought: words and measurements.
  void collect(uint32_t slot, const std::vector<scene::GpuLight>& lights);
  bool take(Engine& engine, const std::string& port);
  void drawBeside(VkCommandBuffer commands, const gpu::Image& canvas, const Rect& clip, Engine& engine);

  PortPicture pictures_;
  Probe probe_;
  RangeMeter meter_;
  ShownSide a_;
  std::string wanted_;  ///< asked for by the user; empty: the graph's picture
  const graph::CompiledGraph* graph_ = nullptr;
  Beside kind_ = Beside::Nothing;
  std::string besideName_;
  std::unique_ptr<UploadedPicture> uploaded_;
  Source source_;
  std::vector<Channel> besideChannels_;
  std::tuple<PortKind, uint64_t, Format, Meaning> besideType_{};  ///< that besideChannels_ are of
  Placement placement_;
  bool fitted_ = true, measureWanted_ = false, rangeWanted_ = false;
  float centredScale_ = 0.0f;
  std::vector<Row> words_;
};

}  // namespace weir::view
