// G-buffers: the first visible surface of every pixel. Two ways to it with the same ports, swapped by the graph's
// "type".
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

/// Ports and parameters that both share.
void describeGBuffer(PassDescription& d);

class RayTraced final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

/// Rasterises triangle numbers, then resolves them to surfaces in a compute shader. Needs no ray tracing.
class Raster final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel raster_, resolve_;
};

}  // namespace weir::passes
