// Passes of the tests' own that hand the tracing interface's answers straight to the CPU.
#pragma once

#include <weir/pass/plugin.h>

#include <array>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"
#include "support/ray_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {

/// A segment to trace: distances are in units of `direction`.
struct Segment {
  float ox, oy, oz, tMax, dx, dy, dz;
  uint32_t key;
};
struct Found {
  uint32_t triangle, instance;
  float u, v, transmittance;
  uint32_t cameraTriangle;  ///< with kCameraSides
};
/// How many of a pixel's rays were wrong.
struct Count {
  uint32_t wrong, all;
};

}  // namespace weir::test

namespace weir {

template <>
struct LayoutOf<test::Segment> {
  static constexpr const char* name = "Segment";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 8> fields{{{"float", "ox"},
                                                {"float", "oy"},
                                                {"float", "oz"},
                                                {"float", "tMax"},
                                                {"float", "dx"},
                                                {"float", "dy"},
                                                {"float", "dz"},
                                                {"uint", "key"}}};
};
template <>
struct LayoutOf<test::Found> {
  static constexpr const char* name = "Found";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 6> fields{{{"uint", "triangle"},
                                                {"uint", "instance"},
                                                {"float", "u"},
                                                {"float", "v"},
                                                {"float", "transmittance"},
                                                {"uint", "cameraTriangle"}}};
};
template <>
struct LayoutOf<test::Count> {
  static constexpr const char* name = "Count";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 2> fields{{{"uint", "wrong"}, {"uint", "all"}}};
};

}  // namespace weir

namespace weir::test {

/// Both questions of the interface for given segments.
class Probe final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("segments", perPixel<Segment>());
    d.output("found", perPixel<Found>());
    d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneAcceleration);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.rayKernel("probe.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

/// Rays that leave the surfaces of a G-buffer, all of which should be free (or, `leak`, all blocked).
class Leave final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("surface", perPixel<passes::PackedSurface>());
    d.output("count", perPixel<Count>());
    d.param("rays", 16).range(1, 4096);
    d.param("mode", "sky").oneOf({"sky", "lights", "leak"});
    d.param("traced", false).doc("From surfaces as paths have them: a ray's hit, not what was packed of it");
    d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
    d.needs(Need::FrameCamera).needs(Need::FrameIndex);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.rayKernel("leave.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

/// A test of one of them.
inline PassTest& withProbes(PassTest& t) {
  return t.plugin("trace_test", {passEntry<Probe>("Probe"), passEntry<Leave>("Leave")},
                  sourcePath("tests/trace/shaders"));
}

}  // namespace weir::test
