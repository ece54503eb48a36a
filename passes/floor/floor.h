// What a frame costs the hardware at the least: passes that only trace a ray, or only move bytes. `weir bench --floor`
// runs them beside a graph and gives its time as a multiple of theirs; in a graph of one's own they tell what a ray
// costs on this scene.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

/// One camera ray a pixel, and which triangle it met.
class CameraRays final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

/// The shadow ray of each pixel's reservoir, whether it was known to be seen or not.
class ShadowRays final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

/// Reads so many words a pixel and writes as many.
class Buffers final : public Pass {
 public:
  static void describe(PassDescription& d);
  void prepare(PrepareContext& c) override;
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
