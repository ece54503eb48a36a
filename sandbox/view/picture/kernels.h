// The compute kernels of this room, one for each way of reading a port and what is done with it.
#pragma once

#include <weir/execute/tool_kernel.h>

#include <array>
#include <memory>
#include <set>
#include <string>

#include "view/picture/channels.h"
#include "view/picture/mode.h"
#include "view/picture/port.h"
#include "view/picture/settings.h"

namespace weir::view {

/// A channel of a port, to be shown or measured.
struct Shown : Port {
  const Channel& channel;
};

/// InputError when the channel is of another port than this, or the port has no memory.
void checkShown(const Shown& shown);

/// What of the settings follows from port and mode. InputError when the mode is out of bounds.
Settings settingsOf(const Shown& shown, const PictureMode& mode);

class Kernels {
 public:
  /// `shader`: the file's name in shaders/view; `target`: an image, or else a buffer, at binding 2. Compiled when first
  /// asked for.
  Kernels(const gpu::Device& device, shader::Compiler& compiler, std::string shader, bool targetIsImage, uint32_t sets);

  /// Throws as ToolKernel does.
  const execute::ToolKernel& of(const Channel& channel, bool f90);
  /// Every file that the shaders so far were read from.
  std::set<std::string> files() const;

 private:
  const gpu::Device& device_;
  shader::Compiler& compiler_;
  std::string shader_;
  bool targetIsImage_;
  uint32_t sets_;
  std::array<std::unique_ptr<execute::ToolKernel>, kReadings + 1> kernels_;  ///< the last one: surfaces with F90
};

/// The port as the first binding.
execute::ToolBinding sourceOf(const Shown& shown);

/// Where the window's shaders lie: `view` beside the common ones.
std::string viewShader(const std::string& name);

}  // namespace weir::view
