// reference.PathTracer: by closed forms, against reference.AllLights, and against itself with light found in other
// ways.
#include "passes_reference/path_picture.h"
#include "support/environment_oracle.h"

namespace weir::test {
namespace {

const scene::Camera kInside = lookAt({0.1f, 0.2f, 0.7f}, {-0.2f, -0.1f, -1}, 90);
const glm::vec3 kAlbedo(0.8f, 0.5f, 0.25f), kEmission(1, 2, 3);
/// No roulette.
const std::string kNever = "1024";

View glowingRoom(const glm::vec3& albedo) {
  Builder b;
  addRoom(b, b.material(lambert(albedo, kEmission)));
  return View{b.scene, kInside}.look();
}

/// Radiance in a closed room whose walls all have that albedo and emit one radiance, in units of that: emission, direct
/// light and n bounces.
double series(double albedo, int bounces) {
  double sum = 0.0, term = 1.0;
  for (int i = 0; i <= bounces + 1; ++i, term *= albedo) sum += term;
  return sum;
}

// With the BSDF's rays alone there is nothing random in a uniform room: every path brings just its series, whatever way
// it takes. Albedo is packed in 10 or 11 bits for the first vertex, 2e-3 of it or less.
TEST(PathTracer, EveryBounceInAClosedRoomIsOneTerm) {
  const View view = glowingRoom(kAlbedo);
  for (const int bounces : {0, 1, 2, 7, 40}) {
    SCOPED_TRACE(bounces);
    const Frames frames = pathFrames(
        view, {{"maxBounces", std::to_string(bounces)}, {"lightSampling", "bsdf"}, {"rouletteStart", kNever}}, 1);
    for (size_t i = 0; i < frames[0].rgba.size(); ++i) {
      if (i % 4 == 3) continue;
      const double expected = double{kEmission[i % 4]} * series(kAlbedo[i % 4], bounces);
      ASSERT_NEAR(frames[0].rgba[i], expected, 2e-3 * expected) << i;
    }
  }
}

/// A picture that is the same everywhere.
image::Picture uniform(uint32_t side, const glm::dvec3& color) {
  image::Picture p;
  p.width = p.height = side;
  for (uint32_t i = 0; i < side * side; ++i)
    p.rgba.insert(p.rgba.end(), {float(color.r), float(color.g), float(color.b), 1.0f});
  return p;
}

/// The same with the albedo that the first vertex has after packing.
image::Picture seriesPicture(const View& view, int bounces) {
  image::Picture p = uniform(view.side, glm::dvec3(0));
  for (size_t i = 0; i < view.surface.size(); ++i) {
    const uint32_t bits = view.surface[i].diffuse;
    const double root[3] = {(bits & 2047u) / 2047.0, ((bits >> 11u) & 2047u) / 2047.0, (bits >> 22u) / 1023.0};
    for (int k = 0; k < 3; ++k)
      p.rgba[4 * i + k] =
          static_cast<float>(kEmission[k] * (1.0 + root[k] * root[k] * (series(kAlbedo[k], bounces - 1))));
  }
  return p;
}

// Every way to find light, with and without roulette from the first bounce on.
TEST(PathTracer, RouletteAndLightSamplingKeepTheMean) {
  const View view = glowingRoom(kAlbedo);
  for (const char* sampling : {"mis", "lights", "bsdf"}) {
    for (const std::string& start : {std::string("0"), kNever}) {
      if (sampling == std::string("bsdf") && start == kNever) continue;  // nothing is random: see above
      SCOPED_TRACE(testing::Message() << sampling << ", roulette from " << start);
      const Frames frames = pathFrames(
          view, {{"maxBounces", "5"}, {"samples", "2"}, {"lightSampling", sampling}, {"rouletteStart", start}}, 24);
      expectSameMean(frames, seriesPicture(view, 5), nullptr, 0.06);
    }
  }
}

TEST(PathTracer, ManyBouncesReachTheLimit) {
  const View view = glowingRoom(glm::vec3(0.9f));
  const Frames frames = pathFrames(view, {{"maxBounces", "512"}, {"rouletteStart", "2"}, {"samples", "2"}}, 24);
  image::Picture expected = uniform(view.side, glm::dvec3(kEmission) * 10.0);
  // The first vertex's albedo is within a step of 1/1023 of its root.
  image::Picture slack = uniform(view.side, glm::dvec3(kEmission) * 9.0 * (1.0 / 1023.0));
  expectSameMean(frames, expected, &slack, 0.1);
}

/// A faceted ball of a material within a shell of another, seen from between them.
View ballInRoom(const scene::Material& ball, const scene::Material& room) {
  Builder b;
  addRoom(b, b.material(room), 3.0f);
  b.add(sphere(24, 48, b.material(ball)), placed({0.1f, -0.2f, 0.05f}, 0.8f));
  return View{b.scene, lookAt({0.3f, 0.4f, 2.2f}, {0.1f, -0.2f, 0.05f}, 32)}.look();
}

// A convex diffuse thing within an emitter: albedo times radiance, at any bounce: the emitter reflects nothing.
TEST(PathTracer, DiffuseBallWithinAnEmitter) {
  const View view = ballInRoom(lambert(kAlbedo), lambert(glm::vec3(0), kEmission));
  image::Picture expected = uniform(view.side, glm::dvec3(0));
  size_t ball = 0;
  for (size_t i = 0; i < view.surface.size(); ++i) {
    const bool emits = view.emission[i].x > 0.0f;
    ball += emits ? 0 : 1;
    for (int k = 0; k < 3; ++k) expected.rgba[4 * i + k] = kEmission[k] * (emits ? 1.0f : kAlbedo[k]);
  }
  EXPECT_GT(ball, 120u);
  for (const char* sampling : {"mis", "lights", "bsdf"}) {
    SCOPED_TRACE(sampling);
    const Frames frames = pathFrames(view, {{"maxBounces", "2"}, {"lightSampling", sampling}}, 32);
    const image::Picture mean = collect(frames).mean(), error = collect(frames).standardError();
    double sum = 0.0, expectedSum = 0.0, variance = 0.0;
    for (size_t i = 0; i < mean.rgba.size(); ++i) {
      if (i % 4 == 3) continue;
      sum += mean.rgba[i];
      expectedSum += expected.rgba[i];
      variance += error.rgba[i] * error.rgba[i];
      // Smooth normals on flat faces keep a sliver of directions from the ball, at grazing angles.
      if (sampling == std::string("bsdf")) {
        EXPECT_NEAR(mean.rgba[i], expected.rgba[i], 0.06 * expected.rgba[i]) << i;
      }
    }
    // Five standard errors (1 in 10⁶), and a per cent for the sliver and for packing.
    EXPECT_NEAR(sum, expectedSum, 5 * std::sqrt(variance) + 0.01 * expectedSum);
  }
}

// A shell with alpha 0.3 between ball and sky: a ray of a path meets it or not, a light sample finds it with what of it
// is there, and one of the sky with what it lets through: 0.3 E + 0.7 L, from everywhere.
TEST(PathTracer, BallWithinATranslucentEmitterUnderTheSky) {
  scene::Material veil = lambert(glm::vec3(0), kEmission);
  veil.alphaMode = scene::AlphaMode::Blend;
  veil.baseColor.a = 0.3f;
  View view = ballInRoom(lambert(kAlbedo), veil);
  view.scene.environment = environmentOf(8, 4, [](uint32_t, uint32_t) { return glm::vec3(5, 1, 2); });
  view.look();
  const glm::dvec3 arriving = 0.3 * glm::dvec3(kEmission) + 0.7 * glm::dvec3(5, 1, 2);
  for (const char* sampling : {"mis", "lights", "bsdf"}) {
    SCOPED_TRACE(sampling);
    const Frames frames = pathFrames(view, {{"maxBounces", "1"}, {"samples", "4"}, {"lightSampling", sampling}}, 32);
    const image::Picture mean = collect(frames).mean(), error = collect(frames).standardError();
    glm::dvec3 sum(0), variance(0);
    double n = 0;
    for (size_t i = 0; i < view.surface.size(); ++i) {
      // The ball is what neither emits nor is sky nor veil: it alone is brighter than black.
      if (view.surface[i].distance == 0 || view.emission[i].x > 0 || view.surface[i].diffuse == 0) continue;
      ++n;
      for (int k = 0; k < 3; ++k) {
        sum[k] += mean.rgba[4 * i + k];
        variance[k] += double{error.rgba[4 * i + k]} * error.rgba[4 * i + k];
      }
    }
    EXPECT_GT(n, 70);
    for (int k = 0; k < 3; ++k) {
      const double expected = double{kAlbedo[k]} * arriving[k];
      EXPECT_LT(std::sqrt(variance[k]) / n, 0.01 * expected);
      EXPECT_NEAR(sum[k] / n, expected, 5 * std::sqrt(variance[k]) / n + 0.01 * expected) << k;
    }
  }
}

// Mirrors, as smooth as any is told from one: what they show is what is there. Nothing at all is lost between lobe,
// density and cosine. (Where light samples join in, GGX's tails are left to them, which find their way there once in a
// while.)
TEST(PathTracer, MirrorsShowWhatIsThere) {
  const View view = ballInRoom(metal(glm::vec3(1), 0.0f), lambert(glm::vec3(0), kEmission));
  for (const char* sampling : {"mis", "bsdf"}) {
    SCOPED_TRACE(sampling);
    const image::RestartAccumulator all =
        collect(pathFrames(view, {{"maxBounces", "1"}, {"lightSampling", sampling}}, 16));
    const image::Picture mean = all.mean(), error = all.standardError();
    size_t ball = 0, off = 0;
    double sum = 0.0, variance = 0.0;
    for (size_t i = 0; i < view.surface.size(); ++i) {
      if (view.emission[i].x > 0) continue;
      ++ball;
      sum += mean.rgba[4 * i];
      variance += double{error.rgba[4 * i]} * error.rgba[4 * i];
      for (int k = 0; k < 3; ++k) off += std::abs(mean.rgba[4 * i + k] / kEmission[k] - 1.0) < 5e-3 ? 0 : 1;
    }
    EXPECT_GT(ball, 120u);
    const double n = static_cast<double>(ball);
    EXPECT_LT(std::sqrt(variance) / n, 2e-3);
    // Five standard errors (1 in 10⁶). At the rim the lobe reaches below the faces: two in a thousand.
    EXPECT_NEAR(sum / n, 1.0, 5 * std::sqrt(variance) / n + 2e-3);
    if (sampling == std::string("bsdf")) {
      EXPECT_LT(off, ball / 20);
    }
  }
}

// Lobes on the way, small and large lights, several bounces: whoever finds the light, there is as much of it.
TEST(PathTracer, GlossyRoomsAreOneWhateverFindsTheLight) {
  Builder b;
  addRoom(b, b.material(lambert({0.7f, 0.6f, 0.5f})));
  b.add(quad({-0.5f, 0.99f, -0.7f}, {0.5f, 0.99f, -0.7f}, {0.5f, 0.99f, 0.3f}, {-0.5f, 0.99f, 0.3f},
             b.material(lambert(glm::vec3(0), {6, 5, 4}))));
  b.add(sphere(16, 32, b.material(metal({0.9f, 0.8f, 0.6f}, 0.35f))), placed({-0.3f, -0.5f, -0.4f}, 0.45f));
  scene::Material coat;  // a lobe over what is diffuse
  coat.baseColor = {0.3f, 0.5f, 0.8f, 1};
  coat.metallic = 0;
  coat.roughness = 0.5f;
  b.add(sphere(16, 32, b.material(coat)), placed({0.5f, -0.6f, -0.2f}, 0.35f));
  const View view = View{b.scene, kInside}.look();
  const auto by = [&](const char* sampling) {
    return pathFrames(view, {{"maxBounces", "3"}, {"samples", "4"}, {"lightSampling", sampling}}, 24);
  };
  const Frames both = by("mis");
  expectSameMean(by("lights"), both, 0.3);
  expectSameMean(by("bsdf"), both, 0.3);
}

// They show to the camera, and to nothing else.
TEST(PathTracer, UnlitSurfacesAreBlackAlongPaths) {
  scene::Material unlit;
  unlit.model = scene::MaterialModel::Unlit;
  unlit.baseColor = {0.7f, 0.2f, 0.1f, 1};
  View view = ballInRoom(lambert(kAlbedo), unlit);
  for (const char* sampling : {"mis", "bsdf"}) {
    const Frames frames = pathFrames(view, {{"lightSampling", sampling}}, 1);
    size_t ball = 0;
    for (size_t i = 0; i < view.surface.size(); ++i) {
      const bool seen = view.emission[i].x > 0;
      ball += seen ? 0 : 1;
      for (int k = 0; k < 3; ++k) EXPECT_EQ(frames[0].rgba[4 * i + k], seen ? view.emission[i][k] : 0.0f);
    }
    EXPECT_GT(ball, 120u);
  }
}

// Ray queries and the pipeline: the same rays, so the same picture but for the few paths that rounding leads elsewhere.
TEST(PathTracer, BackEndsAgree) {
  View view{scene::Scene{}, lookAt({0.3f, 2, 1.5f}, {0, 0, 0}, 50)};
  Builder b;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(metal({0.9f, 0.8f, 0.7f}, 0.4f))));
  scene::Material veil = lambert({0.2f, 0.9f, 0.4f}, {1, 0, 0});
  veil.alphaMode = scene::AlphaMode::Blend;
  veil.baseColor.a = 0.5f;
  b.add(quad({-1, 0, -1}, {1, 0, -1}, {1, 1, -1}, {-1, 1, -1}, b.material(veil)));
  b.add(quad({-0.5f, 2, -0.5f}, {0.5f, 2, -0.5f}, {0.5f, 2, 0.5f}, {-0.5f, 2, 0.5f},
             b.material(lambert(glm::vec3(0.5f), glm::vec3(4)))));
  view.scene = b.scene;
  view.look();
  const Frames a = pathFrames(view, {{"samples", "4"}}, 2, trace::Backend::Pipeline),
               q = pathFrames(view, {{"samples", "4"}}, 2, trace::Backend::Query);
  double sum = 0;
  for (size_t f = 0; f < a.size(); ++f) {
    size_t off = 0;
    for (size_t i = 0; i < a[f].rgba.size(); ++i) {
      off += std::abs(a[f].rgba[i] - q[f].rgba[i]) <= 1e-4f * a[f].rgba[i] + 1e-6f ? 0 : 1;
      sum += a[f].rgba[i];
    }
    EXPECT_LE(off, a[f].rgba.size() / 100);
  }
  EXPECT_GT(sum, 50.0);
}

}  // namespace
}  // namespace weir::test
