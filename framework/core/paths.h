// Where the framework lies, and what lies beside it.
#pragma once

#include <filesystem>

namespace weir {

/// The folder of libweir.so itself.
std::filesystem::path libraryFolder();

/// The framework's own shaders: $WEIR_SHADERS/common when set, else shaders/common beside the library. InputError when
/// absent.
std::filesystem::path commonShaderFolder();

}  // namespace weir
