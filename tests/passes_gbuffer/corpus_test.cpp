// Files of other people that must look alike.
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <set>

#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

/// Empty, and says so loudly, where this machine lacks the file.
std::string sceneFile(const std::string& name) {
  const char* given = std::getenv("WEIR_SCENES");
  const std::string folder = given != nullptr ? given : WEIR_SOURCE_DIR "/../shared/scenes";
  std::string file = folder + "/" + name;
  if (std::filesystem::exists(file)) return file;
  std::cerr << "\n*** NO SCENE " << file << ": WHAT IT SHOULD LOOK LIKE IS NOT TESTED. SET WEIR_SCENES. ***\n\n";
  return {};
}

GFrame show(const scene::Scene& scene, const scene::Camera& camera, uint32_t side) {
  PassTest t("gbuffer.RayTraced");
  t.size(side, side).scene(scene).camera(camera);
  t.run();
  return readFrame(t, side, side);
}

TEST(Corpus, RoughnessByFactorAndByTextureIsTheSame) {
  const std::string file = sceneFile("roughness-spheres/roughness-spheres.glb");
  if (file.empty()) GTEST_SKIP();
  const scene::Scene scene = scene::importGltf(file);
  // The rows lie at y = -3 and y = 3, one by factors, one by textures of one texel with the same five values.
  std::set<long> rows[2];
  for (int row = 0; row < 2; ++row) {
    const float y = row == 0 ? -3.0f : 3.0f;
    const GFrame frame = show(scene, lookAt({15, y, 0}, {0, y, 0}, 20), 48);
    for (const GPixel& p : frame.pixels) {
      if (p.distance > 0) rows[row].insert(std::lround(p.roughness * 65535));
    }
    // Rounded up here and down there: neighbouring steps are one value.
    for (auto a = rows[row].begin(); a != rows[row].end();) {
      a = std::next(a) != rows[row].end() && *std::next(a) - *a <= 1 ? rows[row].erase(a) : std::next(a);
    }
  }
  EXPECT_GE(rows[0].size(), 3u);
  ASSERT_EQ(rows[0].size(), rows[1].size());
  for (auto a = rows[0].begin(), b = rows[1].begin(); a != rows[0].end(); ++a, ++b) {
    EXPECT_NEAR(static_cast<double>(*a), static_cast<double>(*b), 1.0) << "steps of 1/65535";
  }
}

// RGB and RGBA as floats, bytes and shorts.
TEST(Corpus, VertexColoursOfEveryTypeLookAlike) {
  std::vector<GFrame> frames;
  for (int i = 0; i < 6; ++i) {
    const std::string name = "Mesh_PrimitiveVertexColor";
    const std::string file = sceneFile("asset-generator/" + name + "/" + name + "_0" + std::to_string(i) + ".gltf");
    if (file.empty()) GTEST_SKIP();
    const scene::Scene scene = scene::importGltf(file);
    EXPECT_TRUE(scene::prepareScene(scene).traits.vertexColors);
    frames.push_back(show(scene, scene::chooseCamera(scene, "", 1), 32));
  }
  std::set<long> reds;
  for (size_t i = 0; i < frames[0].pixels.size(); ++i) {
    reds.insert(std::lround(frames[0].pixels[i].f0Root.r * 100));
    for (const GFrame& frame : frames) {
      // Bytes and shorts are rounded by up to half of 1/255.
      EXPECT_LT(glm::length(frame.pixels[i].f0Root - frames[0].pixels[i].f0Root), 0.01);
      EXPECT_EQ(frame.pixels[i].distance, frames[0].pixels[i].distance);
    }
  }
  EXPECT_GT(reds.size(), 10u) << "colours vary";
}

}  // namespace
}  // namespace weir::test
