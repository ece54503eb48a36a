// A plugin that is built twice, as two versions of one source: LIVE_VERSION 1 and 2.
#include <weir/pass/plugin.h>

#include <string>

namespace weir {
namespace {

struct Word {
  uint32_t value;
};

}  // namespace

template <>
struct LayoutOf<Word> {
  static constexpr const char* name = "Word";
  static constexpr uint32_t version = LIVE_VERSION, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"uint", "value"}}};
};

namespace {

class Paint final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("before", perPixel<Word>()).optional();
    d.output("word", perPixel<Word>());
    if (LIVE_VERSION > 1) d.param("strength", 1.0f).range(0, 1);
  }
  void prepare(PrepareContext& c) override {
    kernel_ =
        c.kernel("paint.glsl", {.bind = {}, .defines = {{"VERSION", std::to_string(LIVE_VERSION)}}, .sources = {}});
  }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

}  // namespace
}  // namespace weir

WEIR_PLUGIN("live", weir::passEntry<weir::Paint>("Paint"))
