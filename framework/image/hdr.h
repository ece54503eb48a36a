// Radiance .hdr pictures, as most environment maps are.
#pragma once

#include <weir/image/image.h>

#include <string>

namespace weir::image {

/// RGBE texels, flat or run-length coded in either way, divided by the header's EXPOSURE and COLORCORR, so in the unit
/// that was written (nit for environments). Row 0 is the top whatever the file's order. Throws InputError: no Radiance
/// picture, XYZE, columns before rows, too short, runs that leave their scan line, beyond the limits of limits.h.
Picture readHdr(const std::string& path);

}  // namespace weir::image
