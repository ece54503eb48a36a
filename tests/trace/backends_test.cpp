// The tracing interface's two back ends against each other and against double-precision rays.
#include <gtest/gtest.h>
#include <weir/scene/import.h>

#include <cmath>

#include "trace/probe.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 192;

/// Segments between random points of the scene's bounds, a little grown.
std::vector<Segment> randomSegments(const scene::Bounds& bounds, uint32_t salt) {
  std::vector<Segment> segments;
  uint32_t n = salt * 1000003u;
  const auto point = [&] {
    glm::dvec3 u;
    for (int k = 0; k < 3; ++k) u[k] = 1.1 * uniformOf(n++) - 0.05;
    return glm::dvec3(bounds.low) + u * glm::dvec3(bounds.high - bounds.low);
  };
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const glm::vec3 from(point()), way(glm::vec3(point()) - from);
    segments.push_back({from.x, from.y, from.z, 1.0f, way.x, way.y, way.z, hashOf(i)});
  }
  return segments;
}

struct Answers {
  std::vector<Found> found;
  std::vector<Segment> segments;
};

Answers ask(PassTest& t, const scene::Scene& scene, trace::Backend backend, uint32_t salt,
            const scene::PrepareLimits& limits = {}) {
  withProbes(t).size(kSide, kSide).scene(scene).backend(backend).limits(limits);
  Answers a;
  a.segments = randomSegments(t.prepared().bounds, salt);
  t.input("segments", a.segments);
  t.run();
  a.found = t.output<Found>("found");
  return a;
}

struct World {
  const char* name;
  scene::Scene scene;
  scene::PrepareLimits limits;
};

/// Layers of every alpha mode, two of them textured; with `decorated`, vertex alphas, a second set of texture
/// coordinates and their transform too.
scene::Scene veils(bool decorated = false) {
  Builder b;
  const int soft =
      b.texture(16, 16, [](uint32_t x, uint32_t y) { return glm::u8vec4(255, 255, 255, hashOf(x + 16 * y) & 255); });
  for (uint32_t i = 0; i < 6; ++i) {
    scene::Material m;
    m.baseColor.a = 0.15f + 0.1f * static_cast<float>(i);
    m.alphaMode = i % 3 == 2 ? scene::AlphaMode::Mask : scene::AlphaMode::Blend;
    m.alphaCutoff = 0.3f;
    m.doubleSided = i % 2 == 0;
    if (i % 3 != 0) m.baseColorTexture.texture = soft;
    const float z = 0.2f * static_cast<float>(i);
    scene::Primitive layer = quad({-1, -1, z}, {1, -1, z + 0.1f}, {1, 1, z}, {-1, 1, z - 0.1f});
    if (decorated) {
      layer.colors = {{1, 1, 1, 1}, {1, 1, 1, 0.2f}, {1, 1, 1, 0.6f}, {1, 1, 1, 0}};
      layer.uv1 = {{0.1f, 0.3f}, {1.4f, 0.2f}, {1.1f, -0.9f}, {0.2f, -0.5f}};
      m.baseColorTexture.uvSet = 1;
      m.baseColorTexture.transform = {glm::mat2(0.6f, -0.8f, 0.8f, 0.6f), glm::vec2(0.3f, 0.1f)};
    }
    layer.material = b.material(m);
    b.add(layer);
  }
  b.add(sphere(8, 16), glm::mat4(0.2f, 0, 0, 0, 0, 0.2f, 0, 0, 0, 0, 0.2f, 0, 0.3f, 0.1f, 0.5f, 1));
  return b.scene;
}

std::vector<World> worlds() {
  std::vector<World> list;
  for (const char* name : {"materials.glb", "alpha-mask.glb"}) {
    list.push_back({name, scene::importGltf(sourcePath(std::string("scenes/") + name)), {0, 1}});
  }
  list.push_back({"veils", veils(), {}});
  list.push_back({"decorated veils", veils(true), {}});
  return list;
}

TEST(Trace, BackEndsAgree) {
  uint32_t salt = 0;
  for (const World& w : worlds()) {
    SCOPED_TRACE(w.name);
    PassTest pipeline("trace_test.Probe"), query("trace_test.Probe");
    const Answers a = ask(pipeline, w.scene, trace::Backend::Pipeline, ++salt, w.limits);
    const Answers b = ask(query, w.scene, trace::Backend::Query, salt, w.limits);
    size_t closest = 0, seen = 0, shadows = 0, hits = 0, partial = 0;
    for (size_t i = 0; i < a.found.size(); ++i) {
      const Found &p = a.found[i], &q = b.found[i];
      const bool same = p.triangle == q.triangle &&
                        (p.triangle == ~0u ||
                         (p.instance == q.instance && std::abs(p.u - q.u) < 1e-5f && std::abs(p.v - q.v) < 1e-5f));
      closest += !same;
      seen += p.cameraTriangle != q.cameraTriangle;
      shadows += std::abs(p.transmittance - q.transmittance) > 1e-5f;
      hits += p.triangle != ~0u;
      partial += p.transmittance > 0.0f && p.transmittance < 1.0f;
    }
    const size_t most = a.found.size() / 10000;  // 99.99 %
    EXPECT_LE(closest, most);
    EXPECT_LE(seen, most);
    EXPECT_LE(shadows, most);
    EXPECT_GT(hits, a.found.size() / 20);
    if (std::string(w.name).ends_with("veils")) {
      EXPECT_GT(partial, a.found.size() / 10);
    }
  }
}

// Against the oracle; where a segment grazes an edge of a triangle or of a texel, rounding decides, so that one in 500
// may differ.
TEST(Trace, BothAgreeWithDoublePrecision) {
  for (const auto& [backend, decorated] : {std::pair(trace::Backend::Pipeline, false),
                                           {trace::Backend::Query, false},
                                           {trace::Backend::Pipeline, true},
                                           {trace::Backend::Query, true}}) {
    SCOPED_TRACE(testing::Message() << trace::backendName(backend) << (decorated ? ", decorated" : ""));
    PassTest t("trace_test.Probe");
    const Answers a = ask(t, veils(decorated), backend, 77);
    const RayOracle oracle(t.sourceScene(), t.prepared());
    size_t closest = 0, seen = 0, shadows = 0;
    double worst = 0.0;
    for (size_t i = 0; i < a.found.size(); ++i) {
      const Segment& s = a.segments[i];
      const Found& f = a.found[i];
      const glm::dvec3 o(s.ox, s.oy, s.oz), d(s.dx, s.dy, s.dz);
      const auto all = oracle.crossings(o, d, 1.0);
      // What stops a ray is a coin for BLEND: whatever was found must be there, and everything before it must be able
      // to let go.
      bool explained = f.triangle == ~0u, before = true, explainedSeen = f.cameraTriangle == ~0u, beforeSeen = true;
      for (const OracleHit& hit : all) {
        const double coverage = oracle.coverage(hit);
        const bool counts = hit.front || (oracle.material(hit).flags & scene::kMaterialDoubleSided) != 0;
        if (hit.triangle == f.triangle) explained = before && coverage > 0.0 && hit.instance == f.instance;
        if (hit.triangle == f.cameraTriangle) explainedSeen = beforeSeen && coverage > 0.0 && counts;
        if (coverage >= 1.0) before = false;
        if (coverage >= 1.0 && counts) beforeSeen = false;
      }
      if (f.triangle == ~0u) explained = before;
      if (f.cameraTriangle == ~0u) explainedSeen = beforeSeen;
      closest += !explained;
      seen += !explainedSeen;
      const double off = std::abs(oracle.transmittance(o, d, 1.0) - f.transmittance);
      worst = std::max(worst, off);
      shadows += off > 0.01;  // samplers blend in steps of 1/256
    }
    const size_t most = a.found.size() / 500;
    EXPECT_LE(closest, most);
    EXPECT_LE(seen, most);
    EXPECT_LE(shadows, most) << "worst " << worst;
  }
}

// Products of known coverages, exact but for rounding.
TEST(Trace, TransmittanceMultiplies) {
  const float alphas[] = {0.25f, 0.5f, 0.875f};
  for (const auto backend : {trace::Backend::Pipeline, trace::Backend::Query}) {
    Builder b;
    for (int i = 0; i < 3; ++i) {
      scene::Material m;
      m.alphaMode = scene::AlphaMode::Blend;
      m.baseColor.a = alphas[i];
      const float z = static_cast<float>(i + 1);
      b.add(quad({-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}, b.material(m)));
    }
    PassTest t("trace_test.Probe");
    withProbes(t).size(4, 1).scene(b.scene).backend(backend);
    std::vector<Segment> segments;
    for (const float tMax : {0.5f, 1.5f, 2.5f, 3.5f}) segments.push_back({0.1f, 0.2f, 0, tMax, 0, 0, 1, 7});
    t.input("segments", segments);
    t.run();
    const auto found = t.output<Found>("found");
    double expected = 1.0;
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].transmittance, expected, 1e-6) << trace::backendName(backend) << " up to surface " << i;
      if (i < 3) expected *= 1.0 - alphas[i];
    }
  }
}

TEST(Trace, AnEmptySceneIsFree) {
  for (const auto backend : {trace::Backend::Pipeline, trace::Backend::Query}) {
    PassTest t("trace_test.Probe");
    withProbes(t).size(8, 8).backend(backend);
    t.input("segments", std::vector<Segment>(64, Segment{0, 0, 0, 1e30f, 0, 0, 1, 0}));
    t.run();
    for (const Found& f : t.output<Found>("found")) {
      EXPECT_EQ(f.triangle, ~0u);
      EXPECT_EQ(f.transmittance, 1.0f);
    }
  }
}

}  // namespace
}  // namespace weir::test
