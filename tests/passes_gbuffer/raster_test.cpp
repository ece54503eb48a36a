// gbuffer.Raster against gbuffer.RayTraced: the same surfaces everywhere but at silhouettes, where a ray and a
// rasteriser may round to different sides. Raster runs on a device whose ray tracing is hidden: it must not need any.
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

struct View {
  scene::Scene scene;
  scene::Camera camera;
  uint32_t width = 96, height = 72;
  bool jitter = false;
  scene::PrepareLimits limits;
};

GFrame run(const std::string& type, const View& v) {
  PassTest t(type);
  t.size(v.width, v.height).scene(v.scene).camera(v.camera).limits(v.limits).frame(11).seed(5);
  if (v.jitter) t.param("jitter", "true");
  if (type == "gbuffer.Raster") t.withoutRayTracing();
  t.run();
  return readFrame(t, v.width, v.height);
}

/// Whether two surfaces could be neighbours on one smooth face.
bool continuous(const GPixel& a, const GPixel& b) {
  if ((a.distance > 0) != (b.distance > 0)) return false;
  if (a.distance == 0) return true;
  return std::abs(a.distance - b.distance) < 0.05 * a.distance &&
         glm::dot(a.geometricNormal, b.geometricNormal) > 0.95 && std::abs(a.roughness - b.roughness) < 0.2 &&
         glm::length(a.diffuseRoot - b.diffuseRoot) < 0.5;
}

bool silhouette(const GFrame& f, uint32_t x, uint32_t y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const uint32_t nx = x + static_cast<uint32_t>(dx), ny = y + static_cast<uint32_t>(dy);
      if (nx < f.width && ny < f.height && !continuous(f.at(x, y), f.at(nx, ny))) return true;
    }
  }
  return false;
}

/// `detail`: how many times coarser what textures say is compared.
std::string difference(const GPixel& a, const GPixel& b, double detail) {
  if ((a.distance > 0) != (b.distance > 0)) return "hit and miss";
  if (std::abs(a.distance - b.distance) > 1e-4 * a.distance) return "distance";
  // Two triangles of one smooth mesh may share the pixel's centre: geometric normals are compared loosely.
  if (glm::dot(a.geometricNormal, b.geometricNormal) < 0.97) return "geometric normal";
  if (glm::length(a.normal - b.normal) > 3e-3 * detail) return "shading normal";
  if (glm::length(a.diffuseRoot - b.diffuseRoot) > 4e-3 * detail) return "diffuse";
  if (glm::length(a.f0Root - b.f0Root) > 4e-3 * detail) return "f0";
  if (std::abs(a.roughness - b.roughness) > 2e-3 * detail) return "roughness";
  if (glm::length(a.emission - b.emission) > 2e-3 * detail * glm::length(a.emission)) return "emission";
  if (a.jitter != b.jitter) return "jitter";
  if (glm::length(a.motion - b.motion) > 0.02) return "motion";
  return "";
}

/// What a picture's pixels sum up to, for means.
struct Sum {
  glm::dvec3 diffuse{0}, f0{0}, emission{0};
  double roughness = 0;
  void add(const GPixel& p) {
    diffuse += p.diffuseRoot * p.diffuseRoot;
    f0 += p.f0Root * p.f0Root;
    emission += glm::dvec3(p.emission);
    roughness += p.roughness;
  }
};

/// To 0.1 % of the mean outside of silhouettes.
void expectSameMean(const Sum& a, const Sum& b) {
  constexpr double kMost = 1e-3;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(a.diffuse[c], b.diffuse[c], kMost * a.diffuse[c]) << "mean diffuse";
    EXPECT_NEAR(a.f0[c], b.f0[c], kMost * a.f0[c]) << "mean f0";
    EXPECT_NEAR(a.emission[c], b.emission[c], kMost * a.emission[c]) << "mean emission";
  }
  EXPECT_NEAR(a.roughness, b.roughness, kMost * a.roughness) << "mean roughness";
}

/// Where textures have levels, rounding of the level and of coordinates decides between texels: materials and the
/// normals of normal maps are compared in the mean only; mipmap_test.cpp has levels pixel by pixel.
void expectSame(const View& v, double mostSilhouettes) {
  const bool levels = scene::prepareScene(v.scene).traits.mipmaps;
  const double detail = levels ? 1e9 : 1;
  const GFrame traced = run("gbuffer.RayTraced", v), drawn = run("gbuffer.Raster", v);
  size_t edge = 0, inside = 0, wrong = 0, onEdge = 0;
  Sum sums[2];
  for (uint32_t y = 0; y < v.height; ++y) {
    for (uint32_t x = 0; x < v.width; ++x) {
      const std::string said = difference(traced.at(x, y), drawn.at(x, y), detail);
      if (silhouette(traced, x, y)) {
        ++edge;
        onEdge += !said.empty();
        continue;
      }
      ++inside;
      sums[0].add(traced.at(x, y));
      sums[1].add(drawn.at(x, y));
      if (!said.empty() && ++wrong <= 5) ADD_FAILURE() << "pixel " << x << ", " << y << ": " << said;
    }
  }
  EXPECT_EQ(wrong, 0u) << "of " << inside << " pixels";
  if (inside > 100) expectSameMean(sums[0], sums[1]);
  EXPECT_LT(static_cast<double>(edge), mostSilhouettes * v.width * v.height);
  EXPECT_LT(static_cast<double>(onEdge), 0.05 * static_cast<double>(edge) + 2)
      << "silhouette pixels that differ, of " << edge;
}

TEST(Raster, OwnScenes) {
  for (const char* name : {"cornell.glb", "cornell-1000-points.glb", "materials.glb", "alpha-mask.glb"}) {
    for (const bool jitter : {false, true}) {
      SCOPED_TRACE(testing::Message() << name << (jitter ? ", jittered" : ""));
      const scene::Scene scene = own(name);
      expectSame({scene, scene.cameras.at(0), 96, 72, jitter, {}}, 0.5);
    }
  }
}

TEST(Raster, InstancesAndSizesThatFitNoGroup) {
  for (const char* name : {"materials.glb", "alpha-mask.glb"}) {
    SCOPED_TRACE(name);
    const scene::Scene scene = own(name);
    expectSame({scene, scene.cameras.at(0), 77, 45, true, {0, 1}}, 0.6);
  }
}

TEST(Raster, FromWithinAndAtOnePixel) {
  const scene::Scene scene = own("cornell.glb");
  // Geometry behind the camera and across its plane.
  expectSame({scene, lookAt({-0.5f, 1.6f, 0.7f}, {0.4f, 0.2f, -0.5f}, 100), 61, 67, false, {}}, 0.6);
  expectSame({scene, lookAt({0.0f, 1.6f, 0.9f}, {0.8f, 1.5f, 0}, 40), 1, 1, false, {}}, 1.1);
}

TEST(Raster, Sponza) {
  const char* given = std::getenv("WEIR_SCENES");
  const std::string folder = given != nullptr ? given : WEIR_SOURCE_DIR "/../shared/scenes";
  const std::string file = folder + "/sponza/sponza.glb";
  if (!std::filesystem::exists(file)) {
    std::cerr << "\n*** NO SCENE " << file
              << ": RASTER AGAINST TRACED ON SPONZA IS NOT TESTED. SET WEIR_SCENES. ***\n\n";
    GTEST_SKIP() << "no " << file;
  }
  expectSame({scene::importGltf(file), lookAt({-8, 4, -0.5f}, {0, 3.5f, -0.2f}, 70), 160, 90, true, {}}, 0.7);
}

}  // namespace
}  // namespace weir::test
