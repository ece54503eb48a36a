// A pass that does nothing, for plugins that are about something else.
#pragma once

#include <weir/pass/plugin.h>

class TestPass : public weir::Pass {
 public:
  static void describe(weir::PassDescription& d) {
    d.doc("Does nothing");
    d.output("color", weir::storageImage(weir::Format::RGBA32F)).doc("Nothing");
    d.param("amount", 1.0f).range(0, 2).unit("m").doc("Of nothing");
    d.param("mode", "a").oneOf({"a", "b"});
  }
  void prepare(weir::PrepareContext&) override {}
  void record(weir::RecordContext&) override {}
};
