// The material models of glTF's extensions under light, by reference.AllLights.
#include "passes_reference/reference_picture.h"

namespace weir::test {
namespace {

/// A ball on a floor, both of one material, under a lamp, a point light and the sun.
scene::Scene still(const scene::Material& material) {
  Builder b;
  const int m = b.material(material);
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, m));
  b.add(sphere(16, 32, m), glm::mat4(0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0.5f, 0, 1));
  scene::Material lamp;
  lamp.emission = {4, 5, 6};
  b.add(quad({-0.5f, 2, -0.5f}, {0.5f, 2, -0.5f}, {0.5f, 2, 0.5f}, {-0.5f, 2, 0.5f}, b.material(lamp)));
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, {1.2f, 1.2f, 1}});
  b.scene.lights.push_back({"", scene::LightKind::Directional, {0.3f, 0.3f, 0.4f}, {}, {0, -0.8f, -0.6f}});
  return b.scene;
}

// The same reflection written in both models: what is left is how colours are packed. Acceptance asks for 0.5 %.
TEST(MaterialModels, SpecularGlossinessAndMetallicRoughnessAreOneMaterial) {
  const glm::vec3 c(0.8f, 0.5f, 0.2f);
  for (const auto& [metallic, roughness] : {std::pair(0.0f, 0.3f), {0.5f, 0.8f}, {1.0f, 0.4f}}) {
    SCOPED_TRACE(testing::Message() << "metallic " << metallic << ", roughness " << roughness);
    scene::Material mr, sg;
    mr.baseColor = glm::vec4(c, 1);
    mr.metallic = metallic;
    mr.roughness = roughness;
    sg.model = scene::MaterialModel::SpecularGlossiness;
    sg.specularColor = glm::mix(glm::vec3(0.04f), c, metallic);
    const float most = std::max({sg.specularColor.r, sg.specularColor.g, sg.specularColor.b});
    sg.baseColor = glm::vec4(c * (1 - metallic) / (1 - most), 1);
    sg.glossiness = 1 - roughness;
    const Picture a = render(still(mr), kAbove, 3), b = render(still(sg), kAbove, 3);
    glm::dvec3 sumA(0), sumB(0);
    for (size_t i = 0; i < a.color.size(); ++i) {
      sumA += glm::dvec3(a.color[i]);
      sumB += glm::dvec3(b.color[i]);
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(sumA[k], 1.0);
      EXPECT_NEAR(sumB[k] / sumA[k], 1.0, 5e-3);
    }
  }
}

TEST(MaterialModels, IorAndSpecularAgainstTheFormula) {
  struct Case {
    float ior, specular, metallic;
    glm::vec3 color;
  };
  for (const Case& c : {Case{1.1f, 1, 0, {1, 1, 1}}, Case{2.4f, 1, 0, {1, 1, 1}}, Case{1.5f, 0, 0, {1, 1, 1}},
                        Case{1.5f, 0.5f, 0.3f, {1, 1, 1}}, Case{1.8f, 0.7f, 0, {3, 0.5f, 1}}}) {
    SCOPED_TRACE(testing::Message() << "ior " << c.ior << ", specular " << c.specular);
    Builder b = floorOf({0.8f, 0.5f, 0.2f}, c.metallic, 0.5f);
    b.scene.materials[0].ior = c.ior;
    b.scene.materials[0].specular = c.specular;
    b.scene.materials[0].specularColor = c.color;
    // Low opposite the camera: grazing angles, where F90 counts.
    const glm::vec3 at(0, 0.4f, -3);
    const scene::Camera low = lookAt({0, 0.5f, 2.5f}, {0, 0, 0}, 50);
    b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, at});
    const Picture p = render(b.scene, low);
    double sum = 0, expectedSum = 0;
    forSurfaces(b.scene, low, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
      const glm::dvec3 d = glm::dvec3(at) - s.position;
      const glm::dvec3 expected = bsdfCos(s, view, glm::normalize(d)) * glm::dvec3(kIntensity) / glm::dot(d, d);
      // F90 has steps of 1/63 and is rounded up or down at random; the peak of the lobe answers roughness in steps of
      // 1/1023 fourfold. The mean over 24² pixels keeps neither.
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(color[k], expected[k], 0.04 * expected[k] + 1e-6) << "pixel " << i;
      sum += color.x;
      expectedSum += expected.x;
    });
    EXPECT_NEAR(sum / expectedSum, 1.0, 0.002);
  }
}

// The extension gives c_diff = diffuse (1 - max F0) and F0; appendix B's 1 - F is then a colour. At grazing angles,
// where F counts, and with a colour that would show the largest channel taken for all.
TEST(MaterialModels, ColouredSpecularGlossinessAgainstTheFormula) {
  Builder b = floorOf({0.8f, 0.5f, 0.2f}, 0, 0.5f);
  scene::Material& m = b.scene.materials[0];
  m.model = scene::MaterialModel::SpecularGlossiness;
  m.specularColor = {0.6f, 0.1f, 0.02f};
  m.glossiness = 0.3f;
  const glm::vec3 at(0, 0.4f, -3);
  const scene::Camera low = lookAt({0, 0.5f, 2.5f}, {0, 0, 0}, 50);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, at});
  const Picture p = render(b.scene, low);
  const size_t n =
      forSurfaces(b.scene, low, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.diffuse[k], 0.4 * m.baseColor[k], 1e-6);
        const glm::dvec3 d = glm::dvec3(at) - s.position;
        expectNear(color, bsdfCos(s, view, glm::normalize(d)) * glm::dvec3(kIntensity) / glm::dot(d, d), 0.01, i);
      });
  EXPECT_GT(n, 100u);
}

// Without specular reflection nothing is left but Lambert.
TEST(MaterialModels, SpecularZeroIsLambert) {
  Builder b = floorOf({0.5f, 0.5f, 0.5f}, 0, 0.5f);
  b.scene.materials[0].specular = 0;
  const glm::vec3 at(0.4f, 1.2f, -0.3f);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, at});
  const Picture p = render(b.scene, kAbove);
  forSurfaces(b.scene, kAbove, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3, glm::dvec3 color) {
    const glm::dvec3 d = glm::dvec3(at) - s.position;
    const double cosine = glm::normalize(d).y;
    expectNear(color, glm::dvec3(kIntensity) * (0.5 / kPi * cosine / glm::dot(d, d)), 2e-3, i);
  });
}

TEST(MaterialModels, UnlitIsItsBaseColourUnderAnyLightAndStillCastsShadows) {
  Builder b = floorOf({0.5f, 0.5f, 0.5f}, 0, 1);
  b.scene.lights.push_back({"", scene::LightKind::Point, glm::vec3(100), {0, 3, 0}});
  const scene::Camera camera = lookAt({0, 1.5f, 2.5f}, {0, 0.3f, 0}, 50);
  scene::Material unlit;
  unlit.model = scene::MaterialModel::Unlit;
  unlit.baseColor = {0.7f, 0.2f, 0.05f, 1};
  unlit.doubleSided = true;
  b.add(quad({-0.5f, 1, 0.5f}, {0.5f, 1, 0.5f}, {0.5f, 1, -0.5f}, {-0.5f, 1, -0.5f}, b.material(unlit)));
  const Picture p = render(b.scene, camera);
  size_t shown = 0, shadow = 0, lit = 0;
  forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3, glm::dvec3 color) {
    if (s.position.y > 0.5) {
      ++shown;
      expectNear(color, {0.7, 0.2, 0.05}, 1e-6, i);
    } else if (std::max(std::abs(s.position.x), std::abs(s.position.z)) < 0.6) {
      shadow += color == glm::dvec3(0);
    } else if (std::max(std::abs(s.position.x), std::abs(s.position.z)) > 0.9) {
      lit += color.x > 0;
    }
  });
  EXPECT_GT(shown, 10u);
  EXPECT_GT(shadow, 10u);
  EXPECT_GT(lit, 50u);
}

// A lamp whose texture is bright only where its transformed second set of coordinates points equals a plain one.
TEST(MaterialModels, EmissiveTexturesShineThroughTheirOwnCoordinates) {
  const auto picture = [](bool textured) {
    Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 1);
    scene::Material lamp;
    lamp.emission = {4, 3, 2};
    if (textured) {
      lamp.emissiveTexture.texture = b.texture(
          8, 8, [](uint32_t x, uint32_t y) { return x >= 4 && y >= 4 ? glm::u8vec4(255) : glm::u8vec4(0, 0, 0, 255); },
          scene::Filter::Nearest);
      lamp.emissiveTexture.uvSet = 1;
      lamp.emissiveTexture.transform = {glm::mat2(0, -0.2f, 0.2f, 0), {0.6f, 0.9f}};
    }
    scene::Primitive p = quad({-0.4f, 1, -0.6f}, {0.4f, 1, -0.6f}, {0.4f, 1, 0.6f}, {-0.4f, 1, 0.6f}, b.material(lamp));
    p.uv1 = p.uv0;
    for (glm::vec2& uv : p.uv0) uv *= 0.3f;  // black
    b.add(p);
    return render(b.scene, kAbove, 2);
  };
  const Picture plain = picture(false), textured = picture(true);
  double sum = 0;
  for (size_t i = 0; i < plain.color.size(); ++i) {
    sum += plain.color[i].x;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(textured.color[i][k], plain.color[i][k], 1e-5f * plain.color[i][k]);
  }
  EXPECT_GT(sum, 10.0);
}

}  // namespace
}  // namespace weir::test
