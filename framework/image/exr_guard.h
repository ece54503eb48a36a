// A look at an EXR file's headers before the library allocates what they ask for. Internal to framework/image.
#pragma once

#include <cstdio>
#include <string>

namespace weir::image {

/// Walks every header of the file, from its start. Throws InputError where an attribute reaches beyond the end of the
/// file, a data window or tile is beyond the limits of limits.h, or the file holds deep data.
/// Layout: "OpenEXR File Layout" (openexr.com): magic, version and flags, then per part a list of
/// name\0 type\0 int32 size, value; an empty name ends a header, in multi-part files another one ends the list.
void checkExrHeaders(const std::string& path, std::FILE* file);

}  // namespace weir::image
