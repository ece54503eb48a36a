// What a pass does: prepare once, record every frame.
#pragma once

namespace weir {

class PrepareContext;
class RecordContext;

class Pass {
 public:
  virtual ~Pass() = default;
  virtual void prepare(PrepareContext&) = 0;
  virtual void record(RecordContext&) = 0;
};

}  // namespace weir
