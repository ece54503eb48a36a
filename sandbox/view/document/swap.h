// Another type for a pass: which types fit where it stands, and what else changes with the type.
#pragma once

#include "view/document/document.h"

#include <weir/graph/compile.h>

#include <cstdint>
#include <string>
#include <vector>

namespace weir::view {

/// What passes there are, and the frame that a graph must compile for.
struct SwapContext {
  const graph::PassCatalog& catalog;
  uint32_t width = 64, height = 64;
};

struct SwapPlan {
  std::string pass, from, type;
  bool outputsFit = false;  ///< everything that is read of the pass, the type has too
  bool possible = false;
  std::string reason;                       ///< why not
  std::string text;                         ///< the document's text after the swap, where it is possible
  std::vector<std::string> dropped, added;  ///< "params.radius", "inputs.light ← spatial.light", for a tooltip
  Remembered remembered;                    ///< what was dropped
};

/// What swapping would do. Parameters stay where the new type has them too, of the same kind and in its range; inputs
/// where it has them and what they read fits. Others are dropped, and come back when the pass is swapped back. Required
/// inputs that are open are connected to, in this order: what they read when the pass was of that type before; the only
/// fitting thing that a dropped input read; what inputs of that name read elsewhere in the graph, where that is one
/// thing; the only output of that name. A swap that adds a finding to those that the graph has is not possible.
/// InputError for a pass that there is none of.
SwapPlan planSwap(const Document& document, const SwapContext& context, const std::string& pass,
                  const std::string& type);

/// A type as a choice for a pass.
struct TypeChoice {
  std::string type, doc;
  bool current = false, possible = false;
  std::string reason;   ///< why not
  std::string changes;  ///< what is dropped and added, in words; may be empty
};

/// The pass's own type and every other that has what is read of the pass, by name. Takes about a compilation of the
/// graph for each: for when a list is opened, not for every frame.
std::vector<TypeChoice> fittingTypes(const Document& document, const SwapContext& context, const std::string& pass);

/// InputError, with the reason, when it is not possible; the document is then as it was.
void swapType(Document& document, const SwapContext& context, const std::string& pass, const std::string& type);

}  // namespace weir::view
