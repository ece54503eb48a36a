// Configs, displays and views as given by users: what is taken, what is refused, and what the shader is made of.
#include "output/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

#include "passes_output/configs.h"

namespace weir::passes {
namespace {

using test::TemporaryFolder;

/// $OCIO as given, for as long as this lives.
class Variable {
 public:
  explicit Variable(const char* value) {
    if (const char* old = std::getenv("OCIO")) old_ = old;
    value == nullptr ? unsetenv("OCIO") : setenv("OCIO", value, 1);
  }
  ~Variable() { old_ ? setenv("OCIO", old_->c_str(), 1) : unsetenv("OCIO"); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  std::optional<std::string> old_;
};

testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "no '" << part << "' in: " << text;
}

std::string refusal(const ViewChoice& choice) {
  try {
    makeViewTransform(choice);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(ViewTransform, BuiltInConfigIsValidAndNeedsNoTables) {
  std::istringstream text(builtInConfig());
  EXPECT_NO_THROW(OCIO_NAMESPACE::Config::CreateFromStream(text)->validate());
  for (const char* display : {"sRGB", "Rec.1886"}) {
    for (const char* view : {"ACES SDR", "Standard", "Raw"}) {
      EXPECT_TRUE(makeViewTransform({"weir", display, view, "", ""}).textures.empty()) << display << ", " << view;
    }
  }
}

TEST(ViewTransform, DefaultsAreTheConfigs) {
  const Variable none(nullptr);
  EXPECT_EQ(makeViewTransform({}).glsl, makeViewTransform({"weir", "sRGB", "ACES SDR", "Linear Rec.709", ""}).glsl);
  EXPECT_NE(makeViewTransform({}).glsl, makeViewTransform({"", "", "Standard", "", ""}).glsl);
  EXPECT_NE(makeViewTransform({}).glsl, makeViewTransform({"", "Rec.1886", "", "", ""}).glsl);
  EXPECT_NE(makeViewTransform({}).glsl, makeViewTransform({"", "", "", "ACEScg", ""}).glsl);
}

TEST(ViewTransform, NamesAreAsInOpenColorIO) {
  EXPECT_EQ(makeViewTransform({"weir", "srgb", "aces sdr", "linear rec.709", ""}).glsl,
            makeViewTransform({"weir", "sRGB", "ACES SDR", "Linear Rec.709", ""}).glsl);
  EXPECT_NO_THROW(makeViewTransform({"weir", "", "", "lin_rec709", ""})) << "an alias";
  EXPECT_NO_THROW(makeViewTransform({"weir", "", "", "scene_linear", ""})) << "a role";
}

TEST(ViewTransform, WrongNamesAreRefusedWithTheChoices) {
  const std::string view = refusal({"weir", "", "ACES SRD", "", ""});
  EXPECT_TRUE(contains(view, "view: \"ACES SRD\""));
  EXPECT_TRUE(contains(view, "ACES SDR, Standard, Raw"));
  EXPECT_TRUE(contains(view, "did you mean \"ACES SDR\""));
  EXPECT_TRUE(contains(view, "sRGB"));

  const std::string display = refusal({"weir", "Rec.1866", "", "", ""});
  EXPECT_TRUE(contains(display, "display: \"Rec.1866\""));
  EXPECT_TRUE(contains(display, "sRGB, Rec.1886"));
  EXPECT_TRUE(contains(display, "did you mean \"Rec.1886\""));

  const std::string space = refusal({"weir", "", "", "Liner Rec.709", ""});
  EXPECT_TRUE(contains(space, "space: \"Liner Rec.709\""));
  EXPECT_TRUE(contains(space, "did you mean \"Linear Rec.709\""));
  EXPECT_TRUE(contains(space, "ACEScg"));
}

TEST(ViewTransform, WrongSpaceIsRefusedWhereItIsNotNeeded) {
  EXPECT_TRUE(contains(refusal({"weir", "", "Raw", "nonsense", ""}), "space: \"nonsense\""));
}

TEST(ViewTransform, ConfigsThatCannotBeReadAreRefused) {
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(refusal({"absent.ocio", "", "", "", folder.path()}), "absent.ocio"));
  EXPECT_TRUE(contains(refusal({"absent.ocio", "", "", "", folder.path()}), folder.path() + "/absent.ocio"));
  EXPECT_TRUE(contains(refusal({folder.path(), "", "", "", ""}), folder.path())) << "a folder";
  const std::string broken = folder.write("a.ocio", "ocio_profile_version: 2\n  - ]:");
  EXPECT_TRUE(contains(refusal({broken, "", "", "", ""}), "a.ocio"));
  EXPECT_TRUE(contains(refusal({folder.write("b.ocio", ""), "", "", "", ""}), "b.ocio"));
  const std::string noDisplay =
      "ocio_profile_version: 2\nroles: {default: x}\ncolorspaces:\n  - !<ColorSpace> {name: x}\n";
  EXPECT_NE(refusal({folder.write("c.ocio", noDisplay), "", "", "", ""}), "");
}

TEST(ViewTransform, ATableThatIsAbsentIsRefused) {
  const TemporaryFolder folder;
  const std::string config = test::lutConfig(folder);
  std::filesystem::remove(folder.path() + "/luts/twist.cube");
  EXPECT_TRUE(contains(refusal({config, "", "cube", "", ""}), "twist.cube"));
  EXPECT_EQ(refusal({config, "", "curve", "", ""}), "");
}

TEST(ViewTransform, TheVariableCountsUnlessAConfigIsNamed) {
  const TemporaryFolder folder;
  const Variable variable(test::lutConfig(folder).c_str());
  EXPECT_EQ(makeViewTransform({"", "", "cube", "", ""}).textures.size(), 1u);
  EXPECT_TRUE(makeViewTransform({"weir", "", "ACES SDR", "", ""}).textures.empty());
  const Variable wrong("/nowhere/config.ocio");
  EXPECT_TRUE(contains(refusal({}), "/nowhere/config.ocio"));
  EXPECT_TRUE(contains(refusal({}), "$OCIO"));
}

TEST(ViewTransform, RelativePathsAreSoughtInTheFolderToo) {
  const TemporaryFolder folder;
  test::lutConfig(folder);
  EXPECT_EQ(makeViewTransform({"luts.ocio", "", "curve", "", folder.path()}).textures.size(), 1u);
}

TEST(ViewTransform, TablesBecomeTexturesOfThePass) {
  const TemporaryFolder folder;
  const ViewTransform both = makeViewTransform({test::lutConfig(folder), "", "both", "", ""});
  ASSERT_EQ(both.textures.size(), 2u);
  const TextureData& curve = both.textures[0].second;
  EXPECT_EQ(curve.width, 17u);
  EXPECT_EQ(curve.height, 1u);
  EXPECT_EQ(curve.depth, 0u);
  ASSERT_EQ(curve.rgba.size(), 4u * 17);
  EXPECT_NEAR(curve.rgba[4 * 8], std::sqrt(0.5f), 1e-6f);
  EXPECT_EQ(curve.rgba[4 * 8 + 3], 1.0f);
  const TextureData& cube = both.textures[1].second;
  EXPECT_EQ(cube.depth, 5u);
  EXPECT_EQ(cube.rgba.size(), 4u * 125);
  EXPECT_EQ(both.glsl.find("uniform"), std::string::npos) << both.glsl;
  EXPECT_EQ(both.glsl.find("Sampler"), std::string::npos) << both.glsl;
  for (const auto& [name, data] : both.textures) EXPECT_TRUE(contains(both.glsl, "texture_" + name + ","));
}

TEST(ViewTransform, LongCurvesLieInRows) {
  const TemporaryFolder folder;
  const ViewTransform rows = makeViewTransform({test::lutConfig(folder), "", "long", "", ""});
  ASSERT_EQ(rows.textures.size(), 1u);
  const TextureData& data = rows.textures[0].second;
  EXPECT_GT(data.height, 1u);
  EXPECT_EQ(data.rgba.size(), size_t{4} * data.width * data.height);
}

TEST(ViewTransform, ValuesMeantToBeSetLiveAreFixed) {
  const TemporaryFolder folder;
  const ViewTransform live = makeViewTransform({test::lutConfig(folder), "", "live", "", ""});
  EXPECT_EQ(live.glsl.find("uniform"), std::string::npos) << live.glsl;
}

TEST(ViewTransform, AViewOfDataChangesNothing) {
  const TemporaryFolder folder;
  const std::string config = test::foreignConfig(folder, true);
  EXPECT_EQ(makeViewTransform({config, "", "untouched", "", ""}).glsl.find('*'), std::string::npos);
}

}  // namespace
}  // namespace weir::passes
