// The channels of layouts that Weir knows, in the terms of the field. Codes as in shaders/view/read_surface.glsl and
// read_reservoir.glsl.
#pragma once

#include <vector>

#include "view/picture/channels.h"

namespace weir::view {

std::vector<Channel> surfaceChannels(bool f90);
std::vector<Channel> reservoirChannels();

}  // namespace weir::view
