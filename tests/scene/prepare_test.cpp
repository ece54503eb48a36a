// The arranged scene: nothing lost, the right way round, lights where their triangles are.
#include "scene_support.h"

#include <weir/scene/emission_map.h>
#include <weir/scene/geometry_range.h>
#include <weir/scene/packing.h>
#include <weir/scene/spatial_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <random>

namespace weir::scene::test {
namespace {

using Corners = std::array<glm::vec3, 3>;

/// Turned so that the smallest corner comes first: order of triangles and of starting corners does not matter, winding
/// does.
Corners canonical(Corners c) {
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::rotate(c.begin(), std::min_element(c.begin(), c.end(), less), c.end());
  return c;
}

std::vector<std::array<float, 9>> sortedTriangles(std::vector<Corners> corners) {
  std::vector<std::array<float, 9>> out;
  for (const Corners& given : corners) {
    const Corners c = canonical(given);
    out.push_back({c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z});
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// World-space triangles as a tracer meets them, front faces counter-clockwise.
std::vector<Corners> worldTriangles(const PreparedScene& p) {
  std::vector<Corners> out;
  for (const auto& instance : p.instances) {
    const TriangleRange& range = p.ranges[instance.range];
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      Corners c;
      for (int k = 0; k < 3; ++k)
        c[k] = glm::vec3(glm::dmat4(instance.toWorld) * glm::dvec4(glm::dvec3(p.positions[p.triangles[t].v[k]]), 1.0));
      if (instance.flipsWinding) std::swap(c[1], c[2]);
      out.push_back(c);
    }
  }
  return out;
}

/// Random triangles; normals are the faces', so that any wrong winding shows against them.
Scene randomScene(int triangles, int instances, bool mirrored) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> u(-1.0f, 1.0f);
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].alphaMode = AlphaMode::Mask;
  Mesh mesh;
  for (int m = 0; m < 2; ++m) {
    Primitive p;
    p.material = m;
    for (int t = 0; t < triangles; ++t) {
      const glm::vec3 centre(u(random), u(random), u(random));
      Corners c;
      for (auto& v : c) v = centre + 0.1f * glm::vec3(u(random), u(random), u(random));
      const glm::vec3 n = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
      for (const auto& v : c) {
        p.indices.push_back(static_cast<uint32_t>(p.positions.size()));
        p.positions.push_back(v);
        p.normals.push_back(n);
      }
    }
    mesh.primitives.push_back(p);
  }
  scene.meshes.push_back(mesh);
  for (int i = 0; i < instances; ++i) {
    glm::mat4 m(1.0f);
    m[0] = {u(random), u(random), u(random), 0};
    m[1] = {u(random), u(random), u(random), 0};
    m[2] = {u(random), u(random), u(random), 0};
    if ((glm::determinant(glm::mat3(m)) < 0) != (mirrored && i % 2)) m[2] = -m[2];
    m[3] = {3.0f * static_cast<float>(i), 0, 0, 1};
    scene.instances.push_back({0, i, m});
  }
  return scene;
}

TEST(Prepare, RangesAreAPermutationWithOpaqueFirst) {
  const Scene scene = randomScene(500, 1, false);
  const PreparedScene p = prepareScene(scene);
  ASSERT_EQ(p.ranges.size(), 2u);
  EXPECT_EQ(p.ranges[0].opaque, 500u);
  EXPECT_EQ(p.ranges[0].masked, 500u);
  EXPECT_EQ(p.ranges[1].opaque + p.ranges[1].masked, 0u);
  for (uint32_t t = 0; t < 1000; ++t) EXPECT_EQ(p.triangles[t].material, t < 500 ? 0u : 1u);
  std::vector<Corners> expected;
  for (const Primitive& primitive : scene.meshes[0].primitives)
    for (size_t t = 0; t < primitive.indices.size(); t += 3) {
      Corners c;
      for (int k = 0; k < 3; ++k)
        c[k] = glm::vec3(glm::dmat4(scene.instances[0].toWorld) *
                         glm::dvec4(glm::dvec3(primitive.positions[primitive.indices[t + k]]), 1.0));
      expected.push_back(c);
    }
  EXPECT_EQ(sortedTriangles(worldTriangles(p)), sortedTriangles(expected));
  // Vertices are numbered in order of first use.
  uint32_t next = 0;
  for (const auto& t : p.triangles)
    for (uint32_t v : t.v) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
  EXPECT_EQ(next, p.positions.size());
}

TEST(Prepare, MergedAndInstancedAreTheSameTriangles) {
  const Scene scene = randomScene(200, 6, true);
  const PreparedScene merged = prepareScene(scene), shared = prepareScene(scene, {100, 4});
  ASSERT_EQ(merged.ranges.size(), 2u);
  ASSERT_EQ(shared.ranges.size(), 4u);
  for (size_t side : {0, 1}) EXPECT_EQ(shared.ranges[side].opaque + shared.ranges[side].masked, 0u);
  EXPECT_EQ(shared.triangles.size(), 400u);
  ASSERT_EQ(shared.instances.size(), 6u);
  EXPECT_EQ(
      std::count_if(shared.instances.begin(), shared.instances.end(), [](const auto& i) { return i.flipsWinding; }), 3);
  EXPECT_EQ(sortedTriangles(worldTriangles(merged)), sortedTriangles(worldTriangles(shared)));
  EXPECT_EQ(merged.bounds.low, shared.bounds.low);
  EXPECT_EQ(merged.bounds.high, shared.bounds.high);
}

TEST(Prepare, NormalsFaceLikeTheirTriangleUnderAnyTransform) {
  const PreparedScene p = prepareScene(randomScene(300, 3, true));
  for (const auto& t : p.triangles) {
    const glm::vec3 face = glm::normalize(
        glm::cross(p.positions[t.v[1]] - p.positions[t.v[0]], p.positions[t.v[2]] - p.positions[t.v[0]]));
    for (uint32_t v : t.v) EXPECT_GT(glm::dot(face, unpackNormal(p.vertices[v].normal)), 0.99f);
  }
}

// Double-sided materials have a range of their own; their triangles are lights like any other.
TEST(Prepare, DoubleSidedEmittersAreLights) {
  Scene scene = randomScene(200, 1, false);
  for (Material& m : scene.materials) m.emission = glm::vec3(1.0f);
  scene.materials[0].doubleSided = true;
  const PreparedScene p = prepareScene(scene);
  EXPECT_EQ(p.ranges[0].masked, 200u);
  EXPECT_EQ(p.ranges[1].opaque, 200u);
  ASSERT_EQ(p.triangleLights, 400u);
  for (const GpuLight& light : p.lights) {
    const bool doubleSided = p.triangles[light.triangle].material == 0;
    EXPECT_EQ((light.kind & kLightDoubleSided) != 0, doubleSided);
  }
}

TEST(Prepare, EmissiveMeshesAreNeverInstanced) {
  Scene scene = randomScene(200, 6, true);
  scene.materials[1].emission = glm::vec3(1.0f);
  const PreparedScene p = prepareScene(scene, {100, 4});
  EXPECT_EQ(p.ranges.size(), 2u);
  ASSERT_EQ(p.triangleLights, 1200u);
  double sum = 0.0;
  const auto table = aliasProbabilities(p.aliasTable);
  for (size_t i = 0; i < p.lights.size(); ++i) {
    const GpuLight& light = p.lights[i];
    const auto& v = p.triangles[light.triangle].v;
    EXPECT_EQ(p.triangles[light.triangle].material, 1u);
    EXPECT_EQ(light.position, p.positions[v[0]]);
    EXPECT_EQ(light.a, p.positions[v[1]] - p.positions[v[0]]);
    EXPECT_EQ(light.b, p.positions[v[2]] - p.positions[v[0]]);
    EXPECT_NEAR(light.area, 0.5f * glm::length(glm::cross(light.a, light.b)), 1e-6f * light.area + 1e-12f);
    EXPECT_EQ(light.pdf, static_cast<float>(table[i]));
    sum += light.pdf;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(Prepare, PunctualPowers) {
  Scene scene = randomScene(10, 1, false);
  PunctualLight point, spot, sun, dark;
  point.intensity = spot.intensity = sun.intensity = glm::vec3(2.0f);
  spot.kind = LightKind::Spot;
  spot.innerCone = 0.3f;
  spot.outerCone = 0.6f;
  sun.kind = LightKind::Directional;
  scene.lights = {point, dark, spot, sun};
  const PreparedScene p = prepareScene(scene);
  ASSERT_EQ(p.lights.size(), 3u);
  const double pi = 3.14159265358979, r = p.bounds.radius();
  // The spot's by numerical integration of the extension's falloff.
  double cone = 0.0;
  const int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const double c = std::cos(0.6) + (1.0 - std::cos(0.6)) * (i + 0.5) / steps;
    const double t = std::clamp((c - std::cos(0.6)) * p.lights[1].b.x, 0.0, 1.0);
    cone += t * t * (1.0 - std::cos(0.6)) / steps;
  }
  const double powers[3] = {4 * pi, 2 * pi * cone, pi * r * r}, total = powers[0] + powers[1] + powers[2];
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(p.lights[i].pdf, powers[i] / total, 1e-5) << i;
}

TEST(Prepare, FlatNormalsWhereTheFileHasNone) {
  const PreparedScene p = prepareScene(load(GltfText::triangle().text()));
  for (const auto& v : p.vertices) EXPECT_EQ(unpackNormal(v.normal), glm::vec3(0, 0, 1));
}

// Each triangle around the hub has a normal of its own: time must not grow with the square of their number.
TEST(Prepare, AFanOfManyTrianglesWithoutNormals) {
  constexpr uint32_t kTriangles = 300'000;
  Primitive p;
  p.positions.emplace_back(0, 0, 0);
  for (uint32_t i = 0; i <= kTriangles; ++i) {
    const double turn = 6.0 * i / kTriangles;
    p.positions.emplace_back(std::cos(turn), std::sin(turn), std::sin(1000.0 * turn));
    if (i > 0) p.indices.insert(p.indices.end(), {0, i, i + 1});
  }
  Scene scene;
  scene.meshes = {{"fan", {p}}};
  scene.instances = {{0, -1, glm::mat4(1.0f)}};
  const auto start = std::clock();
  const PreparedScene prepared = prepareScene(scene);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10.0);  // the square would take minutes
  EXPECT_EQ(prepared.triangles.size() + prepared.droppedTriangles, kTriangles);
}

TEST(EmissionMap, MeansAndBlackRegions) {
  // 8 x 8, black but for a white 2 x 2 block at texels (2..3, 4..5).
  Image image;
  image.width = image.height = 8;
  image.rgba.assign(8 * 8 * 4, 0);
  for (int y = 4; y < 6; ++y)
    for (int x = 2; x < 4; ++x)
      for (int c = 0; c < 3; ++c) image.rgba[(y * 8 + x) * 4 + c] = 255;
  const auto at = [](float x, float y) { return glm::vec2(x / 8, y / 8); };
  for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
    const EmissionMap map(image, wrap, wrap, glm::vec3(3.0f));
    EXPECT_NEAR(map.mean(at(0, 0), at(8, 0), at(0, 8)), 3.0 * 4 / 64, 1e-6);
    EXPECT_NEAR(map.mean(at(2.5f, 4.5f), at(2.6f, 4.5f), at(2.5f, 4.6f)), 3.0 * 4 / 9, 1e-6);  // texels 1..3 x 3..5
    EXPECT_EQ(map.mean(at(6, 0), at(6.5f, 0), at(6, 1)), 0.0);
    // A period to the right: the same texels, or their mirror image, or the right edge.
    const double moved = map.mean(at(10.5f, 4.5f), at(10.6f, 4.5f), at(10.5f, 4.6f));
    EXPECT_NEAR(moved, wrap == Wrap::Repeat ? 3.0 * 4 / 9 : 0.0, 1e-6);
    const double reflected = map.mean(at(12.5f, 4.5f), at(12.6f, 4.5f), at(12.5f, 4.6f));
    // Repeated, texels 3..5 of the period, of which one column is white.
    EXPECT_NEAR(reflected, 3.0 * (wrap == Wrap::MirroredRepeat ? 4 : wrap == Wrap::Repeat ? 2 : 0) / 9, 1e-6);
    EXPECT_GT(map.mean({-1e30f, -1e30f}, {1e30f, 1e30f}, {0, 0}), 0.0);
    EXPECT_GE(map.mean({1e30f, 1e30f}, {1e30f, 1e30f}, {1e30f, 1e30f}), 0.0);
  }
}

TEST(SpatialSort, IsAPermutationInWhichHalvesAreCompact) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  std::vector<SortItem> items(40000);
  for (uint32_t i = 0; i < items.size(); ++i) {
    const glm::vec3 c(100.0f * u(random), u(random), u(random));
    items[i] = {c - 0.01f, c + 0.01f, i};
  }
  spatialSort(items);
  std::vector<char> seen(items.size(), 0);
  for (const auto& item : items) ++seen[item.index];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<ptrdiff_t>(items.size()));
  // The long axis is split first.
  float left = 0.0f, right = 100.0f;
  for (size_t i = 0; i < items.size(); ++i)
    i < items.size() / 2 ? left = std::max(left, items[i].low.x) : right = std::min(right, items[i].low.x);
  EXPECT_LE(left, right);
  std::vector<SortItem> none;
  spatialSort(none);
}

}  // namespace
}  // namespace weir::scene::test
