// What is wrong with a graph: every finding has a place, and all are reported together.
#pragma once

#include <weir/core/error.h>

#include <string>
#include <vector>

namespace weir::graph {

struct Diagnostic {
  std::string file;          ///< or "--set", "--enable", … for what the command line said
  int line = 0;              ///< 1-based; 0 where there is none
  std::string path;          ///< "passes.spatial.params.neighbours"
  std::string message;       ///< what is wrong and what was expected
  std::string nearest;       ///< the nearest valid name, or empty
  std::string text() const;  ///< "file:12: passes.spatial.…: unknown parameter 'neighbors' (nearest: 'neighbours')"
};

/// Thrown when there is at least one; what() holds all of them, a line each.
class GraphError : public InputError {
 public:
  explicit GraphError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace weir::graph
