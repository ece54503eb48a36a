// Where the framework lies, and what lies beside it.
#pragma once

#include <filesystem>

namespace weir {

/// The folder of libweir.so itself.
std::filesystem::path libraryFolder();

/// Where the plugins, manifests and shaders that came with libweir.so lie: the folder `weir` beside it, as after an
/// installation, or its own folder, as in a build tree.
std::filesystem::path resourceFolder();

/// The framework's own shaders: $WEIR_SHADERS/common when set, else shaders/common in resourceFolder(). InputError when
/// absent.
std::filesystem::path commonShaderFolder();

}  // namespace weir
