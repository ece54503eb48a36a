// The mean of all frames since the history was last cleared.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

class Accumulate final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
