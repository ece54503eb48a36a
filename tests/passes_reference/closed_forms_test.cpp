// reference.AllLights against closed forms and quadrature in double precision. The expected BSDF is written from
// glTF 2.0, appendix B.
#include "passes_reference/reference_picture.h"

namespace weir::test {
namespace {

TEST(AllLights, PointLightOnAPlane) {
  for (const auto& [metallic, roughness] : {std::pair(0.0f, 1.0f), {0.0f, 0.4f}, {1.0f, 0.3f}, {0.5f, 0.7f}}) {
    SCOPED_TRACE(testing::Message() << "metallic " << metallic << ", roughness " << roughness);
    Builder b = floorOf({0.8f, 0.5f, 0.2f}, metallic, roughness);
    const glm::vec3 at(0.4f, 1.2f, -0.3f);
    b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, at});
    const Picture p = render(b.scene, kAbove);
    const size_t n =
        forSurfaces(b.scene, kAbove, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
          const glm::dvec3 d = glm::dvec3(at) - s.position;
          expectNear(color, bsdfCos(s, view, glm::normalize(d)) * glm::dvec3(kIntensity) / glm::dot(d, d), 6e-3, i);
        });
    EXPECT_GT(n, 300u);
  }
}

// Without specular reflection (F0 is 4 % all the same) I ρ cosθ/(π d²) must come out of the diffuse part: straight
// above, where Fresnel's term is least, the whole differs from it by what the formulas say, a few per cent.
TEST(AllLights, LambertIsWhatTheDiffusePartIs) {
  Builder b = floorOf({1, 1, 1}, 0, 1);
  b.scene.lights.push_back({"", scene::LightKind::Point, glm::vec3(5), {0, 1.5f, 0}});
  const scene::Camera camera = lookAt({0, 2, 0.01f}, {0, 0, 0}, 20);
  const Picture p = render(b.scene, camera);
  forSurfaces(b.scene, camera, p, [&](uint32_t, const OracleSurface& s, glm::dvec3, glm::dvec3 color) {
    const glm::dvec3 d = glm::dvec3(0, 1.5, 0) - s.position;
    const double lambert = 5 * d.y / glm::length(d) / (kPi * glm::dot(d, d));
    EXPECT_NEAR(color.x / lambert, 0.96 + 0.04 * 0.25, 0.012);  // D V of roughness 1 is 1/(4π)
  });
}

TEST(AllLights, DirectionalLight) {
  Builder b = floorOf({0.7f, 0.7f, 0.7f}, 0, 0.5f);
  const glm::vec3 way = glm::normalize(glm::vec3(0.3f, -1, 0.4f));
  b.scene.lights.push_back({"", scene::LightKind::Directional, kIntensity, {}, way});
  const Picture p = render(b.scene, kAbove);
  const size_t n =
      forSurfaces(b.scene, kAbove, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
        expectNear(color, bsdfCos(s, view, -glm::dvec3(way)) * glm::dvec3(kIntensity), 6e-3, i);
      });
  EXPECT_GT(n, 300u);
}

TEST(AllLights, SpotConesAndRange) {
  Builder b = floorOf({0.6f, 0.6f, 0.6f}, 0, 1);
  scene::PunctualLight spot{
      "", scene::LightKind::Spot, kIntensity, {0, 1.5f, 0}, glm::normalize(glm::vec3(0.1f, -1, 0)), 2.2f};
  spot.innerCone = 0.25f;
  spot.outerCone = 0.5f;
  b.scene.lights.push_back(spot);
  const Picture p = render(b.scene, kAbove);
  size_t inside = 0, penumbra = 0, outside = 0;
  forSurfaces(b.scene, kAbove, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
    const glm::dvec3 d = glm::dvec3(spot.position) - s.position;
    const double r2 = glm::dot(d, d), cosine = glm::dot(-glm::normalize(d), glm::dvec3(spot.direction));
    // KHR_lights_punctual's recommended falloffs.
    const double t = std::clamp((cosine - std::cos(0.5)) / (std::cos(0.25) - std::cos(0.5)), 0.0, 1.0);
    const double window = std::clamp(1 - std::pow(std::sqrt(r2) / spot.range, 4), 0.0, 1.0);
    const glm::dvec3 expected = bsdfCos(s, view, glm::normalize(d)) * glm::dvec3(kIntensity) * (t * t * window / r2);
    // Single precision takes differences of cosines.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], 6e-3 * expected[c] + 1e-5) << "pixel " << i;
    ++(t >= 1 ? inside : t > 0 ? penumbra : outside);
    if (t == 0) {
      EXPECT_EQ(color, glm::dvec3(0));
    }
  });
  EXPECT_GT(inside, 10u);
  EXPECT_GT(penumbra, 10u);
  EXPECT_GT(outside, 10u);
}

TEST(AllLights, RangeEndsAPointLight) {
  Builder b = floorOf({0.6f, 0.6f, 0.6f}, 0, 1);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, {0, 0.5f, 0}, {0, 0, -1}, 0.8f});
  const Picture p = render(b.scene, kAbove);
  size_t dark = 0;
  forSurfaces(b.scene, kAbove, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
    const glm::dvec3 d = glm::dvec3(0, 0.5, 0) - s.position;
    const double window = std::clamp(1 - std::pow(glm::length(d) / 0.8, 4), 0.0, 1.0);
    expectNear(color, bsdfCos(s, view, glm::normalize(d)) * glm::dvec3(kIntensity) * (window / glm::dot(d, d)), 0.01,
               i);
    dark += window == 0;
    if (window == 0) {
      EXPECT_EQ(color, glm::dvec3(0));
    }
  });
  EXPECT_GT(dark, 50u);
}

// ∫ BSDF · L over a polygon by midpoint quadrature, as fine as the test needs.
glm::dvec3 quadrature(const OracleSurface& s, const glm::dvec3& view, const glm::dvec3 corner, const glm::dvec3 e1,
                      const glm::dvec3 e2, const glm::dvec3& radiance, bool doubleSided, int n) {
  glm::dvec3 sum(0);
  const glm::dvec3 normalArea = glm::cross(e1, e2);
  for (int i = 0; i < n * n; ++i) {
    const glm::dvec3 d = corner + e1 * ((i % n + 0.5) / n) + e2 * ((i / n + 0.5) / n) - s.position;
    const double r = glm::length(d), facing = -glm::dot(normalArea, d) / r;
    sum += bsdfCos(s, view, d / r) * ((doubleSided ? std::abs(facing) : std::max(facing, 0.0)) / (r * r));
  }
  return sum * radiance / double(n * n);
}

/// Irradiance of a polygon on a plane by Lambert's formula: Σ γ_i (n · Γ_i) / 2 (L = 1).
double lambertPolygon(const glm::dvec3& at, const glm::dvec3& normal, const std::vector<glm::dvec3>& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - at), b = glm::normalize(corners[(i + 1) % corners.size()] - at);
    sum += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::dot(normal, glm::normalize(glm::cross(a, b)));
  }
  return std::abs(sum) / 2;
}

/// A quad lamp over the floor that faces down (or up), of these kinds.
void addLamp(Builder& b, bool facesDown, bool doubleSided, float size = 1) {
  scene::Material m;
  m.emission = glm::vec3(4, 3, 2);
  m.doubleSided = doubleSided;
  const int material = b.material(m);
  const float x = 0.4f * size, z = 0.3f * size;
  const glm::vec3 p0(-x, 1, -z), p1(x, 1, -z), p2(x, 1, z), p3(-x, 1, z);
  b.add(facesDown ? quad(p0, p1, p2, p3, material) : quad(p0, p3, p2, p1, material));
}

// Mean over the picture of samples: 16² strata on 2 triangles × 4 frames for 300 pixels and more. Stratified sampling
// of a smooth integrand leaves less than 1e-3 a pixel; bounds are ten times that.
// The small lamp is one that the pass samples by area, the large one it samples by solid angle.
TEST(AllLights, QuadLightByLambertsFormulaAndQuadrature) {
  const scene::Camera camera = lookAt({0.2f, 0.6f, 2.0f}, {0, 0, 0}, 40);
  for (const double size : {1.0, 0.02}) {
    for (const auto& [down, doubleSided] : {std::pair(true, false), {true, true}, {false, true}}) {
      SCOPED_TRACE(testing::Message() << (down ? "faces down" : "faces up") << (doubleSided ? ", double-sided" : "")
                                      << ", size " << size);
      Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 1);
      addLamp(b, down, doubleSided, static_cast<float>(size));
      const Picture p = render(b.scene, camera, 16, 4);
      const double x = 0.4 * size, z = 0.3 * size;
      size_t n = 0;
      forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
        if (s.position.y > 0.5) return;  // the lamp itself
        ++n;
        const glm::dvec3 expected =
            quadrature(s, view, {-x, 1, -z}, {2 * x, 0, 0}, {0, 0, 2 * z}, {4, 3, 2}, true, size < 1 ? 8 : 48);
        expectNear(color, expected, 0.02, i);
        // The diffuse part alone is albedo/π times Lambert's irradiance, less what Fresnel takes: between 85 % and 97 %
        // of it at these angles, plus the specular part.
        const double irradiance =
            lambertPolygon(s.position, {0, 1, 0}, {{-x, 1, -z}, {x, 1, -z}, {x, 1, z}, {-x, 1, z}});
        const double lambert = 0.8 / kPi * irradiance * 4;
        EXPECT_GT(color.x, 0.8 * lambert);
        EXPECT_LT(color.x, 1.2 * lambert);
      });
      EXPECT_GT(n, 150u);
    }
  }
}

// Floor beside a lamp that stands on it, millimetres away from a lamp of a metre: a long sliver of hardly any solid
// angle, whose nearest points weigh a million times its farthest. Sampled uniformly in area, or with angles that
// cancel, single pixels are off by orders of magnitude.
TEST(AllLights, SliversOfALampThatTouchesTheFloorAreBounded) {
  Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 1);
  scene::Material m;
  m.emission = glm::vec3(4, 3, 2);
  b.add(quad({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, b.material(m)));  // faces +x
  const scene::Camera camera = lookAt({1e-4f, 0.05f, -0.02f}, {1e-4f, 0, -0.0199f}, 0.2f);
  const Picture p = render(b.scene, camera, 4, 4);
  size_t front = 0;
  forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface& s, glm::dvec3, glm::dvec3 color) {
    if (s.position.y > 1e-4 || s.position.x < 1e-5) return;
    ++front;
    const double lambert =
        0.8 / kPi * 4 * lambertPolygon(s.position, {0, 1, 0}, {{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}});
    // The diffuse part is 0.8 … 0.96 of it, the specular part of roughness 1 adds some per cent.
    EXPECT_GT(color.x, 0.8 * lambert) << "pixel " << i;
    EXPECT_LT(color.x, 1.25 * lambert) << "pixel " << i;
  });
  EXPECT_GT(front, 200u);
}

// A white metal floor, all but a mirror, shows the lamp above it as bright as the lamp itself: where its whole lobe
// meets the lamp, all of the radiance less what Smith's term shadows. Points on the lamp alone would leave most pixels
// black and few a hundred times too bright; samples along the lobe bound each pixel, and the mean shows no bias.
TEST(AllLights, MirrorsShowTheLampWithoutFireflies) {
  for (const double roughness : {0.02, 0.1}) {
    SCOPED_TRACE(roughness);
    Builder b = floorOf({1, 1, 1}, 1, static_cast<float>(roughness));
    addLamp(b, true, false, 2);
    const scene::Camera camera = lookAt({0, 0.8f, 0.4f}, {0, 0, 0.1f}, 8);
    const Picture p = render(b.scene, camera, 2);
    glm::dvec3 mean(0);
    const size_t n =
        forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface&, glm::dvec3, glm::dvec3 color) {
          mean += color;
          EXPECT_GT(color.x, 4 * 0.2) << "pixel " << i;
          EXPECT_LT(color.x, 4 * 2.5) << "pixel " << i;
        });
    ASSERT_GT(n, 500u);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / static_cast<double>(n), 4 - c, 0.03 * (4 - c));
  }
}

// A lamp lies in its own plane: whatever rounding makes of that, it sends itself no light.
TEST(AllLights, ALampShowsItsEmissionAlone) {
  Builder b;
  scene::Material m;
  m.emission = glm::vec3(4, 3, 2);
  const glm::vec3 origin(7.3f, -4.1f, 2.7f), u(0.6f, 0.31f, -0.17f), v(-0.23f, 0.71f, 0.37f);
  b.add(quad(origin, origin + u, origin + u + v, origin + v, b.material(m)));
  const glm::vec3 middle = origin + 0.5f * (u + v), front = glm::normalize(glm::cross(u, v));
  const scene::Camera camera = lookAt(middle + 2.0f * front, middle, 30);
  const Picture p = render(b.scene, camera, 2, 4);
  const size_t n = forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface&, glm::dvec3, glm::dvec3 color) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], m.emission[c], 1e-5) << "pixel " << i;
  });
  EXPECT_GT(n, 100u);
}

// A lamp that only seems to shine: each way of sampling must know its front.
TEST(AllLights, LampsThatFaceAwayAndLightsBelowTheHorizonGiveNothing) {
  Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 0.5f);
  addLamp(b, false, false);
  addLamp(b, false, false, 0.02f);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, {0, -0.5f, 0}});
  b.scene.lights.push_back({"", scene::LightKind::Directional, kIntensity, {}, {0, 1, 0}});
  const scene::Camera camera = lookAt({0.2f, 0.6f, 2.0f}, {0, 0, 0}, 40);
  const Picture p = render(b.scene, camera, 2);
  const size_t n = forSurfaces(b.scene, camera, p, [&](uint32_t, const OracleSurface& s, glm::dvec3, glm::dvec3 color) {
    if (s.position.y < 0.5) {
      EXPECT_EQ(color, glm::dvec3(0));
    }
  });
  EXPECT_GT(n, 150u);
}

TEST(AllLights, NothingLeaksThroughAWallWithoutThickness) {
  // Two rooms that share one quad; lights of every kind in one, the camera in the other.
  Builder b;
  for (const float side : {-1.0f, 1.0f}) {
    const float x0 = side < 0 ? -2.0f : 0.0f, x1 = x0 + 2.0f;
    scene::Material m;
    m.doubleSided = true;
    const int grey = b.material(m);
    b.add(quad({x0, 0, 1}, {x1, 0, 1}, {x1, 0, -1}, {x0, 0, -1}, grey));
    b.add(quad({x0, 2, -1}, {x1, 2, -1}, {x1, 2, 1}, {x0, 2, 1}, grey));
    b.add(quad({x0, 0, -1}, {x1, 0, -1}, {x1, 2, -1}, {x0, 2, -1}, grey));
    b.add(quad({x1, 0, 1}, {x0, 0, 1}, {x0, 2, 1}, {x1, 2, 1}, grey));
    if (side < 0) b.add(quad({0, 0, -1}, {0, 0, 1}, {0, 2, 1}, {0, 2, -1}, grey));  // between the rooms
    b.add(quad({side * 2, 0, -1}, {side * 2, 0, 1}, {side * 2, 2, 1}, {side * 2, 2, -1}, grey));
  }
  scene::Material lamp;
  lamp.emission = glm::vec3(1e4f);
  lamp.doubleSided = true;
  b.add(quad({0.2f, 1, -0.5f}, {0.9f, 1.2f, -0.5f}, {0.9f, 1.2f, 0.5f}, {0.2f, 1, 0.5f}, b.material(lamp)));
  b.scene.lights.push_back({"", scene::LightKind::Point, glm::vec3(1e4f), {0.01f, 1, 0}});
  b.scene.lights.push_back({"", scene::LightKind::Spot, glm::vec3(1e4f), {1.5f, 1, 0}, {-1, 0, 0}});
  const scene::Camera camera = lookAt({-1.9f, 1, 0.1f}, {0, 0.9f, 0}, 95);
  const Picture p = render(b.scene, camera, 4);
  const size_t n = forSurfaces(b.scene, camera, p, [&](uint32_t i, const OracleSurface&, glm::dvec3, glm::dvec3 color) {
    EXPECT_EQ(color, glm::dvec3(0)) << "pixel " << i;
  });
  EXPECT_EQ(n, size_t{kSide} * kSide);
}

// A lamp whose texture is black on one half and bright on the other equals a lamp of the bright half alone.
TEST(AllLights, TexturedEmitter) {
  const scene::Camera camera = lookAt({0.2f, 0.6f, 2.0f}, {0, 0, 0}, 40);
  Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 1);
  addLamp(b, true, false);
  const int half = b.texture(
      2, 1, [](uint32_t x, uint32_t) { return x == 0 ? glm::u8vec4(0, 0, 0, 255) : glm::u8vec4(255); },
      scene::Filter::Nearest, scene::Wrap::ClampToEdge);
  b.scene.materials.back().emissiveTexture.texture = half;
  const Picture p = render(b.scene, camera, 16, 8);
  size_t n = 0;
  glm::dvec3 sum(0), expectedSum(0);
  forSurfaces(b.scene, camera, p, [&](uint32_t, const OracleSurface& s, glm::dvec3 view, glm::dvec3 color) {
    if (s.position.y > 0.5) return;
    ++n;
    // u runs along x: the bright half is x > 0.
    const glm::dvec3 expected = quadrature(s, view, {0, 1, -0.3}, {0.4, 0, 0}, {0, 0, 0.6}, {4, 3, 2}, false, 48);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], 0.05 * expected[c]);  // strata that the edge cuts
    sum += color;
    expectedSum += expected;
  });
  EXPECT_GT(n, 150u);
  EXPECT_NEAR(sum.x / expectedSum.x, 1.0, 5e-3);
  EXPECT_NEAR(sum.z / sum.x, 0.5, 2e-3);
}

TEST(AllLights, BlendedSurfacesLetLightThroughByTheirAlpha) {
  Builder b = floorOf({0.8f, 0.8f, 0.8f}, 0, 1);
  b.scene.lights.push_back({"", scene::LightKind::Point, kIntensity, {0, 1.5f, 0}});
  scene::Material veil;
  veil.alphaMode = scene::AlphaMode::Blend;
  veil.baseColor.a = 0.25f;
  veil.doubleSided = true;
  const int material = b.material(veil);
  const scene::Camera camera = lookAt({0.3f, 1.1f, 1.5f}, {0, 0, 0}, 40);
  const Picture before = render(b.scene, camera);
  // Under the light, over the camera.
  b.add(quad({-1.9f, 1.4f, -1.9f}, {1.9f, 1.4f, -1.9f}, {1.9f, 1.4f, 1.9f}, {-1.9f, 1.4f, 1.9f}, material));
  const Picture after = render(b.scene, camera);
  size_t n = 0;
  for (size_t i = 0; i < before.color.size(); ++i) {
    if (before.surface[i].distance == 0 || before.color[i].x < 1e-3f) continue;
    EXPECT_NEAR(after.color[i].x / before.color[i].x, 0.75, 2e-3);
    ++n;
  }
  EXPECT_GT(n, 200u);
}

TEST(AllLights, AnEmptySceneIsBlack) {
  for (const glm::vec4& c : render({}, kAbove).color) EXPECT_EQ(glm::vec3(c), glm::vec3(0));
}

}  // namespace
}  // namespace weir::test
