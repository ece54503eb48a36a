// An OpenColorIO processor as GLSL and textures that Weir can bind.
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <string>

#include "output/view_transform.h"

namespace weir::passes {

/// InputError when the processor has values that are set at run time; `name` says of what. May throw OCIO::Exception.
ViewTransform shaderText(const OCIO_NAMESPACE::Processor& processor, const std::string& name);

}  // namespace weir::passes
