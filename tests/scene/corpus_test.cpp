// Scenes by other people: counts against their manifest, and malformed files in processes of their own.
#include "scene_support.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <set>
#include <sstream>

namespace weir::scene::test {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;  // needs terabytes of address space
#else
constexpr bool kSanitized = false;
#endif

struct Expected {
  const char* path;
  uint64_t triangles;
  uint32_t punctual;
  uint64_t emissive;
  int images;  // -1: not said
};

// MANIFEST.md of the scene folder. Files of a family are listed by its folder.
const Expected kScenes[] = {{"sponza/sponza.glb", 262267, 0, 0, 69},
                            {"scifi-helmet/scifi-helmet.glb", 23358, 0, 0, 1},
                            {"modern-hall/modern-hall.glb", 31087, 0, 176, 3},
                            {"veach-ajar/veach-ajar.glb", 4546, 0, 2, 3},
                            {"animated-morph-sphere/AnimatedMorphSphere.gltf", 960, 0, 0, 0},
                            {"simple-morph/SimpleMorph.gltf", 1, 0, 0, 0},
                            {"metal-rough-spheres/metal-rough-spheres.glb", 100320, 0, 0, 12},
                            {"roughness-spheres/roughness-spheres.glb", 51200, 0, 0, 5},
                            {"boombox-spec-gloss/boombox-spec-gloss.glb", 6036, 0, 6036, 7},
                            {"alpha-blend-mode-test/alpha-blend-mode-test.glb", 61, 0, 0, 9},
                            {"sphere-punctual-lights/sphere-punctual-lights.glb", 224, 4, 0, 2},
                            {"box-animated/box-animated.glb", 254, 0, 0, 0},
                            {"cesium-man/cesium-man.glb", 4672, 0, 0, 1},
                            {"rigged-simple/rigged-simple.glb", 188, 0, 0, 0},
                            {"fox/fox.glb", 576, 0, 0, 1},
                            {"simple-sparse-accessor/SimpleSparseAccessor.gltf", 12, 0, 0, 0},
                            {"texture-settings-test/TextureSettingsTest.gltf", 72, 0, 0, 3},
                            {"texture-coordinate-test/TextureCoordinateTest.gltf", 10, 0, 0, 1},
                            {"normal-tangent-test/NormalTangentTest.gltf", 7774, 0, 0, 3},
                            {"cameras/Cameras.gltf", 2, 0, 0, 0},
                            {"box-interleaved/BoxInterleaved.gltf", 12, 0, 0, 0},
                            {"duck-quantized/Duck.gltf", 4212, 0, 0, 1},
                            {"duck-draco/Duck.gltf", 4212, 0, 0, 1},
                            {"asset-generator/Node_NegativeScale", 54, 0, 0, -1},
                            {"asset-generator/Material_AlphaMask", 2, 0, 0, -1},
                            {"asset-generator/Mesh_PrimitivesUV", 2, 0, 0, -1},
                            {"asset-generator/Mesh_PrimitiveVertexColor", 2, 0, 0, -1},
                            {"asset-generator/Material_SpecularGlossiness", 2, 0, 0, -1},
                            {"asset-generator/Buffer_Interleaved", 2, 0, 0, -1}};

std::vector<fs::path> gltfFiles(const fs::path& place) {
  std::vector<fs::path> files;
  if (fs::is_regular_file(place)) return {place};
  for (const auto& entry : fs::recursive_directory_iterator(place))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The JSON part of a .gltf or .glb.
json jsonOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!bytes.starts_with("glTF")) return json::parse(bytes);
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return json::parse(bytes.substr(20, length));
}

/// What every arranged scene keeps to.
void expectSound(const Scene& scene, const PreparedScene& p) {
  const SceneSummary s = summarize(scene);
  uint64_t instanced = 0;
  for (const auto& instance : p.instances)
    instanced += p.ranges.at(instance.range).opaque + p.ranges[instance.range].masked;
  if (p.ranges.size() == 2) {  // all is merged
    EXPECT_EQ(instanced + p.droppedTriangles, s.instancedTriangles);
  }
  EXPECT_EQ(p.positions.size(), p.vertices.size());
  EXPECT_EQ(p.materials.size(), scene.materials.size() + 1);
  for (const auto& t : p.triangles) {
    ASSERT_LT(t.material, p.materials.size());
    for (uint32_t v : t.v) {
      ASSERT_LT(v, p.positions.size());
      const glm::vec3& x = p.positions[v];
      ASSERT_TRUE(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z));
    }
  }
  EXPECT_EQ(p.lights.size(), p.aliasTable.size());
  for (size_t i = 0; i < p.lights.size(); ++i) {
    EXPECT_EQ((p.lights[i].kind & 0xff) == static_cast<uint32_t>(GpuLightKind::Triangle), i < p.triangleLights);
    EXPECT_GT(p.lights[i].pdf, 0.0f);
  }
  for (const auto& texture : p.textures) ASSERT_FALSE(scene.images.at(texture.image).rgba.empty());
}

TEST(Corpus, CountsMatchTheManifest) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  for (const Expected& expected : kScenes)
    for (const auto& file : gltfFiles(fs::path(folder) / expected.path)) {
      SCOPED_TRACE(file.string());
      const Scene scene = importGltf(file.string());
      const SceneSummary s = summarize(scene);
      EXPECT_EQ(s.storedTriangles, expected.triangles);
      EXPECT_EQ(s.pointLights + s.spotLights + s.directionalLights, expected.punctual);
      EXPECT_EQ(s.emissiveTriangles, expected.emissive);
      if (expected.images >= 0) {
        EXPECT_EQ(s.images, static_cast<uint32_t>(expected.images));
      }
      // What the manifest doesn't say the file does, to a reader that knows nothing of glTF.
      const json j = jsonOf(file);
      const auto size = [&](const char* key) { return j.contains(key) ? j[key].size() : size_t{0}; };
      EXPECT_EQ(s.meshes, size("meshes"));
      EXPECT_EQ(s.materials, size("materials"));
      EXPECT_EQ(s.textures, size("textures"));
      EXPECT_EQ(s.images, size("images"));
      EXPECT_EQ(s.animations, size("animations"));
      expectSound(scene, prepareScene(scene));
    }
}

TEST(Corpus, EveryValidFileLoads) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  int files = 0;
  for (const auto& file : gltfFiles(folder)) {
    if (file.string().find("/malformed/") != std::string::npos) continue;
    SCOPED_TRACE(file.string());
    ++files;
    const Scene scene = importGltf(file.string());
    expectSound(scene, prepareScene(scene));
  }
  EXPECT_GE(files, 95);
}

TEST(Corpus, BoomboxEmitsWhereItsTextureDoes) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const PreparedScene p = prepareScene(importGltf(folder + "/boombox-spec-gloss/boombox-spec-gloss.glb"));
  EXPECT_GT(p.triangleLights, 0u);
  EXPECT_LT(p.triangleLights, 1000u);  // of 6036
}

/// Loads in a child with limited time and memory. Empty when it ended in a scene or an InputError, else what went
/// wrong.
std::string runInChild(const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(kSanitized ? 30 : 5);
    const rlimit memory{1536ull << 20, 1536ull << 20};
    if (!kSanitized) setrlimit(RLIMIT_AS, &memory);
    try {
      prepareScene(importGltf(file.string()));
      _exit(0);
    } catch (const InputError& e) {
      _exit(std::string_view(e.what()).size() > file.string().size() ? 0 : 11);  // says more than the path
    } catch (const std::exception& e) {
      std::cerr << file << ": " << e.what() << "\n";
      _exit(12);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
    return WTERMSIG(status) == SIGALRM ? "took too long" : "died of signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) == 0) return {};
  return "exit status " + std::to_string(WEXITSTATUS(status));
}

TEST(Corpus, MalformedFilesGiveASceneOrAnInputError) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const auto files = gltfFiles(fs::path(folder) / "malformed");
  EXPECT_GT(files.size(), 200u);
  for (const auto& file : files) {
    const std::string problem = runInChild(file);
    EXPECT_EQ(problem, "") << file;
  }
}

// Some of the malformed files have a fault that no reader may overlook.
TEST(Corpus, GraveFaultsAreRefused) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  for (const char* name :
       {"assimp/IndexOutOfRange/AllIndicesOutOfRange.gltf", "assimp/RecursiveNodes/RecursiveNodes.gltf",
        "cesium-native/CesiumGltfContent/test/data/cubeSomeBadIndices.glb", "cgltf/WaterBottle.gltf",
        "gltf-validator/base/data/asset/1_0_version.gltf", "gltf-validator/base/data/glb/truncated_chunk_data.glb",
        "gltf-validator/base/data/node/node_loop_scene.gltf", "gltf-validator/base/data/node/unresolved_mesh.gltf",
        "tinygltf/models/BoundsChecking/integer-out-of-bounds.gltf",
        "tinygltf/models/BoundsChecking/invalid-buffer-view-index.gltf"}) {
    EXPECT_THROW(importGltf(folder + "/malformed/" + name), InputError) << name;
  }
}

}  // namespace
}  // namespace weir::scene::test
