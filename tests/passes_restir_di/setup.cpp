#include "setup.h"

#include <weir/image/student.h>
#include <weir/scene/packing.h>

#include <cmath>

namespace weir::test {
namespace {

using oracle::Vec;

/// Regularised upper incomplete gamma function Q(a, x) by series or continued fraction (DLMF 8.11.4, 8.9.2).
double gammaQ(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 1000; ++n) sum += term *= x / (a + n);
    return 1.0 - sum * front;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
  for (int n = 1; n < 1000; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    h *= d * c;
  }
  return front * h;
}

/// Two triangles, front side along cross(a, b).
void addQuad(scene::Scene& scene, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b, int material) {
  scene::Primitive primitive;
  primitive.positions = {corner, corner + a, corner + a + b, corner + b};
  primitive.indices = {0, 1, 2, 0, 2, 3};
  primitive.material = material;
  scene::Mesh mesh;
  mesh.primitives.push_back(std::move(primitive));
  scene.meshes.push_back(std::move(mesh));
  scene::Instance instance;
  instance.mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.instances.push_back(instance);
}

}  // namespace

passes::PackedSurface nothing() {
  return {0.0f, 0, 0, 0, 0, 0x7f7f};
}

passes::PackedSurface packSurface(double distance, const Vec& geometric, const Vec& normal, const Finish& finish,
                                  uint32_t jitterX, uint32_t jitterY) {
  return {static_cast<float>(distance),
          scene::packNormal(glm::vec3(glm::normalize(geometric))),
          scene::packNormal(glm::vec3(glm::normalize(normal))),
          oracle::albedoBits(finish.diffuse),
          oracle::albedoBits(finish.f0),
          jitterX | jitterY << 8 | static_cast<uint32_t>(std::lround(finish.roughness * 65535.0)) << 16};
}

scene::Camera frontCamera(double halfSize) {
  scene::Camera camera;
  camera.eye = {0.0f, 0.0f, 5.0f};
  camera.verticalFov = static_cast<float>(2.0 * std::atan(halfSize / 5.0));
  return camera;
}

View::View(uint32_t width, uint32_t height, const scene::Camera& camera)
    : width_(width),
      height_(height),
      camera_(camera),
      packed_(size_t{width} * height, nothing()),
      surfaces_(packed_.size()) {}

void View::set(uint32_t x, uint32_t y, const passes::PackedSurface& surface) {
  const size_t pixel = size_t{y} * width_ + x;
  packed_[pixel] = surface;
  surfaces_[pixel] = oracle::unpack(surface, x, y, camera_, width_, height_);
}

void View::setOnPlane(uint32_t x, uint32_t y, double height, const Vec& normal, const Finish& finish) {
  const Vec ray = oracle::direction(camera_, x + 0.5, y + 0.5, width_, height_);
  set(x, y, packSurface((height - camera_.eye.z) / ray.z, normal, normal, finish));
}

View planeView(uint32_t width, uint32_t height, const scene::Camera& camera) {
  View view(width, height, camera);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) view.setOnPlane(x, y, 0.0);
  return view;
}

View stepView(uint32_t width, uint32_t height, const scene::Camera& camera) {
  View view(width, height, camera);
  Finish glossy;
  glossy.diffuse = {0.2, 0.3, 0.5};
  glossy.f0 = {0.3, 0.2, 0.1};
  glossy.roughness = 0.4;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      if (2 * x < width)
        view.setOnPlane(x, y, 0.0, Vec(0.9, 0.0, 0.45));
      else
        view.setOnPlane(x, y, -2.0, Vec(-0.9, 0.1, 0.45), glossy);
    }
  }
  return view;
}

void show(PassTest& pass, const View& view, scene::Scene scene) {
  pass.size(view.width(), view.height()).camera(view.camera()).scene(std::move(scene)).input("surface", view.packed());
}

scene::Scene smallScene(const Lights& lights) {
  scene::Scene scene;
  scene.materials.resize(3);
  scene.materials[0].doubleSided = true;
  scene.materials[1].emission = {6.0f, 5.0f, 4.0f};
  scene.materials[2].doubleSided = true;
  scene.materials[2].alphaMode = scene::AlphaMode::Blend;
  scene.materials[2].baseColor = {1.0f, 1.0f, 1.0f, 0.6f};
  // Far behind every surface: it blocks nothing and makes the scene's bounds hold the surfaces.
  addQuad(scene, {-3.0f, -3.0f, -6.0f}, {6.0f, 0.0f, 0.0f}, {0.0f, 6.0f, 0.0f}, 0);
  if (lights.blocker) addQuad(scene, {-0.3f, -0.7f, 0.8f}, {1.1f, 0.0f, 0.1f}, {0.0f, 1.3f, 0.0f}, 0);
  if (lights.veil) addQuad(scene, {-1.7f, -1.2f, 0.7f}, {1.9f, 0.1f, 0.0f}, {0.1f, 1.6f, 0.2f}, 2);
  // Front side towards -z, where the surfaces are.
  if (lights.quad) addQuad(scene, {-1.5f, 0.6f, 2.0f}, {0.0f, 0.9f, 0.0f}, {1.2f, 0.0f, 0.3f}, 1);
  if (lights.points) {
    const glm::vec3 positions[] = {{1.6f, 1.2f, 1.5f}, {-1.4f, -1.0f, 1.2f}, {0.2f, 0.1f, 2.5f}, {2.5f, -1.5f, 3.0f}};
    const glm::vec3 intensities[] = {{4, 1, 1}, {1, 3, 1}, {6, 6, 6}, {2, 2, 9}};
    for (int i = 0; i < 4; ++i) {
      scene::PunctualLight light;
      light.position = positions[i];
      light.intensity = intensities[i];
      if (i == 3) light.range = 6.0f;
      scene.lights.push_back(light);
    }
  }
  if (lights.spot) {
    scene::PunctualLight light;
    light.kind = scene::LightKind::Spot;
    light.position = {-0.5f, -1.0f, 3.0f};
    light.direction = glm::normalize(glm::vec3(0.3f, 0.3f, -1.0f));
    light.intensity = {20.0f, 18.0f, 10.0f};
    light.innerCone = 0.15f;
    light.outerCone = 0.5f;
    scene.lights.push_back(light);
    light.kind = scene::LightKind::Directional;
    light.direction = glm::normalize(glm::vec3(-0.4f, 0.2f, -1.0f));
    light.intensity = {0.4f, 0.4f, 0.5f};
    scene.lights.push_back(light);
  }
  return scene;
}

scene::Scene pointScene(const std::vector<std::pair<glm::vec3, glm::vec3>>& positionsAndIntensities) {
  scene::Scene scene;
  for (const auto& [position, intensity] : positionsAndIntensities) {
    scene::PunctualLight light;
    light.position = position;
    light.intensity = intensity;
    scene.lights.push_back(light);
  }
  return scene;
}

bool isFinite(const passes::Reservoir& r) {
  return std::isfinite(r.weight) && std::isfinite(r.confidence);
}

double estimate(const oracle::World& world, const oracle::Surface& surface, const passes::Reservoir& r,
                bool visibility) {
  if (!(r.weight > 0.0f)) return 0.0;
  const double through = visibility ? world.transmittance(surface, lightOf(r), r.place) : 1.0;
  return through * world.target(surface, lightOf(r), r.place) * static_cast<double>(r.weight);
}

std::vector<passes::Reservoir> freshReservoirs(const oracle::World& world, const View& view, oracle::Random& random,
                                               int candidates, bool visibility, double confidence, int perPixel) {
  std::vector<passes::Reservoir> result;
  for (size_t i = 0; i < view.pixels(); ++i) {
    for (int k = 0; k < perPixel; ++k) {
      passes::Reservoir r{};
      if (view.has(i)) r = world.sample(view[i], random, candidates, visibility, confidence);
      if (visibility && r.weight > 0.0f && random() % 2 == 0 && world.transmittance(view[i], r.light, r.place) == 1.0)
        r.light |= 0x80000000u;
      result.push_back(r);
    }
  }
  return result;
}

std::vector<double> directLight(const oracle::World& world, const View& view, bool shadows) {
  std::vector<double> result;
  for (size_t i = 0; i < view.pixels(); ++i)
    result.push_back(view.has(i) ? world.directLight(view[i], shadows, 24) : 0.0);
  return result;
}

scene::Scene namedLights(uint32_t count) {
  return pointScene({count, {glm::vec3(0.5f, 0.5f, 3.0f), glm::vec3(1.0f)}});
}

void Sample::add(double value) {
  ++count_;
  const double before = value - mean_;
  mean_ += before / static_cast<double>(count_);
  squares_ += before * (value - mean_);
}

double Sample::standardError() const {
  const auto n = static_cast<double>(count_);
  return std::sqrt(squares_ / (n * (n - 1.0)));
}

double Sample::t(double expected) const {
  return (mean_ - expected) / standardError();
}

testing::AssertionResult agrees(const Sample& sample, double expected, double alpha, int comparisons) {
  const double bound = image::studentTBound(static_cast<int>(sample.count()) - 1, alpha, comparisons);
  const bool good = std::abs(sample.t(expected)) <= bound;
  return (good ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "mean " << sample.mean() << " ± " << sample.standardError() << ", expected " << expected << ": t "
         << sample.t(expected) << ", bound " << bound;
}

double chiSquareP(const std::vector<uint64_t>& counts, const std::vector<double>& probabilities) {
  double total = 0.0, chi = 0.0, pooledCount = 0.0, pooledExpected = 0.0;
  for (uint64_t c : counts) total += static_cast<double>(c);
  int cells = 0;
  const auto cell = [&](double count, double expected) {
    chi += (count - expected) * (count - expected) / expected;
    ++cells;
  };
  for (size_t i = 0; i < counts.size(); ++i) {
    const double expected = probabilities[i] * total;
    if (expected >= 5.0) {
      cell(static_cast<double>(counts[i]), expected);
    } else {
      pooledCount += static_cast<double>(counts[i]);
      pooledExpected += expected;
    }
  }
  if (pooledExpected >= 1.0)
    cell(pooledCount, pooledExpected);
  else if (pooledCount > 12.0)
    return 0.0;  // Poisson: less than 1e-9 for a mean below 1
  return gammaQ(0.5 * (cells - 1), 0.5 * chi);
}

}  // namespace weir::test
