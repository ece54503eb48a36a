// Barriers for a frame that follows another frame of the same graph. The first frame, and one after a clear, need no
// more.
//
// A resource has one producer, which writes it before anybody reads it in the frame. So a copy goes through these
// phases:
//
//   without history      | write ─► reads                       | write (next frame) …
//   with, two copies     | write ─► reads ─► reads as previous  | write (the frame after the next) …
//
// Before the first read of a phase, the write must be visible; later reads of the same phase come after that barrier.
// Before the write, whatever the copy was last used for must be over.
#include <weir/graph/checked.h>

#include <algorithm>

namespace weir::graph {
namespace {

/// Which passes read a resource. Whoever reads an output from outside brings barriers of his own, before and after:
/// whether there is anybody is not known here, and a barrier after reads that did not happen would leave the last write
/// pending.
struct Use {
  bool read = false;                                 ///< in this frame or in the next
  bool visibleNow = false, visiblePrevious = false;  ///< while planning: the barrier is placed
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  std::vector<Use> uses(graph.resources.size());
  for (const CompiledPass& pass : graph.passes)
    for (const Binding& input : pass.inputs)
      if (input.resource != kNone) uses[input.resource].read = true;

  for (CompiledPass& pass : graph.passes) {
    pass.barriers.clear();
    for (const Binding& input : pass.inputs) {
      if (input.resource == kNone) continue;
      Use& use = uses[input.resource];
      bool& visible = input.previous ? use.visiblePrevious : use.visibleNow;
      if (visible) continue;
      visible = true;
      const uint32_t from = input.previous ? kNone : graph.resources[input.resource].producer;
      pass.barriers.push_back({input.resource, input.previous, Access::Write, Access::Read, from});
    }
    for (const Binding& output : pass.outputs) {
      // Reads came after a barrier that made the write visible, so that once they are over the write is too.
      const Access before = uses[output.resource].read ? Access::Read : Access::Write;
      pass.barriers.push_back({output.resource, false, before, Access::Write, kNone});
    }
  }
}

}  // namespace weir::graph
