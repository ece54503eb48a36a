// How exactly the device at hand decodes sRGB: what the tolerances of tests on textures rest on.
#include <weir/pass/plugin.h>

#include <cmath>

#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

class Decode final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.output("color", storageImage(Format::RGBA32F));
    d.needs(Need::SceneGeometry).needs(Need::SceneMaterials);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("decode.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

// Every code once. Alpha, and every channel of a texture that holds data, is code/255.
TEST(Surface, SrgbDecoding) {
  Builder b;
  scene::Material m;
  m.baseColorTexture.texture = b.texture(
      256, 1, [](uint32_t x, uint32_t) { return glm::u8vec4(x, 255 - x, x, x); }, scene::Filter::Nearest);
  b.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, b.material(m)));
  PassTest t("srgb_test.Decode");
  t.plugin("srgb_test", {passEntry<Decode>("Decode")}, sourcePath("tests/passes_gbuffer/shaders"));
  t.size(256, 1).scene(b.scene);
  t.run();
  const auto color = t.output<glm::vec4>("color");
  double linear = 0, root = 0, relative = 0;
  for (uint32_t code = 0; code < 256; ++code) {
    const double exact = oracleSrgbToLinear(code / 255.0), got = color[code].r;
    EXPECT_EQ(color[code].r, color[255 - code].g) << "channels are decoded alike";
    EXPECT_NEAR(color[code].a, code / 255.0, 1e-6);
    linear = std::max(linear, std::abs(got - exact));
    root = std::max(root, std::abs(std::sqrt(got) - std::sqrt(exact)));
    if (code > 0) relative = std::max(relative, std::abs(got / exact - 1));
  }
  RecordProperty("linear", std::to_string(linear));
  std::cout << "largest errors: " << linear << " of the range, " << root << " of its root, " << relative
            << " relative\n";
  EXPECT_LE(root, kSrgbRoot);
  EXPECT_LE(relative, kSrgbRelative);
}

}  // namespace
}  // namespace weir::test
