// Which scenes compile shaders with energy compensation.
#include <gtest/gtest.h>

#include <weir/scene/prepared.h>
#include "support/small_scenes.h"

namespace weir::test {
namespace {

bool compensates(const scene::Material& material, bool asked = true) {
  Builder b;
  b.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, b.material(material)));
  b.scene.energyCompensation = asked;
  const scene::PreparedScene p = scene::prepareScene(b.scene);
  EXPECT_EQ(p.specularAlbedo.empty(), !p.traits.energyCompensation);
  EXPECT_EQ(scene::traitDefines(p.traits).find("SCENE_ENERGY_COMPENSATION") != std::string::npos,
            p.traits.energyCompensation);
  return p.traits.energyCompensation;
}

TEST(EnergyCompensation, IsATraitOnlyWhereAskedForAndF0CanBeAboveZero) {
  using scene::MaterialModel;
  scene::Material m;
  EXPECT_FALSE(compensates(m, false));
  EXPECT_TRUE(compensates(m));
  m.metallic = 0;
  EXPECT_TRUE(compensates(m)) << "F0 is 0.04";
  m.specular = 0;
  EXPECT_FALSE(compensates(m));
  m.metallic = 0.1f;
  EXPECT_TRUE(compensates(m));
  scene::Material glass;
  glass.metallic = 0;
  glass.ior = 1;
  EXPECT_FALSE(compensates(glass));
  glass.ior = 1.01f;
  EXPECT_TRUE(compensates(glass));
  scene::Material glossy;
  glossy.model = MaterialModel::SpecularGlossiness;
  glossy.specularColor = glm::vec3(0);
  EXPECT_FALSE(compensates(glossy));
  glossy.specularColor.y = 0.1f;
  EXPECT_TRUE(compensates(glossy));
  glossy.model = MaterialModel::Unlit;
  EXPECT_FALSE(compensates(glossy));
}

TEST(EnergyCompensation, PrimitivesWithoutAMaterialHaveTheDefaultOne) {
  Builder b;
  b.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}));
  b.scene.energyCompensation = true;
  EXPECT_TRUE(scene::prepareScene(b.scene).traits.energyCompensation);
}

}  // namespace
}  // namespace weir::test
