// The scenes of scenes/make_scenes.py.
#include "scene_support.h"

#include <weir/scene/packing.h>

namespace weir::scene::test {
namespace {

Scene own(const std::string& name) {
  return importGltf(WEIR_SOURCE_DIR "/scenes/" + name);
}

TEST(OwnScenes, CornellHasADownwardLampAndACamera) {
  const Scene scene = own("cornell.glb");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.cameras.size(), 1u);
  const PreparedScene p = prepareScene(scene);
  EXPECT_EQ(p.droppedTriangles, 0u);
  ASSERT_EQ(p.lights.size(), 2u);
  for (const auto& light : p.lights) {
    EXPECT_LT(glm::cross(light.a, light.b).y, 0.0f);
    EXPECT_EQ(light.kind, static_cast<uint32_t>(GpuLightKind::Triangle));
    EXPECT_NEAR(light.pdf, 0.5f, 1e-6f);
    EXPECT_NEAR(light.radiance.x, 17.0f, 1e-4f);
  }
}

// What docs/offline.md compares with a renderer that has another idea of a dielectric's surface.
TEST(OwnScenes, LambertianScenesReflectNothingElse) {
  for (const std::string name : {"cornell-lambert.glb", "interior.glb"}) {
    const Scene scene = own(name);
    EXPECT_TRUE(scene.warnings.empty()) << name;
    const PreparedScene p = prepareScene(scene);
    ASSERT_EQ(p.speculars.size(), scene.materials.size() + 1) << name;  // the last one is for primitives without any
    for (size_t i = 0; i < scene.materials.size(); ++i) {
      EXPECT_EQ(scene.materials[i].metallic, 0.0f) << name << ": " << i;
      EXPECT_EQ(p.speculars[i].weight, 0.0f) << name << ": " << i;  // scales F0 and F90
    }
    EXPECT_TRUE(p.traits.dielectricSpecular && p.traits.f90) << name;
    EXPECT_TRUE(scene.images.empty()) << name;
  }
}

TEST(OwnScenes, TheInteriorIsLitInFourWays) {
  const Scene scene = own("interior.glb");
  const SceneSummary s = summarize(scene);
  EXPECT_EQ(s.pointLights, 1u);
  EXPECT_EQ(s.directionalLights, 1u);
  EXPECT_EQ(s.emissiveTriangles, 2u + 6 * 8);  // a panel, and a lantern of two cones and two bands of eight quads
  EXPECT_GT(s.instancedTriangles, 3000u);
}

TEST(OwnScenes, AThousandPointsInsideTheRoom) {
  const Scene scene = own("cornell-1000-points.glb");
  const SceneSummary s = summarize(scene);
  EXPECT_EQ(s.pointLights, 1000u);
  EXPECT_EQ(s.emissiveTriangles, 0u);
  for (const auto& light : scene.lights) {
    EXPECT_TRUE(glm::all(glm::greaterThan(light.position, s.bounds.low)) &&
                glm::all(glm::lessThan(light.position, s.bounds.high)));
    EXPECT_GT(luminance(light.intensity), 0.0f);
  }
}

TEST(OwnScenes, MaterialsAndMasks) {
  const Scene spheres = own("materials.glb"), cutouts = own("alpha-mask.glb");
  EXPECT_EQ(spheres.materials.size(), 30u);
  EXPECT_EQ(spheres.lights.size(), 1u);
  EXPECT_EQ(summarize(spheres).emissiveTriangles, 2u);
  EXPECT_EQ(summarize(cutouts).maskedMaterials, 2u);
  EXPECT_EQ(summarize(cutouts).emissiveTriangles, 2u);
  const PreparedScene p = prepareScene(cutouts);
  EXPECT_EQ(p.ranges[1].masked, 28u);
  ASSERT_EQ(p.textures.size(), 2u);
  for (const auto& texture : p.textures) {
    // Both textures have holes and solid parts.
    const Image& image = cutouts.images[texture.image];
    bool hole = false, solid = false;
    for (size_t i = 3; i < image.rgba.size(); i += 4) {
      hole |= image.rgba[i] == 0;
      solid |= image.rgba[i] == 255;
    }
    EXPECT_TRUE(hole && solid);
  }
}

TEST(OwnScenes, EveryNormalFacesLikeItsTriangle) {
  for (const std::string name : {"cornell.glb", "cornell-lambert.glb", "cornell-1000-points.glb", "interior.glb",
                                 "materials.glb", "alpha-mask.glb"}) {
    const Scene scene = own(name);
    EXPECT_EQ(chooseCamera(scene, "", 1.0f).name, "main");
    const PreparedScene p = prepareScene(scene);
    for (const auto& t : p.triangles) {
      const glm::vec3 face =
          glm::cross(p.positions[t.v[1]] - p.positions[t.v[0]], p.positions[t.v[2]] - p.positions[t.v[0]]);
      for (uint32_t v : t.v) ASSERT_GT(glm::dot(face, unpackNormal(p.vertices[v].normal)), 0.0f) << name;
    }
  }
}

}  // namespace
}  // namespace weir::scene::test
