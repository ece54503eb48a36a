#include "path.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <thread>
#include <vector>

namespace weir::oracle {
namespace {

/// Below this many, later surfaces ask every punctual light too.
constexpr size_t kFewLights = 4;
/// Surfaces from this one on are met with the probability of what the path still carries.
constexpr uint32_t kRouletteFrom = 4;

class Integrator {
 public:
  Integrator(const Model& model, const Tracer& tracer, const Options& options)
      : model_(model), tracer_(tracer), options_(options), area_(model) {}

  glm::dvec3 radiance(const glm::dvec3& eye, glm::dvec3 direction, const Cone& cone, Random& random) const {
    std::optional<Hit> hit = tracer_.closest(eye, direction, random.bits(), kNoTriangle, true);
    if (!hit) return glm::dvec3(0);
    Surface s = surfaceAt(model_, *hit, direction, cone);
    glm::dvec3 sum = s.emission, carried(1);
    for (uint32_t bounce = 0;; ++bounce) {
      if (s.unlit) return sum;
      const glm::dvec3 from = leave(s);
      sum += carried * (punctual(s, from, bounce == 0, random) + area(s, from, random));
      // One direction for both: light of what it meets now, and the path's next surface.
      direction = sampleBsdf(s, random.next3());
      const double density = densityOfBsdf(s, direction);
      const glm::dvec3 f = bsdfCos(s, direction);
      if (f == glm::dvec3(0) || !(density > 0)) return sum;
      carried *= f / density;
      if (bounce == options_.bounces && area_.empty()) return sum;
      if (bounce >= kRouletteFrom) {
        const double survival = std::min(0.95, std::max({carried.r, carried.g, carried.b}));
        if (random.next() >= survival) return sum;
        carried /= survival;
      }
      hit = tracer_.closest(from, direction, random.bits(), s.triangle);
      if (!hit) return sum;
      const glm::dvec3 before = s.position;
      s = surfaceAt(model_, *hit, direction);
      if (!s.unlit && s.emission != glm::dvec3(0)) {
        const double byLight = area_.density(*hit, before, direction);
        sum += carried * s.emission * (density / (density + byLight));  // balance heuristic (Veach 1997)
      }
      if (bounce == options_.bounces) return sum;
    }
  }

 private:
  glm::dvec3 lit(const Surface& s, const glm::dvec3& from, const PunctualLight& light) const {
    const Arrival a = arrivalFrom(light, s.position);
    const glm::dvec3 f = bsdfCos(s, a.direction) * a.irradiance;
    if (f == glm::dvec3(0)) return f;
    return f * tracer_.transmittance(from, a.direction, a.distance, s.triangle);
  }

  glm::dvec3 punctual(const Surface& s, const glm::dvec3& from, bool first, Random& random) const {
    if (model_.lights.empty()) return glm::dvec3(0);
    glm::dvec3 sum(0);
    if ((first && options_.everyPunctual) || model_.lights.size() <= kFewLights) {
      for (const PunctualLight& light : model_.lights) sum += lit(s, from, light);
      return sum;
    }
    // One of them, in proportion to what it brings to the surface if nothing is between: more than zero wherever the
    // light counts, as light below the surface doesn't.
    thread_local std::vector<double> upTo;
    upTo.clear();
    double total = 0;
    for (const PunctualLight& light : model_.lights) {
      const Arrival a = arrivalFrom(light, s.position);
      total += luminanceOf(a.irradiance) * std::max(glm::dot(s.normal, a.direction), 0.0);
      upTo.push_back(total);
    }
    if (!(total > 0)) return sum;
    const auto found = std::ranges::upper_bound(upTo, random.next() * total);
    const size_t i = std::min(static_cast<size_t>(found - upTo.begin()), upTo.size() - 1);
    const double chance = (upTo[i] - (i > 0 ? upTo[i - 1] : 0.0)) / total;
    return chance > 0 ? lit(s, from, model_.lights[i]) / chance : sum;
  }

  glm::dvec3 area(const Surface& s, const glm::dvec3& from, Random& random) const {
    if (area_.empty()) return glm::dvec3(0);
    const AreaSample l = area_.sample(s.position, random);
    if (!(l.density > 0) || l.triangle == s.triangle) return glm::dvec3(0);
    const glm::dvec3 f = bsdfCos(s, l.direction) * l.radiance / (l.density + densityOfBsdf(s, l.direction));
    if (f == glm::dvec3(0)) return f;
    return f * tracer_.transmittance(from, l.direction, l.distance, s.triangle, l.triangle);
  }

  const Model& model_;
  const Tracer& tracer_;
  const Options& options_;
  AreaLights area_;
};

}  // namespace

image::RestartAccumulator render(const Model& model, const Tracer& tracer, const Camera& camera, const Options& o) {
  const Integrator integrator(model, tracer, o);
  const double slope = std::tan(camera.verticalFov / 2);
  const glm::dvec3 up = camera.up * slope;
  const glm::dvec3 right = glm::cross(camera.forward, camera.up) * (slope * o.width / o.height);
  // Of the picture's plane at distance 1, and of what is left of it askew.
  const double pixel = 4 * glm::length(up) * glm::length(right) / (double{1} * o.width * o.height);

  const auto colourOf = [&](uint32_t x, uint32_t y, uint32_t batch) {
    Random random(o.seed, batch, x, y);
    glm::dvec3 sum(0);
    for (uint32_t i = 0; i < o.samples; ++i) {
      const glm::dvec2 place = o.jitter ? random.next2() : glm::dvec2(0.5);
      const glm::dvec2 at = (glm::dvec2(x, y) + place) / glm::dvec2(o.width, o.height) * 2.0 - 1.0;
      const glm::dvec3 d = glm::normalize(camera.forward + at.x * right - at.y * up);
      const double cosine = glm::dot(d, camera.forward);
      sum += integrator.radiance(camera.eye, d, {std::sqrt(pixel * cosine * cosine * cosine)}, random);
    }
    return sum / static_cast<double>(o.samples);
  };

  image::RestartAccumulator result(o.tile);
  const uint32_t threads = o.threads ? o.threads : std::max(1u, std::thread::hardware_concurrency());
  for (uint32_t batch = 0; batch < o.batches; ++batch) {
    image::Picture picture{o.width, o.height, std::vector<float>(size_t{4} * o.width * o.height, 1.0f), {}};
    std::atomic<uint32_t> next = 0;
    std::vector<std::thread> workers;
    for (uint32_t t = 0; t < threads; ++t) {
      workers.emplace_back([&] {
        for (uint32_t y = next++; y < o.height; y = next++) {
          for (uint32_t x = 0; x < o.width; ++x) {
            const glm::dvec3 c = colourOf(x, y, batch);
            for (int k = 0; k < 3; ++k) picture.at(x, y)[k] = static_cast<float>(c[k]);
          }
        }
      });
    }
    for (std::thread& worker : workers) worker.join();
    result.add(picture);
    if (o.progress) o.progress(batch + 1);
  }
  return result;
}

}  // namespace weir::oracle
