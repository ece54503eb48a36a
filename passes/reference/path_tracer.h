// Path tracing: light by any number of bounces, the truth that everything else is held against.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

class PathTracer final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
