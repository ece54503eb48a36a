// One plugin in two versions. Each has what keeps a library from being unloaded unless it is built with
// -fno-gnu-unique: variables of inline functions and templates, which the linker would otherwise make unique in the
// process, so that the second version would also find the first one's.
#pragma once

#include <weir/pass/plugin.h>

#include <string>

/// The layout's texts lie in the library and differ between its versions.
struct Versioned {
  float first;
};

template <>
struct weir::LayoutOf<Versioned> {
  static constexpr const char* name = "Versioned" RELOAD_TEXT;
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"float", "field" RELOAD_TEXT}}};
};

template <typename T>
int& counted() {
  static int count = 0;
  return count;
}

template <typename T>
int& countedByThread() {
  thread_local int count = 0;
  return count;
}

class Reloaded final : public weir::Pass {
 public:
  static void describe(weir::PassDescription& d) {
    d.doc("Version " RELOAD_TEXT);
    d.output("values", weir::perPixel<Versioned>());
    d.param("mode", RELOAD_TEXT).oneOf({RELOAD_TEXT, "other"});
  }
  void prepare(weir::PrepareContext& context) override { context.kernel("version " RELOAD_TEXT); }
  /// Launches with the number of its version in hundreds and how often this library recorded in ones.
  void record(weir::RecordContext& context) override {
    static const std::string text = "built at run time by version " RELOAD_TEXT;
    ++countedByThread<Reloaded>();
    context.launch({}, static_cast<uint32_t>(100 * (text.back() - '0') + ++counted<Reloaded>()));
  }
};
