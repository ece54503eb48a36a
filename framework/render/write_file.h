// Text files that appear whole or not at all.
#pragma once

#include <string>

namespace weir::render {

/// InputError when nothing can be written there: said before hours of work rather than after.
void checkWritable(const std::string& path);
/// Temporary file beside it, then renamed. Throws RuntimeError.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace weir::render
