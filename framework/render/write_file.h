// Text files that appear whole or not at all.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace weir::render {

/// InputError when no file can be put there: said before hours of work rather than after.
void checkWritable(const std::string& path);
/// A file on the command line: the option that names it, and its path (empty: none).
using NamedPath = std::pair<std::string, std::string>;
/// InputError when an output is another output or an input, by whatever name.
void checkDistinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs);
/// Temporary file beside it, then renamed. Throws RuntimeError.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace weir::render
