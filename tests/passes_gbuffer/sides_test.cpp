// glTF's rule on sides: the camera sees through the back of a single-sided surface, whichever way its transform turns
// it. Expected values come from the geometry of a sphere, not from any winding.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

struct Case {
  const char* name;
  glm::mat3 linear;
};
const Case kCases[] = {
    {"identity", glm::mat3(1.0f)},
    {"mirrored in x", glm::mat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)},
    {"mirrored in all axes", glm::mat3(-1.0f)},
    {"turned, stretched and mirrored", glm::mat3(0.6f, 0.8f, 0, -1.2f, 0.9f, 0, 0, 0, -0.7f)},
};

GFrame see(const std::string& type, const glm::mat3& linear, bool doubleSided, bool instanced,
           const scene::Camera& camera) {
  Builder b;
  scene::Material m;
  m.doubleSided = doubleSided;
  b.add(sphere(12, 24, b.material(m)), glm::mat4(linear));
  PassTest t(type);
  t.size(32, 32).scene(b.scene).camera(camera).limits(instanced ? scene::PrepareLimits{0, 1} : scene::PrepareLimits{});
  t.run();
  return readFrame(t, 32, 32);
}

class Sides : public testing::TestWithParam<const char*> {};

TEST_P(Sides, OfAnyTransform) {
  for (const Case& c : kCases) {
    for (const bool instanced : {false, true}) {
      SCOPED_TRACE(testing::Message() << c.name << (instanced ? ", instanced" : ", merged"));
      const scene::Camera outside = lookAt({0, 0, 4}, {0, 0, 0}, 40), inside = lookAt({0, 0, 0}, {0, 0, 1}, 60);

      // From outside the near half is seen: closer than the centre, normals towards the camera and away from the
      // middle.
      const GFrame seen = see(GetParam(), c.linear, false, instanced, outside);
      size_t hits = 0;
      for (const GPixel& p : seen.pixels) {
        if (p.distance == 0.0) continue;
        ++hits;
        // The widest case reaches 1.5 m from the axis; a back would lie further away in the middle.
        EXPECT_LT(p.distance, std::hypot(4.0, 1.5));
        EXPECT_GT(p.geometricNormal.z, 0.0);
        EXPECT_GT(glm::dot(p.normal, p.geometricNormal), 0.8);
      }
      EXPECT_GT(hits, 100u);

      // From inside there are only backs.
      const GFrame through = see(GetParam(), c.linear, false, instanced, inside);
      for (const GPixel& p : through.pixels) EXPECT_EQ(p.distance, 0.0);
      const GFrame wall = see(GetParam(), c.linear, true, instanced, inside);
      for (const GPixel& p : wall.pixels) {
        EXPECT_GT(p.distance, 0.3);
        EXPECT_LT(p.geometricNormal.z, 0.0) << "faces the camera in the middle";
        EXPECT_GT(glm::dot(p.normal, p.geometricNormal), 0.8);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(GBuffers, Sides, testing::Values("gbuffer.RayTraced", "gbuffer.Raster"),
                         [](const auto& test) { return std::string(test.param).substr(8); });

TEST(Sides, ABackThatIsHiddenShowsWhatIsBehindIt) {
  // A single-sided wall seen from behind, and a sphere behind the wall.
  Builder b;
  const int grey = b.material({}), other = b.material({});
  b.scene.materials[static_cast<size_t>(other)].roughness = 0.25f;
  b.add(quad({-2, -2, 1}, {-2, 2, 1}, {2, 2, 1}, {2, -2, 1}, grey));  // faces -Z
  b.add(sphere(12, 24, other));
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    PassTest t(type);
    t.size(16, 16).scene(b.scene).camera(lookAt({0, 0, 4}, {0, 0, 0}, 20));
    t.run();
    for (const GPixel& p : readFrame(t, 16, 16).pixels) EXPECT_NEAR(p.roughness, 0.25, 1e-4) << type;
  }
}

}  // namespace
}  // namespace weir::test
