// The JSON Schema of graph files, for editors: completion, types, ranges and documentation while typing.
#pragma once

#include <weir/graph/compile.h>

#include <string>

namespace weir::graph {

/// One schema over every type that the catalog knows. It says what a schema can; references, layouts and cycles are for
/// compile().
std::string schemaJson(const PassCatalog& catalog);

}  // namespace weir::graph
