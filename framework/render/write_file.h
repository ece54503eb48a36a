// Text files that appear whole or not at all.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace weir::render {

/// InputError when nothing can be written there: said before hours of work rather than after. A device, a pipe or a
/// folder is no place for a file that appears whole or not at all. Links are followed.
void checkWritable(const std::string& path);

using NamedPath = std::pair<std::string, std::string>;  ///< what it is to the user, such as "--json", and the path
/// InputError when an output would replace another output, or something that is read. Paths that are spelt in another
/// way, or lead through links, are the same when they end at one place. Empty ones don't count.
void requireDistinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs);
/// Temporary file beside it, then renamed. Throws RuntimeError.
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace weir::render
