#include "output/accumulate.h"

#include "common/layouts.h"

namespace weir::passes {

void Accumulate::describe(PassDescription& d) {
  d.doc("Mean of all frames since the history was last cleared, summed so that a million lose nothing");
  d.input("color", storageImage(Format::RGBA32F)).doc("This frame's radiance");
  d.input("history", perPixel<MeanState>()).doc("This pass's own state port, @previous");
  d.output("color", storageImage(Format::RGBA32F))
      .radiance()
      .passesThrough("color")
      .doc("The mean; alpha as in this frame");
  d.output("state", perPixel<MeanState>()).passesThrough("history").doc("Sum and count");
  d.param("limit", 0)
      .range(0, 1 << 20)
      .unit("frames")
      .doc("From this count on an exponential mean, which forgets; 0: never");
}

void Accumulate::prepare(PrepareContext& c) {
  kernel_ = c.kernel("accumulate.glsl");
}

void Accumulate::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
