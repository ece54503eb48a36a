// What a clip keeps apart when a scene is prepared, what its states say, and what the importer makes of odd files.
#include "scene_support.h"

#include <weir/scene/scene_state.h>

#include <functional>

namespace weir::scene::test {
namespace {

Scene moving() {
  return importGltf(WEIR_SOURCE_DIR "/scenes/cornell-moving.glb");
}

TEST(MovingImport, ReadsClipsSkinAndTargets) {
  const Scene scene = moving();
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.clips.size(), 5u);
  EXPECT_EQ(scene.clips[0].name, "everything");
  EXPECT_EQ(scene.clips[0].channels.size(), 6u);
  EXPECT_EQ(scene.clips[0].duration, 2.0);
  ASSERT_EQ(scene.skins.size(), 1u);
  EXPECT_EQ(scene.skins[0].joints.size(), 2u);
  size_t skinned = 0, morphed = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) {
      skinned += p.influencesPerVertex == 4 && p.influences.size() == 4 * p.positions.size() ? 1 : 0;
      morphed += p.targets.size() == 1 && p.targets[0].positions.size() == p.positions.size() ? 1 : 0;
    }
  }
  EXPECT_EQ(skinned, 1u);
  EXPECT_EQ(morphed, 1u);
}

TEST(MovingPrepare, WithoutAClipEverythingIsMergedAtRest) {
  const PreparedScene p = prepareScene(moving());
  EXPECT_FALSE(p.traits.animated);
  EXPECT_TRUE(p.deformations.empty());
  EXPECT_EQ(p.instances.size(), 1u);
  EXPECT_TRUE(p.movingLights.empty());
}

TEST(MovingPrepare, KeepsApartWhatTheClipMovesAndNothingElse) {
  const Scene scene = moving();
  const struct {
    const char* clip;
    size_t moving, deformations, lights;
  } cases[] = {{"block", 1, 0, 0}, {"column", 1, 1, 0}, {"ball", 1, 1, 0}, {"lamp", 1, 0, 2}, {"everything", 4, 2, 2}};
  const uint64_t triangles = prepareScene(scene).triangles.size();
  for (const auto& c : cases) {
    SCOPED_TRACE(c.clip);
    const PreparedScene p = prepareScene(scene, {}, &chooseClip(scene, c.clip));
    EXPECT_TRUE(p.traits.animated);
    EXPECT_EQ(p.traits.deforms, c.deformations > 0);
    EXPECT_EQ(p.triangles.size(), triangles);
    EXPECT_EQ(p.deformations.size(), c.deformations);
    EXPECT_EQ(p.movingLights.size(), c.lights);
    EXPECT_EQ(p.lights.size(), 2u);
    size_t moves = 0;
    for (const PreparedInstance& instance : p.instances) moves += p.moves(instance) ? 1 : 0;
    EXPECT_EQ(moves, c.moving);
    EXPECT_EQ(p.instances.size(), c.moving + 1);
  }
}

// At rest, the moving arrangement says the same of the lights as the still one.
TEST(SceneState, AtRestIsTheStillScene) {
  const Scene scene = moving();
  const PreparedScene still = prepareScene(scene), p = prepareScene(scene, {}, &scene.clips[0]);
  const SceneState state = StateMaker(scene, p).at(restPose(scene));
  ASSERT_EQ(state.lights.size(), still.lights.size());
  for (size_t i = 0; i < state.lights.size(); ++i) {
    EXPECT_NEAR(state.lights[i].area, still.lights[i].area, 1e-7f);
    EXPECT_NEAR(state.lights[i].pdf, still.lights[i].pdf, 1e-6f);
    EXPECT_EQ(p.lights[i].position, state.lights[i].position);
    EXPECT_LT(glm::cross(state.lights[i].a, state.lights[i].b).y, 0.0f) << "shines down";
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(state.bounds.low[k], still.bounds.low[k] + 1e-5f);
    EXPECT_GE(state.bounds.high[k], still.bounds.high[k] - 1e-5f);
  }
}

// The lamp's scale at its first second is 1.6 × 1.2; both of its triangles keep their indices and grow alike.
TEST(SceneState, LightsMoveGrowAndKeepTheirIndices) {
  const Scene scene = moving();
  const Clip& clip = chooseClip(scene, "lamp");
  const PreparedScene p = prepareScene(scene, {}, &clip);
  const StateMaker states(scene, p);
  const SceneState a = states.at(evaluate(scene, clip, 0.0)), b = states.at(evaluate(scene, clip, 1.0));
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(b.lights[i].area / a.lights[i].area, 1.6 * 1.2, 1e-5);
    EXPECT_EQ(a.lights[i].triangle, b.lights[i].triangle);
    EXPECT_NEAR(b.lights[i].pdf, 0.5f, 1e-6f);
  }
  // Half way between (0.4, 1.8, 0.2) and (-0.4, 1.9, -0.2).
  const glm::vec3 centre = b.lights[0].position + 0.5f * (b.lights[0].a + b.lights[0].b);
  EXPECT_NEAR(centre.y, 1.85f, 1e-5f);
}

TEST(SceneState, BoundsContainWhateverDeforms) {
  const Scene scene = moving();
  const Clip& clip = scene.clips[0];
  const PreparedScene p = prepareScene(scene, {}, &clip);
  const StateMaker states(scene, p);
  for (double t : {0.1, 0.5, 0.9, 1.3, 1.7}) {
    const Pose pose = evaluate(scene, clip, t);
    const SceneState state = states.at(pose);
    Bounds exact;
    float longest = 0.0f;
    for (const Instance& instance : scene.instances) {
      for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
        const std::vector<glm::mat4> joints =
            instance.skin >= 0 ? jointMatrices(scene.skins[instance.skin], pose) : std::vector<glm::mat4>();
        const bool skinned = instance.skin >= 0;
        const Primitive shape = deformed(primitive, pose.weights[instance.node], skinned ? &joints : nullptr);
        const glm::dmat4 world = skinned ? glm::dmat4(1.0) : pose.world[instance.node];
        std::vector<glm::vec3> at;
        for (const glm::vec3& v : shape.positions) at.emplace_back(world * glm::dvec4(glm::dvec3(v), 1.0));
        for (const glm::vec3& v : at) exact.add(v);
        for (size_t i = 0; i + 2 < shape.indices.size(); i += 3)
          for (size_t k = 0; k < 3; ++k)
            longest = std::max(longest, glm::distance(at[shape.indices[i + k]], at[shape.indices[i + (k + 1) % 3]]));
      }
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(state.bounds.low[k], exact.low[k] + 1e-5f);
      EXPECT_GE(state.bounds.high[k], exact.high[k] - 1e-5f);
    }
    EXPECT_GE(state.largestSide, longest * 0.99999f);
    EXPECT_LE(state.bounds.radius(), 1.5f * exact.radius()) << "but not by much";
  }
}

/// A mirroring transform turns a moving emitter's winding; the light still faces the way that the triangle emits.
TEST(SceneState, MirroredLightsFaceTheirFront) {
  Scene scene = moving();
  Clip& clip = scene.clips[4];
  ASSERT_EQ(clip.name, "lamp");
  for (Channel& channel : clip.channels)
    if (channel.path == AnimatedPath::Scale) channel.values = {1, 1, 1, -1, 1, 1, 1, 1, 1};
  const PreparedScene p = prepareScene(scene, {}, &clip);
  const StateMaker states(scene, p);
  const SceneState state = states.at(evaluate(scene, clip, 1.0));
  for (const GpuLight& light : state.lights) {
    EXPECT_LT(glm::cross(light.a, light.b).y, 0.0f);
    EXPECT_NE(light.kind & kLightTurned, 0u);
  }
  // At half a second the lamp has no width: no power, no area, and nothing that isn't a number.
  const SceneState flat = states.at(evaluate(scene, clip, 0.5));
  for (const GpuLight& light : flat.lights) EXPECT_EQ(light.area, 0.0f);
  EXPECT_EQ(flat.aliasTable.size(), 2u);
}

/// A triangle on one joint, with a clip that moves it.
GltfText animated() {
  GltfText g = GltfText::triangle();
  g.accessor<uint16_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5123, "VEC4", 3);            // 2: joints
  g.accessor<float>({2, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0, 0, 0}, 5126, "VEC4", 3);            // 3: weights
  g.accessor<float>({0, 1}, 5126, "SCALAR", 2);                                           // 4: times
  g.accessor<float>({0, 0, 0, 0, 0, 3}, 5126, "VEC3", 2);                                 // 5: translations
  g.accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1}, 5126, "MAT4", 1);  // 6: inverse bind
  g.j["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 2;
  g.j["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = 3;
  // The mesh's own node is far away: a skin takes no notice.
  g.j["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}}, {{"translation", {0, 0, 2}}}};
  g.j["scenes"][0]["nodes"] = {0, 1};
  g.j["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", 6}}};
  g.j["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
                        {"samplers", {{{"input", 4}, {"output", 5}}}}}};
  return g;
}

TEST(SkinImport, RestPoseIsTheJointsNotTheNodes) {
  const Scene scene = load(animated().text());
  EXPECT_EQ(scene.clips.at(0).name, "clip 0");
  const PreparedScene p = prepareScene(scene);
  EXPECT_EQ(p.bounds.low, glm::vec3(0, 0, 1));
  EXPECT_EQ(p.bounds.high, glm::vec3(1, 1, 1));
  EXPECT_EQ(worldBounds(scene).high, glm::vec3(1, 1, 1));
  const PreparedScene q = prepareScene(scene, {}, &scene.clips[0]);
  const SceneState state = StateMaker(scene, q).at(evaluate(scene, scene.clips[0], 1.0));
  EXPECT_EQ(state.bounds.high, glm::vec3(1, 1, 2));
  // Shares are made to sum up to 1.
  for (const Influence& i : scene.meshes[0].primitives[0].influences) EXPECT_TRUE(i.weight == 1.0f || i.weight == 0.0f);
}

TEST(SkinImport, DefaultWeightsOfMeshAndNode) {
  GltfText g = GltfText::triangle();
  const int target = g.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
  g.j["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  g.j["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(prepareScene(load(g.text())).bounds.low.z, 0.5f);
  g.j["nodes"][0]["weights"] = {2.0};
  EXPECT_EQ(prepareScene(load(g.text())).bounds.low.z, 2.0f);
}

TEST(AnimationGuards, OddFilesAreRefusedWithTheirPlace) {
  const auto said = [](const std::function<void(json&)>& spoil) {
    GltfText g = animated();
    spoil(g.j);
    return refusal(g.text());
  };
  EXPECT_NE(said([](json& j) { j["skins"][0]["joints"] = {7}; }).find("/skins/0/joints/0"), std::string::npos);
  EXPECT_NE(said([](json& j) { j["skins"][0]["inverseBindMatrices"] = 0; }).find("4x4"), std::string::npos);
  EXPECT_NE(said([](json& j) { j["animations"][0]["channels"][0]["sampler"] = 3; }).find("no sampler 3"),
            std::string::npos);
  EXPECT_NE(said([](json& j) { j["animations"][0]["samplers"][0]["output"] = 4; }).find("/animations/0/channels/0"),
            std::string::npos);
  EXPECT_NE(said([](json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "WAVY"; }).find("WAVY"),
            std::string::npos);
  EXPECT_NE(said([](json& j) { j["animations"][0]["channels"][0]["target"]["node"] = 9; }).find("target/node"),
            std::string::npos);
  EXPECT_NE(said([](json& j) { j["accessors"][6]["type"] = "MAT3"; }).find("matrix"), std::string::npos);
  EXPECT_NE(said([](json& j) { j["accessors"][3]["count"] = 2; }).find("WEIGHTS_0"), std::string::npos);

  GltfText backwards = animated();
  const int times = backwards.accessor<float>({1, 1}, 5126, "SCALAR", 2);
  backwards.j["animations"][0]["samplers"][0]["input"] = times;
  EXPECT_NE(refusal(backwards.text()).find("do not rise"), std::string::npos);
  GltfText lost = animated();
  lost.j["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] =
      lost.accessor<uint16_t>({3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5123, "VEC4", 3);
  EXPECT_NE(refusal(lost.text()).find("joint 3"), std::string::npos);
}

TEST(AnimationGuards, PathsOfExtensionsAreIgnoredWithAWarning) {
  GltfText g = animated();
  g.j["animations"][0]["channels"][0]["target"]["path"] = "pointer";
  const Scene scene = load(g.text());
  EXPECT_TRUE(scene.clips.at(0).channels.empty());
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(AnimationScenes, OfOthersHaveTheirClips) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP();
  const struct {
    const char* file;
    std::vector<std::string> clips;
    size_t deformations;
  } cases[] = {{"box-animated/box-animated.glb", {"clip 0"}, 0},
               {"cesium-man/cesium-man.glb", {"clip 0"}, 1},
               {"rigged-simple/rigged-simple.glb", {"clip 0"}, 1},
               {"fox/fox.glb", {"Survey", "Walk", "Run"}, 1},
               {"simple-morph/SimpleMorph.gltf", {"clip 0"}, 1},
               {"animated-morph-sphere/AnimatedMorphSphere.gltf", {"Globe"}, 1}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.file);
    const Scene scene = importGltf(folder + "/" + c.file);
    ASSERT_EQ(scene.clips.size(), c.clips.size());
    for (size_t i = 0; i < c.clips.size(); ++i) EXPECT_EQ(scene.clips[i].name, c.clips[i]);
    const PreparedScene p = prepareScene(scene, {}, &scene.clips[0]);
    EXPECT_TRUE(p.traits.animated);
    EXPECT_EQ(p.deformations.size(), c.deformations);
    for (int i = 0; i <= 4; ++i)
      StateMaker(scene, p).at(evaluate(scene, scene.clips[0], scene.clips[0].duration * i / 4));
  }
}

}  // namespace
}  // namespace weir::scene::test
