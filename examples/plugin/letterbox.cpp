// letterbox.Bars: darkens what lies above and below a picture of a wanted shape.
#include <weir/core/error.h>
#include <weir/pass/plugin.h>

#include <cmath>
#include <string>

namespace {

class Bars final : public weir::Pass {
 public:
  /// What others can know of the pass: graph checks, --set, `weir passes` and the shader's declarations come from it.
  static void describe(weir::PassDescription& d) {
    d.doc("Darkens the rows above and below a picture of a wanted shape");
    d.input("color", weir::storageImage(weir::Format::RGBA32F));
    d.output("color", weir::storageImage(weir::Format::RGBA32F)).radiance().passesThrough("color");
    d.param("aspect", 2.39f).range(0.1, 100).specialises().doc("Width by height of what stays as it is");
    d.param("stops", 3).range(0, 20).doc("How much darker the bars are; a stop is half the light");
  }

  /// Once for a compiled graph, and again when `aspect` changes, as it specialises.
  void prepare(weir::PrepareContext& c) override {
    const float rows = std::round(static_cast<float>(c.width()) / c.number("aspect"));
    const float bar = std::floor((static_cast<float>(c.height()) - rows) / 2);
    if (bar < 0) throw weir::InputError("the picture is wider than 'aspect' asks for: no bar fits above and below it");
    weir::KernelOptions options;
    options.defines = {{"BAR_ROWS", std::to_string(static_cast<unsigned>(bar))}};
    kernel_ = c.kernel("bars.glsl", options);
  }

  /// Every frame.
  void record(weir::RecordContext& c) override { c.launch(kernel_); }

 private:
  weir::Kernel kernel_;
};

}  // namespace

WEIR_PLUGIN("letterbox", weir::passEntry<Bars>("Bars"))
