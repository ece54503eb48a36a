// Small passes that the tests of swapping graphs are made of. Their shaders are written by the tests.
#pragma once

#include <string>

#include "execute/graph_run.h"

namespace weir::test {

/// Adds a step to what it wrote last frame; how many elements a pixel, and with a step that is compiled in.
class Counter : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("before", perPixel<Word>()).anyCount();
    d.output("after", perPixel<Word>()).times("count").passesThrough("before");
    d.param("step", 1);
    d.param("count", 1).range(1, 4);
    d.param("fixedStep", 0).specialises();
    d.param("lookedAt", 0);
  }
  void prepare(PrepareContext& c) override {
    const int looked = c.integer("lookedAt");
    kernel_ = c.kernel("swap.glsl", {.bind = {}, .defines = {{"LOOKED_AT", std::to_string(looked)}}, .sources = {}});
  }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};
/// The same by another name.
class Other final : public Counter {};

class Join final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("x", perPixel<Word>()).anyCount();
    d.input("y", perPixel<Word>()).anyCount();
    d.output("sum", perPixel<Word>());
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("join.glsl"); }
  void record(RecordContext& c) override {
    if (fails) throw RuntimeError("no frame today");
    c.launch(kernel_);
  }
  static inline bool fails = false;

 private:
  Kernel kernel_;
};

class Paint final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("image", storageImage(Format::R32F)); }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("paint.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

class Scratchy final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("word", perPixel<Word>()); }
  void prepare(PrepareContext& c) override {
    c.scratch("half", perPixel<Word>());
    first_ = c.kernel("scratchy.glsl", {.bind = {{"out_word", "scratch_half"}}, .defines = {}, .sources = {}});
    second_ = c.kernel("scratchy.glsl", {.bind = {}, .defines = {{"SECOND", "1"}}, .sources = {}});
  }
  void record(RecordContext& c) override {
    c.launch(first_);
    c.launch(second_);
  }

 private:
  Kernel first_, second_;
};

class Idle final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("word", perPixel<Word>()); }
  void prepare(PrepareContext& /*context*/) override {}
  void record(RecordContext& /*context*/) override {}
};

/// How far the camera moved since the last frame.
class Step final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.output("image", storageImage(Format::R32F));
    d.needs(Need::FrameCamera).needsPrevious(Need::FrameCamera);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("step.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

}  // namespace weir::test
