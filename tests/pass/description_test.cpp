// Layouts, and the rules for descriptions.
#include <weir/core/error.h>
#include <weir/pass/description.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace weir {

struct Sample {
  float weight[4];
  uint32_t light[2];
  float count;
  uint32_t unused;
};
template <>
struct LayoutOf<Sample> {
  static constexpr const char* name = "Sample";
  static constexpr uint32_t version = 2;
  static constexpr uint32_t emptyWord = 7;
  static constexpr std::array<Field, 4> fields{
      {{"vec4", "weight"}, {"uvec2", "light"}, {"float", "count"}, {"uint", "unused"}}};
};

namespace {

Layout layout(const char* name, uint32_t version, std::vector<Field> fields) {
  return makeLayout(name, version, 0, fields.data(), fields.size());
}

TEST(Layout, OfAHostStruct) {
  const PortType type = perPixel<Sample>();
  EXPECT_EQ(type.layout.name, "Sample");
  EXPECT_EQ(type.layout.version, 2u);
  EXPECT_EQ(type.layout.stride, 32u);
  EXPECT_EQ(type.layout.emptyWord, 7u);
  EXPECT_EQ(type.layout.glsl(),
            "struct Sample {\n  vec4 weight;\n  uvec2 light;\n  float count;\n  uint unused;\n};\n");
  EXPECT_EQ(fixedBuffer<Sample>(12).fixedCount, 12u);
}

TEST(Layout, StridesFollowStd430) {
  EXPECT_EQ(layout("a", 1, {{"float", "x"}}).stride, 4u);
  EXPECT_EQ(layout("a", 1, {{"vec3", "x"}}).stride, 16u);
  EXPECT_EQ(layout("a", 1, {{"vec3", "x"}, {"float", "y"}}).stride, 16u);
  EXPECT_EQ(layout("a", 1, {{"float", "y"}, {"vec3", "x"}}).stride, 32u);
  EXPECT_EQ(layout("a", 1, {{"uvec2", "x"}, {"uint", "y"}}).stride, 16u);
  EXPECT_EQ(layout("a", 1, {{"mat9", "x"}}).stride, 0u);
}

TEST(Layout, TheHashCoversNameVersionAndFields) {
  const Layout base = layout("a", 1, {{"uint", "x"}, {"uint", "y"}});
  EXPECT_EQ(base.hash, layout("a", 1, {{"uint", "x"}, {"uint", "y"}}).hash);
  for (const Layout& other :
       {layout("b", 1, {{"uint", "x"}, {"uint", "y"}}), layout("a", 2, {{"uint", "x"}, {"uint", "y"}}),
        layout("a", 1, {{"uint", "y"}, {"uint", "x"}}), layout("a", 1, {{"uint", "x"}, {"int", "y"}}),
        layout("a", 1, {{"uint", "xy"}}), layout("a", 1, {{"uvec2", "x"}})}) {
    EXPECT_NE(base.hash, other.hash);
    PortType a, b;
    a.layout = base;
    b.layout = other;
    EXPECT_FALSE(compatible(a, b));
    EXPECT_NE(describe(a), describe(b));
  }
}

TEST(Layout, Compatible) {
  EXPECT_TRUE(compatible(perPixel<Sample>(), fixedBuffer<Sample>(3))) << "counts are compared in the graph";
  EXPECT_FALSE(compatible(perPixel<Sample>(), storageImage(Format::R32F)));
  EXPECT_FALSE(compatible(storageImage(Format::RGBA32F), storageImage(Format::RGBA16F)));
  EXPECT_TRUE(compatible(storageImage(Format::RGBA32F), storageImage(Format::RGBA32F)));
  EXPECT_EQ(describe(storageImage(Format::RGBA16F)), "image RGBA16F");
  EXPECT_EQ(describe(perPixel<Sample>()).find("Sample v2 (32 bytes, hash 0x"), 0u) << describe(perPixel<Sample>());
}

TEST(Names, OfNeedsFormatsAndTypes) {
  for (int i = 0; i < static_cast<int>(Need::Count); ++i)
    EXPECT_EQ(needFromName(needName(static_cast<Need>(i))), static_cast<Need>(i));
  EXPECT_EQ(needFromName("scene.weather"), std::nullopt);
  EXPECT_STREQ(needName(Need::SceneAcceleration), "scene.acceleration");
  EXPECT_EQ(formatBytes(Format::RG32F), 8u);
  EXPECT_EQ(toText(ParamValue(0.1f)), "0.1");
  EXPECT_EQ(toText(ParamValue(true)), "true");
}

using Build = std::function<void(PassDescription&)>;

void expectBad(const std::string& words, const Build& build) {
  PassDescription d;
  d.type = "test.Pass";
  build(d);
  try {
    d.check();
    ADD_FAILURE() << "should say: " << words;
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_NE(text.find("test.Pass"), std::string::npos) << text;
  }
}

TEST(Check, AcceptsWhatIsConsistent) {
  PassDescription d;
  d.input("a", perPixel<Sample>()).anyCount();
  d.input("b", storageImage(Format::R32F)).optional();
  d.output("a", perPixel<Sample>()).passesThrough("a").countOf("a");
  d.output("many", perPixel<Sample>()).times("n");
  d.output("half", storageImage(Format::R32F)).scale(1, 2);
  d.param("n", 2).range(1, 4);
  d.param("f", 0.7f).range(0.7, 0.9);
  d.param("choice", "x").oneOf({"x", "y"});
  d.needs(Need::FrameIndex).needs(Need::FrameIndex).needsPrevious(Need::FrameCamera);
  EXPECT_NO_THROW(d.check());
  EXPECT_EQ(d.wants.size(), 2u);
  EXPECT_TRUE(d.has(Need::FrameCamera, true));
  EXPECT_FALSE(d.has(Need::FrameCamera));
  EXPECT_NE(d.findParam("n"), nullptr);
  EXPECT_EQ(d.findInput("many"), nullptr);
}

TEST(Check, RefusesContradictions) {
  const PortType pixel = perPixel<Sample>(), picture = storageImage(Format::R32F);
  expectBad("declared twice", [&](auto& d) { d.input("a", picture), d.input("a", pixel); });
  expectBad("declared twice", [&](auto& d) { d.output("a", picture), d.output("a", pixel); });
  expectBad("declared twice", [&](auto& d) { d.param("a", 1), d.param("a", true); });
  expectBad("not an identifier", [&](auto& d) { d.input("a b", picture); });
  expectBad("not an identifier", [&](auto& d) { d.param("", 1); });
  expectBad("outside its range", [&](auto& d) { d.param("a", 9).range(1, 8); });
  expectBad("outside its range", [&](auto& d) { d.param("a", 0.5f).range(1, 8); });
  expectBad("empty range", [&](auto& d) { d.param("a", 5).range(8, 1); });
  expectBad("no number", [&](auto& d) { d.param("a", true).range(0, 1); });
  expectBad("not finite", [&](auto& d) { d.param("a", std::numeric_limits<float>::quiet_NaN()); });
  expectBad("none of its choices", [&](auto& d) { d.param("a", "x").oneOf({"y"}); });
  expectBad("twice", [&](auto& d) { d.param("a", "x").oneOf({"x", "x"}); });
  expectBad("declared enum", [&](auto& d) { d.param("a", 3).oneOf({"x"}); });
  expectBad("not an input", [&](auto& d) { d.output("a", picture).passesThrough("b"); });
  expectBad("not a required per-pixel", [&](auto& d) { d.output("a", pixel).countOf("b"); });
  expectBad("not a required per-pixel", [&](auto& d) { d.input("b", picture), d.output("a", pixel).countOf("b"); });
  expectBad("not an integer parameter", [&](auto& d) { d.output("a", pixel).times("n"); });
  expectBad("not an integer parameter", [&](auto& d) { d.param("n", 1.0f), d.output("a", pixel).times("n"); });
  expectBad("is an image", [&](auto& d) { d.param("n", 1), d.output("a", picture).times("n"); });
  expectBad("only inputs", [&](auto& d) { d.output("a", picture).optional(); });
  expectBad("only inputs", [&](auto& d) { d.output("a", pixel).anyCount(); });
  expectBad("only outputs", [&](auto& d) { d.input("a", picture).passesThrough("a"); });
  expectBad("scale", [&](auto& d) { d.output("a", picture).scale(1, 0); });
  expectBad("without fields", [&](auto& d) { d.output("a", PortType()); });
}

}  // namespace
}  // namespace weir
