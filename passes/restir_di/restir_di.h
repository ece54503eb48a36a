// ReSTIR for direct light: Bitterli et al. 2020. Four passes with a reservoir buffer between them.
#pragma once

#include <weir/pass/pass.h>

#include "restir_di/ray_order.h"

#include <array>

namespace weir::passes {

/// Candidates by power, streamed into the pixel's reservoirs (RIS).
class Initial final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
  RayOrder rays_;
  bool ordered_ = false;  ///< rays are shot by a launch of their own
};

/// Merges each pixel's reservoirs with those its surface had last frame.
class Temporal final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

/// Merges each pixel's reservoirs with those of pixels around it, one to four times.
class Spatial final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  std::array<Kernel, 4> kernels_;
};

/// Turns reservoirs into radiance.
class Shade final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
  RayOrder rays_;
  bool visibility_ = false;
};

/// Parameters that both kinds of reuse share: MIS weights and what counts as a similar surface.
void describeReuse(PassDescription& d);
/// A kernel that traces rays only where the parameters ask for them.
Kernel reuseKernel(PrepareContext& c, const char* file, KernelOptions options = {});

}  // namespace weir::passes
