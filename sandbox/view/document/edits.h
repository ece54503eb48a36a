// What a user asks for, as data: panels return these, and whoever owns the document carries them out between two
// frames.
#pragma once

#include "view/document/document.h"
#include "view/document/swap.h"

#include <string>
#include <variant>

namespace weir::view {

struct SetParam {
  std::string pass, param;
  ParamValue value;
  bool continues = false;  ///< as Document::setParam
};
struct ResetParam {
  std::string pass, param;
};
struct SetEnabled {
  std::string pass;
  bool enabled = true;
};
struct SwapType {
  std::string pass, type;
};
struct Undo {};
struct Redo {};

using Edit = std::variant<SetParam, ResetParam, SetEnabled, SwapType, Undo, Redo>;

/// Throws as the edits of Document and swapType() do; the document is then as it was.
void carryOut(Document& document, const SwapContext& context, const Edit& edit);

}  // namespace weir::view
