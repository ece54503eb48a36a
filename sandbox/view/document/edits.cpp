#include "view/document/edits.h"

namespace weir::view {
namespace {

struct Editor {
  Document& document;
  const SwapContext& context;

  void operator()(const SetParam& e) const { document.setParam(e.pass, e.param, e.value, e.continues); }
  void operator()(const ResetParam& e) const { document.resetParam(e.pass, e.param); }
  void operator()(const SetEnabled& e) const { document.setEnabled(e.pass, e.enabled); }
  void operator()(const SwapType& e) const { swapType(document, context, e.pass, e.type); }
  void operator()(const Undo&) const { document.undo(); }
  void operator()(const Redo&) const { document.redo(); }
};

}  // namespace

void carryOut(Document& document, const SwapContext& context, const Edit& edit) {
  std::visit(Editor{document, context}, edit);
}

}  // namespace weir::view
