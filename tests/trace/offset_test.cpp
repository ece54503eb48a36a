// No surface shadows itself and no light its own samples, at any scale and distance from the origin, and nothing leaks
// through a wall without thickness. Rays are deterministic; the bound of 1e-5 is the project's, over half a million
// rays or more a case.
#include <gtest/gtest.h>
#include <weir/scene/import.h>

#include "trace/probe.h"

namespace weir::test {
namespace {

struct Rays {
  uint64_t wrong = 0, all = 0;
};

/// Shoots `rays` a pixel from what a camera sees. `traced`: as its ray met it, in full precision; else as it was
/// packed.
Rays leave(const scene::Scene& scene, const scene::Camera& camera, const std::string& mode, uint32_t side, int rays,
           bool traced = false) {
  PassTest eye("gbuffer.RayTraced");
  eye.size(side, side).scene(scene).camera(camera).param("jitter", "true");
  eye.run();
  PassTest t("trace_test.Leave");
  withProbes(t).size(side, side).scene(scene).camera(camera).param("mode", mode).param("rays", std::to_string(rays));
  t.param("traced", traced ? "true" : "false");
  t.input("surface", eye.output<passes::PackedSurface>("surface"));
  t.run();
  Rays sum;
  for (const Count& c : t.output<Count>("count")) {
    sum.wrong += c.wrong;
    sum.all += c.all;
  }
  return sum;
}

void expectFew(const Rays& r, uint64_t least) {
  EXPECT_GE(r.all, least);
  EXPECT_LE(static_cast<double>(r.wrong), 1e-5 * static_cast<double>(r.all)) << r.wrong << " of " << r.all;
}

scene::Camera moved(scene::Camera camera, float scale, const glm::vec3& by = glm::vec3(0)) {
  camera.eye = camera.eye * scale + by;
  return camera;
}

scene::Scene shifted(scene::Scene scene, const glm::vec3& by) {
  for (scene::Instance& i : scene.instances) i.toWorld[3] += glm::vec4(by, 0.0f);
  return scene;
}

/// A faceted ball: convex, with triangles at every angle.
scene::Scene ball() {
  Builder b;
  scene::Primitive p = sphere(24, 48);
  p.normals.clear();
  b.add(p, glm::mat4(0.8f, 0.1f, 0, 0, -0.1f, 0.7f, 0.2f, 0, 0, -0.2f, 0.9f, 0, 0.3f, 0.2f, -0.1f, 1));
  return b.scene;
}

/// Eight faces that stay convex when their corners are rounded: what is blocked here is blocked by nothing but
/// arithmetic.
scene::Scene octahedron() {
  Builder b;
  scene::Primitive p;
  p.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  p.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  b.add(p, glm::mat4(0.8f, 0.1f, 0, 0, -0.1f, 0.7f, 0.2f, 0, 0, -0.2f, 0.9f, 0, 0.3f, 0.2f, -0.1f, 1));
  return b.scene;
}

/// One large tilted plane, seen from close by.
scene::Scene plane(float halfSide) {
  Builder b;
  const glm::vec3 n = glm::normalize(glm::vec3(0.3f, 1.0f, 0.2f));
  const glm::vec3 x = glm::normalize(glm::cross(n, glm::vec3(0, 0, 1))) * halfSide, y = glm::cross(n, x);
  b.add(quad(-x - y, x - y, x + y, -x + y));
  return b.scene;
}

const float kScales[] = {1e-4f, 1e-2f, 1.0f, 1e3f, 1e6f};

TEST(Offset, ConvexSurfacesDoNotShadowThemselves) {
  for (const float scale : kScales) {
    SCOPED_TRACE(scale);
    expectFew(
        leave(scaled(ball(), scale), moved(lookAt({0.4f, 0.9f, 2.6f}, {0.3f, 0.2f, 0}, 50), scale), "sky", 160, 48),
        300'000);
  }
}

TEST(Offset, FarFromTheOrigin) {
  const glm::vec3 far(300, -200, 500);
  expectFew(leave(shifted(octahedron(), far), moved(lookAt({0.4f, 0.9f, 2.6f}, {0.3f, 0.2f, 0}, 50), 1, far), "sky",
                  160, 128),
            300'000);
  // A small thing seen from a long way off: the distance's own rounding moves the point.
  expectFew(leave(octahedron(), lookAt({300, 200, 500}, {0.3f, 0.2f, 0}, 0.2f), "sky", 160, 128), 300'000);
}

// What paths go on from: interpolated on the triangle, wherever that is and however it was brought there. A camera far
// away moves nothing here.
TEST(Offset, VerticesOfPathsDoNotShadowThemselves) {
  const scene::Camera camera = lookAt({0.4f, 0.9f, 2.6f}, {0.3f, 0.2f, 0}, 50);
  for (const float scale : {1e-4f, 1.0f, 1e6f}) {
    SCOPED_TRACE(scale);
    expectFew(leave(scaled(ball(), scale), moved(camera, scale), "sky", 112, 24, true), 70'000);
  }
  const glm::vec3 far(300, -200, 500);
  expectFew(leave(shifted(octahedron(), far), moved(camera, 1, far), "sky", 112, 48, true), 70'000);
  expectFew(leave(octahedron(), lookAt({300, 200, 500}, {0.3f, 0.2f, 0}, 0.2f), "sky", 112, 48, true), 70'000);
  expectFew(leave(plane(30'000.0f), lookAt({0.2f, 1.7f, 0.5f}, {2, 0.5f, 3}, 70), "sky", 112, 24, true), 70'000);
}

TEST(Offset, TrianglesMuchLargerThanTheView) {
  for (const float half : {10.0f, 1000.0f, 30'000.0f}) {
    SCOPED_TRACE(half);
    expectFew(leave(plane(half), lookAt({0.2f, 1.7f, 0.5f}, {2, 0.5f, 3}, 70), "sky", 160, 48), 300'000);
  }
}

TEST(Offset, LightsDoNotShadowTheirSamples) {
  // A floor and a tilted lamp over it; nothing stands between them.
  Builder b;
  scene::Material lamp;
  lamp.emission = glm::vec3(1);
  b.add(quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}));
  b.add(quad({-1, 2, -1}, {1, 2.3f, -1}, {1.2f, 1.7f, 1}, {-1, 1.4f, 1}, b.material(lamp)));
  b.scene.lights.push_back({"point", scene::LightKind::Point, glm::vec3(1), {0.5f, 1.0f, 0.2f}});
  b.scene.lights.push_back(
      {"sun", scene::LightKind::Directional, glm::vec3(1), {}, glm::normalize(glm::vec3(1, -0.4f, 0))});
  for (const float scale : kScales) {
    SCOPED_TRACE(scale);
    // The sun comes in under the lamp's edge only where it does: look at the side that it reaches.
    expectFew(leave(scaled(b.scene, scale), moved(lookAt({-2.6f, 0.5f, 0}, {-3, 0, 0}, 50), scale), "lights", 128, 64),
              300'000);
  }
}

// The error of a ray's far end grows with its length: from lights very far away it would be more than this gap.
TEST(Offset, FarLightsDoNotReachIntoNarrowGaps) {
  // A floor and a lid close over it, seen from between them.
  Builder b;
  b.add(quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}));
  b.add(quad({-3, 0.01f, -3}, {3, 0.01f, -3}, {3, 0.01f, 3}, {-3, 0.01f, 3}));
  const scene::Camera camera = lookAt({0, 0.005f, 0}, {0.01f, 0, 0}, 60);
  for (const float away : {10.0f, 1e3f, 1e5f, 1e7f}) {
    SCOPED_TRACE(away);
    scene::Scene scene = b.scene;
    scene.lights.push_back({"point", scene::LightKind::Point, glm::vec3(1), away * glm::vec3(0.3f, 0.9f, -0.2f)});
    const Rays rays = leave(scene, camera, "lights", 64, 16);
    EXPECT_GE(rays.all, 20'000);
    EXPECT_EQ(rays.wrong, rays.all) << "all of them should be hidden";
  }
}

TEST(Offset, WallsWithoutThicknessDoNotLeak) {
  // A closed room of single quads, seen from within; targets lie outside.
  Builder b;
  const glm::vec3 l(-1, -0.7f, -1.3f), h(0.9f, 1.1f, 1.2f);
  b.add(quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {l.x, l.y, l.z}));
  b.add(quad({l.x, h.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}));
  b.add(quad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}));
  b.add(quad({h.x, l.y, h.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {h.x, h.y, h.z}));
  b.add(quad({l.x, l.y, h.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {l.x, h.y, h.z}));
  b.add(quad({h.x, l.y, l.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}));
  const glm::mat4 turn(0.8f, 0.36f, 0.48f, 0, -0.6f, 0.48f, 0.64f, 0, 0, -0.8f, 0.6f, 0, 0, 0, 0, 1);
  for (scene::Instance& i : b.scene.instances) i.toWorld = turn;
  for (const float scale : kScales) {
    SCOPED_TRACE(scale);
    expectFew(leave(scaled(b.scene, scale), moved(lookAt({0, 0.1f, 0}, {1, -0.6f, 0.7f}, 100), scale), "leak", 160, 32),
              800'000);
  }
}

}  // namespace
}  // namespace weir::test
