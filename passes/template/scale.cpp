#include "template/scale.h"

namespace weir::passes {

void Scale::describe(PassDescription& d) {
  d.doc("Multiplies a picture by a factor: the smallest complete pass, to be copied");
  d.input("color", storageImage(Format::RGBA32F));
  // radiance(): linear Rec.709, display(): what a screen shows; a picture that is neither says nothing.
  d.output("color", storageImage(Format::RGBA32F)).radiance().passesThrough("color");
  d.param("factor", 1.0f).range(0, 1000).doc("Alpha stays as it is");
}

void Scale::prepare(PrepareContext& c) {
  kernel_ = c.kernel("scale.glsl");
}

void Scale::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
