// A moving scene on the device against the same moment worked out on the CPU: what is seen, and where it was.
#include "passes_gbuffer/gbuffer_frame.h"
#include "support/posed_scene.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 48;

/// Frames at these moments of a clip; the last one shows the scene there, and moved from where the last but one was.
void expectMoment(const std::string& type, const scene::Scene& scene, const std::string& clip,
                  const std::vector<double>& moments, const scene::Camera& before, const scene::Camera& now,
                  bool expectDeformation) {
  SCOPED_TRACE(type + " " + clip);
  PassTest t(type);
  t.size(kSide, kSide).scene(scene).clip(clip);
  for (size_t i = 0; i < moments.size(); ++i) t.camera(i + 1 < moments.size() ? before : now).at(moments[i]).run();
  EXPECT_TRUE(t.prepared().traits.animated);
  EXPECT_EQ(t.prepared().traits.deforms, expectDeformation);
  const GFrame frame = readFrame(t, kSide, kSide);

  const scene::Scene there = posedScene(scene, clip, moments.back());
  const scene::Scene was = posedScene(scene, clip, moments.size() > 1 ? moments[moments.size() - 2] : moments.back());
  const scene::PreparedScene prepared = scene::prepareScene(there);
  expectOracle(frame, RayOracle(there, prepared), now, {.normal = 4e-4}, 0.02);

  size_t wrong = 0, moved = 0;
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      const GPixel& p = frame.at(x, y);
      if (!(p.distance > 0.0)) continue;
      const glm::dvec2 point = glm::dvec2(x, y) + 0.5;
      const glm::dvec3 d = oracleDirection(now, point, kSide, kSide);
      const auto found = pointAlong(there, glm::dvec3(now.eye), d, p.distance, 1e-4 * p.distance);
      if (!found) continue;  // on an edge, by rounding
      const glm::dvec3 project = oracleProject(before, positionOf(was, *found), kSide, kSide);
      const glm::dvec2 expected = glm::dvec2(project) - point;
      moved += glm::length(positionOf(was, *found) - positionOf(there, *found)) > 1e-3 ? 1 : 0;
      if (!(glm::length(p.motion - expected) <= 0.01) && ++wrong <= 5) {
        ADD_FAILURE() << "pixel " << x << ", " << y << ": " << p.motion.x << ", " << p.motion.y << " instead of "
                      << expected.x << ", " << expected.y;
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  if (moments.size() > 1) {
    EXPECT_GT(moved, 20u) << "pixels of what moves";
  }
}

struct Case {
  const char* type;
  const char* clip;
  bool deforms;
};

class Moving : public testing::TestWithParam<Case> {};

TEST_P(Moving, ShowsTheMomentAndWhereItWasBefore) {
  const scene::Scene scene = own("cornell-moving.glb");
  const scene::Camera a = lookAt({0, 1, 3.2f}, {0, 0.9f, 0}, 45), b = lookAt({0.05f, 1.02f, 3.15f}, {0, 0.9f, 0}, 45);
  // Several frames, so that both halves have been written and refitted.
  expectMoment(GetParam().type, scene, GetParam().clip, {0.2, 0.55, 0.7, 0.8}, a, a, GetParam().deforms);
  expectMoment(GetParam().type, scene, GetParam().clip, {0.2, 0.3, 0.4}, a, b, GetParam().deforms);
}

INSTANTIATE_TEST_SUITE_P(
    Clips, Moving,
    testing::Values(Case{"gbuffer.RayTraced", "block", false}, Case{"gbuffer.RayTraced", "column", true},
                    Case{"gbuffer.RayTraced", "ball", true}, Case{"gbuffer.RayTraced", "everything", true},
                    Case{"gbuffer.Raster", "block", false}, Case{"gbuffer.Raster", "everything", true}),
    [](const auto& which) { return std::string(which.param.type).substr(8) + "_" + which.param.clip; });

TEST(MovingScene, HasNoPastInItsFirstFrameAndAfterACut) {
  const scene::Scene scene = own("cornell-moving.glb");
  const scene::Camera camera = lookAt({0, 1, 3.2f}, {0, 0.9f, 0}, 45);
  PassTest t("gbuffer.RayTraced");
  t.size(kSide, kSide).scene(scene).clip("everything").camera(camera);
  t.at(0.3).run();
  for (const GPixel& p : readFrame(t, kSide, kSide).pixels) ASSERT_LT(glm::length(p.motion), 1e-3);
  t.at(0.9);
  t.resetHistory();
  t.run();
  const GFrame frame = readFrame(t, kSide, kSide);
  for (const GPixel& p : frame.pixels) ASSERT_LT(glm::length(p.motion), 1e-3);
  const scene::Scene there = posedScene(scene, "everything", 0.9);
  expectOracle(frame, RayOracle(there, scene::prepareScene(there)), camera, {.normal = 4e-4}, 0.02);
}

// Triangles without stored normals are flat in every frame, whatever the skin does to them.
TEST(MovingScene, FlatTrianglesStayFlatWhileTheyBend) {
  scene::Scene scene = own("cornell-moving.glb");
  for (scene::Mesh& mesh : scene.meshes) {
    if (mesh.name != "column" && mesh.name != "ball") continue;
    for (scene::Primitive& primitive : mesh.primitives) {
      primitive.normals.clear();
      for (scene::MorphTarget& target : primitive.targets) target.normals.clear();
    }
  }
  const scene::Camera camera = lookAt({0, 1, 3.2f}, {0, 0.9f, 0}, 45);
  expectMoment("gbuffer.RayTraced", scene, "everything", {0.2, 0.5, 0.6}, camera, camera, true);
}

/// A node whose scale is animated through a mirror image: the sides that a camera sees change with it.
TEST(MovingScene, MirrorsWhileItMoves) {
  scene::Scene scene = own("cornell-moving.glb");
  for (scene::Clip& clip : scene.clips) {
    if (clip.name != "block") continue;
    scene::Channel scale;
    scale.node = clip.channels.front().node;
    scale.path = scene::AnimatedPath::Scale;
    scale.times = {0, 1, 2};
    scale.values = {1, 1, 1, -1, 1, 1, 1, 1, 1};
    clip.channels.push_back(scale);
  }
  const scene::Camera camera = lookAt({0, 1, 3.2f}, {0, 0.9f, 0}, 45);
  expectMoment("gbuffer.RayTraced", scene, "block", {0.2, 0.75, 0.9}, camera, camera, false);
  expectMoment("gbuffer.Raster", scene, "block", {0.2, 0.75, 0.9}, camera, camera, false);
}

}  // namespace
}  // namespace weir::test
