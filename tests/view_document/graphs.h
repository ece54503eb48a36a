// The bundled graphs and their real types, for tests of what edits them.
#pragma once

#include "view/document/document.h"
#include "view/document/swap.h"

#include <weir/graph/compile.h>
#include <weir/pass/registry.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/device.h"

namespace weir::view::test {

using weir::test::binaryPath;
using weir::test::sourcePath;
using weir::test::TemporaryFolder;

inline std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::vector<std::string> bundledGraphs() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(sourcePath("graphs")))
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::out_of_range("no '" + from + "' in the text");
  return text.replace(at, from.size(), to);
}

class Graphs : public ::testing::Test {
 protected:
  Document restir() const { return Document::load(sourcePath("graphs/restir_di.json")); }
  std::vector<graph::Diagnostic> findings(const Document& document) {
    std::vector<graph::Diagnostic> found;
    graph::compile(document.description(), catalog, 64, 64, found);
    return found;
  }
  graph::CompiledGraph compiled(const Document& document) {
    return graph::compileText(document.text(), document.file(), {}, catalog, {.width = 64, .height = 64});
  }

  Registry registry{{std::filesystem::path(binaryPath("bin"))}};
  graph::PassCatalog catalog = registry.catalog();
  SwapContext context{catalog, 64, 64};
  TemporaryFolder folder;
};

}  // namespace weir::view::test
