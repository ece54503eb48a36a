// Host and shader mean the same bytes: strides by reflection, fields by a shader that writes every one of them out.
#include <weir/shader/compiler.h>

#include <bit>

#include "../../passes/common/layouts.h"
#include "execute/graph_run.h"

namespace weir::test {
namespace {

class Dump final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.output("words", fixedBuffer<Word>(256));
    d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights);
    d.needs(Need::FrameCamera).needs(Need::FrameIndex).needsPrevious(Need::FrameCamera);
    // Text has no place on the GPU, and specialised ones none in the block: those after them must not shift.
    d.param("number", 1.5f);
    d.param("fixedNumber", 2.5f).specialises();
    d.param("words", "nothing");
    d.param("whole", -7);
    d.param("fixedWhole", -9).specialises();
    d.param("yes", false);
    d.param("fixedYes", false).specialises();
    d.param("choice", "red").oneOf({"red", "green", "blue"});
    d.param("fixedChoice", "red").oneOf({"red", "green", "blue"}).specialises();
    d.param("last", 0.0f);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("dump.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_, 1, 1, 0); }

 private:
  Kernel kernel_;
};

/// Two materials with all slots in use, two kinds of lights, single- and double-sided geometry: two instances.
scene::Scene varied() {
  Builder b;
  for (int i = 0; i < 2; ++i) {
    scene::Material m;
    const float f = static_cast<float>(i) + 1;
    m.baseColor = {0.1f * f, 0.2f, 0.3f, 0.4f};
    m.metallic = 0.15f * f;
    m.roughness = 0.25f * f;
    m.normalScale = 0.35f * f;
    m.alphaCutoff = 0.35f;  // below alpha: where nothing is, nothing shines
    m.alphaMode = i == 0 ? scene::AlphaMode::Opaque : scene::AlphaMode::Mask;
    m.emission = {f, 2 * f, 3 * f};
    m.doubleSided = i == 1;
    const auto white = [](uint32_t, uint32_t) { return glm::u8vec4(255); };
    for (scene::TextureSlot* slot :
         {&m.emissiveTexture, &m.baseColorTexture, &m.normalTexture, &m.metallicRoughnessTexture}) {
      slot->texture = b.texture(2, 2, white);
    }
    b.add(quad({0, f, 0}, {1, f, 0.5f}, {1, f + 1, 1}, {0.2f, f + 1, 0}, b.material(m)));
  }
  b.scene.lights.push_back({"", scene::LightKind::Spot, {7, 8, 9}, {1, 2, 3}, {0, -1, 0}, 4.0f});
  return b.scene;
}

TEST(SharedData, EveryFieldArrivesWhereItShould) {
  GraphRun g(R"({"it": {"type": "own.Dump", "params": {"number": 3.25, "whole": -77, "yes": true, "choice": "blue",
                        "fixedNumber": 4.75, "fixedWhole": -99, "fixedYes": true, "fixedChoice": "green", "last": 6.5}}})",
             "it.words", {passEntry<Dump>("Dump")}, {.width = 40, .height = 24, .scene = varied()});
  const scene::Camera first = lookAt({1, 2, 3}, {0, 0, 0}), second = lookAt({1.5f, 2, 3}, {0, 0.5f, 0}, 50);
  g.next = {first, 11, 5, false};
  g.run();
  g.next = {second, 12, 6, false};
  g.run();
  const auto got = g.read("it.words");

  std::vector<uint32_t> expected;
  const auto put = [&](const auto&... values) { (expected.push_back(std::bit_cast<uint32_t>(values)), ...); };
  const auto put3 = [&](const glm::vec3& v) { put(v.x, v.y, v.z); };
  const auto put4 = [&](const glm::vec4& v) { put(v.x, v.y, v.z, v.w); };
  const scene::PreparedScene& p = g.prepared();
  ASSERT_EQ(p.instances.size(), 2u);
  ASSERT_EQ(p.lights.size(), 5u);
  put3(p.positions[1]);
  put(p.vertices[1].normal, p.vertices[1].tangent, p.vertices[1].u, p.vertices[1].v);
  const scene::PackedTriangle& t = p.triangles[1];
  put(t.v[0], t.v[1], t.v[2], t.material);
  for (int c = 0; c < 4; ++c) put4(p.instances[1].toWorld[c]);
  put(2u, 0u, 0u, 2u);  // two opaque triangles come first, both of the second instance's have an alpha test
  const scene::PackedMaterial& m = p.materials[1];
  put4(m.baseColor);
  put3(m.emission);
  put(m.alphaCutoff, m.metallic, m.roughness, m.normalScale, m.flags, m.baseColorTexture, m.metallicRoughnessTexture,
      m.normalTexture, m.emissiveTexture);
  const scene::GpuLight& l = p.lights[1];
  put3(l.position);
  put(l.kind);
  put3(l.a);
  put(l.triangle);
  put3(l.b);
  put(l.area);
  put3(l.radiance);
  put(l.pdf, p.aliasTable[1].threshold, p.aliasTable[1].alias);
  const execute::GpuCamera now = execute::toGpu(second, 40, 24), before = execute::toGpu(first, 40, 24);
  for (const glm::vec4& v : {now.origin, now.forward, now.right, now.up, before.origin, before.up}) put4(v);
  put(40u, 24u, 12u, 6u, 5u, 2u, g.sceneGpu().diameter, g.sceneGpu().diameter * 0x1p-20f, g.sceneGpu().largestSide);
  put(3.25f, -77, 1u, 2u, 4.75f, -99, 1u, 1u, 6.5f);
  ASSERT_LE(expected.size(), got.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(got[i], expected[i]) << "word " << i;
}

TEST(SharedData, TheLongestSideIsTheWorlds) {
  Builder b;
  const int mesh = b.mesh({quad({0, 0, 0}, {3, 0, 0}, {3, 4, 0}, {0, 4, 0})});
  glm::mat4 doubled(2.0f);
  doubled[3] = glm::vec4(0, 0, 9, 1);
  b.place(mesh);
  b.place(mesh, doubled);
  const auto device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  const scene::PreparedScene merged = scene::prepareScene(b.scene), shared = scene::prepareScene(b.scene, {0, 1});
  EXPECT_FLOAT_EQ(scene::SceneGpu(*device, b.scene, merged, false).largestSide, 10.0f);
  // Of an instance a bound, at most √3 too large.
  const float bound = scene::SceneGpu(*device, b.scene, shared, false).largestSide;
  EXPECT_GE(bound, 10.0f);
  EXPECT_LE(bound, 17.4f);
}

// ------------------------------------------------------------------------------------------------ strides

/// Compiles a kernel of one input port with the house's own declarations and returns its blocks.
template <typename T>
uint32_t strideOf() {
  struct Reader final : Pass {
    static void describe(PassDescription& d) {
      d.input("data", perPixel<T>());
      d.output("copy", perPixel<T>());
    }
    void prepare(PrepareContext&) override {}
    void record(RecordContext&) override {}
  };
  Registry registry;
  const WeirPassEntry entries[] = {passEntry<Reader>("Reader")};
  registry.add("own", entries);
  std::vector<graph::Diagnostic> diagnostics;
  const auto description = graph::parse(
      R"({"version": 1, "name": "t", "passes": {"it": {"type": "own.Reader", "inputs": {"data": "it.copy@previous"}}}, "outputs": {"o": "it.copy"}})",
      "t", diagnostics);
  const graph::CompiledGraph compiled = graph::compile(description, registry.catalog(), 8, 8, diagnostics);
  if (!diagnostics.empty()) throw graph::GraphError(diagnostics);
  execute::KernelInterface interface;
  interface.graph = &compiled;
  interface.pass = &compiled.passes.at(0);
  shader::CompileRequest request;
  request.name = "stride";
  request.source = execute::kernelSource(interface, execute::KernelKind::Compute, "body");
  request.virtualFiles["body"] = "void run(uvec2 p) { out_copy[p.x] = in_data[p.y]; }\n";
  for (const shader::BufferBlock& block : shader::reflectBuffers(request)) {
    if (block.set == 1 && block.binding == 0) return block.arrayStride;
  }
  return 0;
}

TEST(SharedData, StridesOfLayouts) {
  EXPECT_EQ(strideOf<passes::PackedSurface>(), sizeof(passes::PackedSurface));
  EXPECT_EQ(strideOf<passes::Reservoir>(), sizeof(passes::Reservoir));
  EXPECT_EQ(strideOf<passes::MeanState>(), sizeof(passes::MeanState));
  EXPECT_LE(sizeof(passes::PackedSurface), 24u);
}

TEST(SharedData, StridesOfTheScene) {
  Registry registry;
  const WeirPassEntry entries[] = {passEntry<Dump>("Dump")};
  registry.add("own", entries);
  std::vector<graph::Diagnostic> diagnostics;
  const auto description = graph::parse(
      R"({"version": 1, "name": "t", "passes": {"it": {"type": "own.Dump"}}, "outputs": {"o": "it.words"}})", "t",
      diagnostics);
  const graph::CompiledGraph compiled = graph::compile(description, registry.catalog(), 8, 8, diagnostics);
  ASSERT_TRUE(diagnostics.empty());
  execute::KernelInterface interface;
  interface.graph = &compiled;
  interface.pass = &compiled.passes.at(0);
  shader::CompileRequest request;
  request.name = "strides";
  request.source = execute::kernelSource(interface, execute::KernelKind::Compute, "dump.glsl");
  request.includeFolders = {sourcePath("tests/execute/shaders"), sourcePath("shaders/common")};
  const std::map<uint32_t, uint32_t> expected = {{scene::kBindPositions, 4},
                                                 {scene::kBindVertices, sizeof(scene::PackedVertex)},
                                                 {scene::kBindTriangles, sizeof(scene::PackedTriangle)},
                                                 {scene::kBindInstances, sizeof(scene::GpuInstance)},
                                                 {scene::kBindMaterials, sizeof(scene::PackedMaterial)},
                                                 {scene::kBindLights, sizeof(scene::GpuLight)},
                                                 {scene::kBindAlias, sizeof(scene::AliasCell)}};
  std::map<uint32_t, uint32_t> found;
  for (const shader::BufferBlock& block : shader::reflectBuffers(request)) {
    if (block.set == 0) found[block.binding] = block.arrayStride;
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace weir::test
