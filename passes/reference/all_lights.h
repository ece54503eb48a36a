// Brute-force direct light: the truth that estimators are held against.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

class AllLights final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
