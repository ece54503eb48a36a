// What the command line changes, as an edit of the document: what is saved is then what was seen.
#pragma once

#include "view/document/document.h"

#include <weir/graph/compile.h>

namespace weir::view {

/// --set, --enable and --disable as one step of undo. GraphError with what is wrong with them; the document is then as
/// it was. What else is wrong with the graph is not looked at.
void applyOverrides(Document& document, const graph::Overrides& overrides, const graph::PassCatalog& catalog);

}  // namespace weir::view
