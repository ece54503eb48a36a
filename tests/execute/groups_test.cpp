// Workgroups of a pass's own size whose invocations work together, and launches in a row.
#include "execute/graph_run.h"

namespace weir::test {
namespace {

/// Reverses each group's words in shared memory, then negates them in a row.
class Reverser final : public Pass {
 public:
  static uint32_t side;
  static void describe(PassDescription& d) { d.output("to", perPixel<Word>()); }
  void prepare(PrepareContext& c) override {
    KernelOptions whole;
    whole.defines.emplace_back("SIDE", std::to_string(side));
    whole.group = {.side = side, .whole = true};
    reverse_ = c.kernel("reverse.glsl", whole);
    negate_ = c.kernel("negate.glsl", {.linear = true});
  }
  void record(RecordContext& c) override {
    c.launch(reverse_);
    c.launch(negate_, c.width() * c.height(), 1, 0);
  }

 private:
  Kernel reverse_, negate_;
};
uint32_t Reverser::side = 8;

const std::string kPasses = R"({"it": {"type": "own.Reverser"}})";

// Each invocation reads what the opposite one of its group wrote, also where that lies beyond the picture.
TEST(Groups, WholeGroupsShareMemory) {
  for (const uint32_t side : {1u, 4u, 8u, 16u}) {
    SCOPED_TRACE(side);
    Reverser::side = side;
    const uint32_t width = 37, height = 21;
    GraphRun g(kPasses, "it.to", {passEntry<Reverser>("Reverser")}, {.width = width, .height = height});
    g.run();
    const std::vector<uint32_t> out = g.read("it.to");
    ASSERT_EQ(out.size(), size_t{width} * height);
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        const uint32_t opposedX = x / side * side + side - 1 - x % side,
                       opposedY = y / side * side + side - 1 - y % side;
        ASSERT_EQ(~out[y * width + x], 1000 * opposedY + opposedX) << x << ", " << y;
      }
    }
  }
}

TEST(Groups, WhatNoDeviceHasIsRefused) {
  for (const uint32_t side : {0u, 4096u}) {
    Reverser::side = side;
    try {
      GraphRun g(kPasses, "it.to", {passEntry<Reverser>("Reverser")}, {});
      ADD_FAILURE() << side;
    } catch (const InputError& e) {
      for (const char* word : {"it", "own.Reverser", "reverse.glsl", "workgroups"})
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " in: " << e.what();
    }
  }
}

}  // namespace
}  // namespace weir::test
