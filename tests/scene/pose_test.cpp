// Interpolation, hierarchy, skins and morph targets against closed forms; sources as in scene/pose.h.
#include "scene_support.h"

#include <weir/scene/pose.h>

namespace weir::scene::test {
namespace {

Channel channelOf(AnimatedPath path, Interpolation interpolation, std::vector<float> times, std::vector<float> values,
                  uint32_t width) {
  return {0, path, interpolation, std::move(times), std::move(values), width};
}

TEST(Sample, StepLinearAndOutsideTheKeys) {
  const std::vector<float> times = {1, 2, 4}, values = {0, 0, 0, 10, 20, 30, -10, 0, 50};
  const Channel linear = channelOf(AnimatedPath::Translation, Interpolation::Linear, times, values, 3);
  EXPECT_EQ(sample(linear, 0.0), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(sample(linear, 1.5), (std::vector<double>{5, 10, 15}));
  EXPECT_EQ(sample(linear, 3.0), (std::vector<double>{0, 10, 40}));
  EXPECT_EQ(sample(linear, 2.0), (std::vector<double>{10, 20, 30}));
  EXPECT_EQ(sample(linear, 99.0), (std::vector<double>{-10, 0, 50}));
  const Channel step = channelOf(AnimatedPath::Translation, Interpolation::Step, times, values, 3);
  EXPECT_EQ(sample(step, 1.999), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(sample(step, 2.0), (std::vector<double>{10, 20, 30}));
}

// x³ - 2x + 1 is a cubic, so that Hermite's curve through its values and slopes is the polynomial itself.
TEST(Sample, CubicSplineIsExactForACubic) {
  const auto f = [](double x) { return x * x * x - 2 * x + 1; };
  const auto slope = [](double x) { return 3 * x * x - 2; };
  std::vector<float> times = {0.5f, 1.25f, 3.0f}, values;
  for (float t : times) {
    for (double v : {slope(t), f(t), slope(t)})
      values.insert(values.end(), {static_cast<float>(v), static_cast<float>(2 * v), static_cast<float>(-v)});
  }
  const Channel c = channelOf(AnimatedPath::Translation, Interpolation::CubicSpline, times, values, 3);
  for (double t = 0.5; t <= 3.0; t += 0.125) {
    const std::vector<double> v = sample(c, t);
    EXPECT_NEAR(v[0], f(t), 1e-5);
    EXPECT_NEAR(v[1], 2 * f(t), 1e-5);
    EXPECT_NEAR(v[2], -f(t), 1e-5);
  }
  EXPECT_NEAR(sample(c, 9.0)[0], f(3.0), 1e-5);
}

TEST(Sample, RotationsTakeTheShorterWayAtConstantSpeed) {
  const auto about = [](double degrees) {
    const double h = glm::radians(degrees) / 2;
    return glm::dvec4(0, 0, std::sin(h), std::cos(h));
  };
  // From 10° to 80°, the second key given as its negative: the same rotation.
  const glm::dvec4 a = about(10), b = -about(80);
  std::vector<float> values;
  for (const glm::dvec4& q : {a, b})
    for (int i = 0; i < 4; ++i) values.push_back(static_cast<float>(q[i]));
  const Channel c = channelOf(AnimatedPath::Rotation, Interpolation::Linear, {0, 1}, values, 4);
  for (double t : {0.0, 0.1, 0.5, 0.9}) {
    const std::vector<double> q = sample(c, t);
    const glm::dvec4 expected = about(10 + 70 * t);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(q[i], expected[i], 1e-7) << t;
  }
  // Equal keys, and keys so close that the sine of their angle vanishes.
  const Channel still = channelOf(AnimatedPath::Rotation, Interpolation::Linear, {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1}, 4);
  EXPECT_EQ(sample(still, 0.3), (std::vector<double>{0, 0, 0, 1}));
}

TEST(Sample, CubicSplineRotationsAreNormalised) {
  const Channel c = channelOf(AnimatedPath::Rotation, Interpolation::CubicSpline, {0, 1},
                              {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, 4);
  for (double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const std::vector<double> q = sample(c, t);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1.0, 1e-12);
  }
  // Half way, before it is normalised: w = 1/2; z = 1/2 + 3/8.
  const std::vector<double> half = sample(c, 0.5);
  EXPECT_NEAR(half[2] / half[3], 0.875 / 0.5, 1e-12);
}

Scene hierarchy() {
  Scene scene;
  scene.nodes.resize(3);
  // A child that the file stores before its parent.
  scene.nodes[0].parent = 2;
  scene.nodes[0].translation = {1, 0, 0};
  scene.nodes[2].translation = {0, 5, 0};
  scene.nodes[2].scale = {2, 2, 2};
  Clip clip;
  clip.name = "turn";
  clip.duration = 1.0;
  // 0° to 90° about z.
  const float r = std::sqrt(0.5f);
  clip.channels.push_back({2, AnimatedPath::Rotation, Interpolation::Linear, {0, 1}, {0, 0, 0, 1, 0, 0, r, r}, 4});
  scene.clips.push_back(clip);
  return scene;
}

TEST(Evaluate, ChildrenFollowTheirParents) {
  const Scene scene = hierarchy();
  const Pose rest = restPose(scene);
  EXPECT_EQ(glm::dvec3(rest.world[0][3]), glm::dvec3(2, 5, 0));
  const Pose pose = evaluate(scene, scene.clips[0], 1.0);
  EXPECT_LT(glm::distance(glm::dvec3(pose.world[0][3]), glm::dvec3(0, 7, 0)), 1e-6);
  EXPECT_EQ(movingNodes(scene, scene.clips[0]), (std::vector<char>{1, 0, 1}));
}

TEST(Evaluate, ClipsStartOverWhenTheyEnd) {
  const Clip clip{"c", {}, 2.0};
  EXPECT_NEAR(wrapped(clip, 0.5), 0.5, 0);
  EXPECT_NEAR(wrapped(clip, 5.25), 1.25, 1e-12);
  EXPECT_EQ(wrapped({"still", {}, 0.0}, 3.0), 0.0);
}

TEST(ChooseClip, ByNameNumberAndNearest) {
  Scene scene = hierarchy();
  scene.path = "scene.glb";
  scene.clips.push_back({"Walk", {}, 1.0});
  EXPECT_EQ(chooseClip(scene, "").name, "turn");
  EXPECT_EQ(chooseClip(scene, "Walk").name, "Walk");
  EXPECT_EQ(chooseClip(scene, "1").name, "Walk");
  const auto message = [&](const std::string& text) -> std::string {
    try {
      chooseClip(scene, text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("walk").find("did you mean \"Walk\""), std::string::npos) << message("walk");
  EXPECT_NE(message("2").find("2"), std::string::npos);
  scene.clips.clear();
  EXPECT_NE(message("").find("no animations"), std::string::npos);
}

Primitive corner() {
  Primitive p;
  p.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  p.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  p.tangents = {{0, 1, 0, 1}, {0, 0, 1, -1}, {1, 0, 0, 1}};
  p.indices = {0, 1, 2};
  return p;
}

TEST(Deformed, MorphTargetsAddUp) {
  Primitive p = corner();
  p.targets = {{{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 0}, {0, 0, 0}, {0, 0, 0}}, {}},
               {{{0, 0, 4}, {0, 2, 0}, {0, 0, 0}}, {}, {}}};
  const Primitive out = deformed(p, {1.0f, 0.5f}, nullptr);
  EXPECT_EQ(out.positions[0], glm::vec3(2, 0, 2));
  EXPECT_EQ(out.positions[1], glm::vec3(0, 2, 0));
  EXPECT_LT(glm::distance(out.normals[0], glm::normalize(glm::vec3(1, 1, 0))), 1e-6f);
  EXPECT_LT(std::abs(glm::dot(out.normals[0], glm::vec3(out.tangents[0]))), 1e-6f);
  EXPECT_EQ(out.tangents[1].w, -1.0f);
}

// Between two joints that turn apart a vertex lies where linear blend skinning puts it: at the mean of both places.
TEST(Deformed, SkinsBlendWhereTheirJointsTakeAVertex) {
  Primitive p = corner();
  p.influencesPerVertex = 4;
  p.influences = {{0, 1}, {0, 0}, {0, 0}, {0, 0}, {1, 1}, {0, 0}, {0, 0}, {0, 0}, {0, 0.5f}, {1, 0.5f}, {0, 0}, {0, 0}};
  glm::mat4 shift(1.0f), turn(0.0f);
  shift[3] = {0, 0, 7, 1};
  turn[0] = {0, 3, 0, 0};  // 90° about z, and three times as large
  turn[1] = {-3, 0, 0, 0};
  turn[2] = {0, 0, 3, 0};
  turn[3] = {0, 0, 0, 1};
  const std::vector<glm::mat4> joints = {shift, turn};
  const Primitive out = deformed(p, {}, &joints);
  EXPECT_EQ(out.positions[0], glm::vec3(1, 0, 7));
  EXPECT_EQ(out.positions[1], glm::vec3(-3, 0, 0));
  EXPECT_EQ(out.positions[2], glm::vec3(0, 0, 5.5f));
  EXPECT_EQ(out.normals[0], glm::vec3(1, 0, 0));
  EXPECT_LT(glm::distance(out.normals[1], glm::vec3(-1, 0, 0)), 1e-6f);
  // Turned over as a whole: the same corners in the other order.
  const Primitive turned = deformed(p, {}, &joints, true);
  EXPECT_EQ(turned.indices, (std::vector<uint32_t>{0, 2, 1}));
  EXPECT_EQ(turned.normals[0], glm::vec3(-1, 0, 0));
}

TEST(Posed, CamerasAndLightsFollowTheirNodes) {
  const Scene scene = hierarchy();
  const Pose pose = evaluate(scene, scene.clips[0], 1.0);
  Camera camera;
  camera.node = 0;
  const Camera moved = posed(camera, pose);
  EXPECT_LT(glm::distance(moved.eye, glm::vec3(0, 7, 0)), 1e-5f);
  EXPECT_LT(glm::distance(moved.up, glm::vec3(-1, 0, 0)), 1e-5f);
  PunctualLight light;
  light.node = 0;
  EXPECT_LT(glm::distance(posed(light, pose).position, glm::vec3(0, 7, 0)), 1e-5f);
  EXPECT_LT(glm::distance(posed(light, pose).direction, glm::vec3(0, 0, -1)), 1e-5f);
  EXPECT_EQ(posed(PunctualLight{}, pose).position, glm::vec3(0.0f));
}

}  // namespace
}  // namespace weir::scene::test
