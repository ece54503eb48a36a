// Draws a channel of a port into the window's canvas, on the device and in every frame. Recording allocates nothing
// once each kind of port has been drawn.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "view/picture/kernels.h"
#include "view/picture/placement.h"

namespace weir::view {

/// An RGBA8 storage image in VK_IMAGE_LAYOUT_GENERAL; its values are what the screen shows, encoded sRGB.
struct Canvas {
  VkImageView view = VK_NULL_HANDLE;
  uint32_t width = 0, height = 0;
};

/// Where on the canvas.
struct Target {
  Canvas canvas;
  Placement placement;
  /// What alone is written, background where the picture isn't: all of the canvas pixels of it, and no others. Two of
  /// them side by side split the canvas between two ports.
  Rect clip;
  uint32_t background = 0xff1c1c1cu;  ///< RGBA8, red in the lowest byte
};

class PortPicture {
 public:
  /// `slots`: frames that may be alive on the device at once. `draws`: in each of them, at most.
  PortPicture(const gpu::Device& device, shader::Compiler& compiler, uint32_t slots = 2, uint32_t draws = 8);

  /// Begins a frame; what was recorded in the last one of this slot must be done on the device.
  void begin(uint32_t slot);
  /// Records one picture, with barriers before and after it: everything earlier on the queue is waited for, and
  /// everything later waits. Empty clips record nothing. InputError: the channel is of another port, mode or placement
  /// are out of bounds, or there were more than `draws`. A kind of port that is drawn for the first time is compiled:
  /// shader::CompileError.
  void draw(VkCommandBuffer commands, const Shown& shown, const PictureMode& mode, const Target& target);

  /// Every file that the shaders so far were read from.
  std::set<std::string> files() const { return kernels_.files(); }

 private:
  uint32_t draws_, slot_ = 0, drawn_ = 0;
  Kernels kernels_;
  std::vector<gpu::Buffer> settings_;  ///< by slot and draw
};

}  // namespace weir::view
