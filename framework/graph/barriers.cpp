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

/// Who uses a resource over the frames.
struct Use {
  bool readNow = false;                              ///< this frame's value, by a pass or as an output
  bool readPrevious = false;                         ///< last frame's value, likewise
  bool visibleNow = false, visiblePrevious = false;  ///< while planning: the barrier is placed
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  std::vector<Use> uses(graph.resources.size());
  for (const CompiledPass& pass : graph.passes)
    for (const Binding& input : pass.inputs)
      if (input.resource != kNone)
        (input.previous ? uses[input.resource].readPrevious : uses[input.resource].readNow) = true;
  for (const GraphOutput& output : graph.outputs)
    (output.previous ? uses[output.resource].readPrevious : uses[output.resource].readNow) = true;

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
      const Use& use = uses[output.resource];
      // With history, the copy to be written was last frame's previous one.
      const bool wasRead = graph.resources[output.resource].history ? use.readPrevious : use.readNow;
      pass.barriers.push_back({output.resource, false, wasRead ? Access::Read : Access::Write, Access::Write, kNone});
    }
  }
}

}  // namespace weir::graph
