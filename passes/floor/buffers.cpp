#include "floor/floor.h"

namespace weir::passes {

struct Word {
  uint32_t bits;
};

}  // namespace weir::passes

namespace weir {

template <>
struct LayoutOf<passes::Word> {
  static constexpr const char* name = "Word";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"uint", "bits"}}};
};

}  // namespace weir

namespace weir::passes {

void Buffers::describe(PassDescription& d) {
  d.doc("Reads so many words a pixel and writes as many: what a frame's buffers cost at the least");
  d.output("words", perPixel<Word>()).times("words");
  d.param("words", 1).range(1, 1024).doc("Four bytes each, read and written once");
}

void Buffers::prepare(PrepareContext& c) {
  PortType type = perPixel<Word>();
  type.perPixelFromParam = "words";
  c.scratch("from", type);
  kernel_ = c.kernel("buffers.glsl");
}

void Buffers::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
