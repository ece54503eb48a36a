// What a screen shows of a picture: exposure, then a display and view of an OpenColorIO config.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

class Tonemap final : public Pass {
 public:
  static void describe(PassDescription& d);
  /// InputError when config, display, view or space don't name what there is; see view_transform.h.
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
