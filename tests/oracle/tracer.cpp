#include "tracer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <weir/core/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "random.h"

namespace weir::oracle {
namespace {

/// What the filter of one ray knows.
struct Ray {
  RTCIntersectContext context;
  const Model* model;
  uint32_t from, to;
  uint64_t key;
  bool camera, shadow;
  glm::dvec3 direction;
  double through;
  std::vector<uint32_t> seen;  // Embree may ask about a triangle more than once
};

void filter(const RTCFilterFunctionNArguments* a) {
  if (a->valid[0] == 0) return;
  Ray& ray = *reinterpret_cast<Ray*>(a->context);
  const uint32_t triangle = RTCHitN_primID(a->hit, 1, 0);
  const Triangle& t = ray.model->triangles[triangle];
  const Material& m = ray.model->materials[static_cast<size_t>(t.material)];
  if (triangle == ray.from || triangle == ray.to) {
    a->valid[0] = 0;
    return;
  }
  if (ray.camera && !m.doubleSided) {
    const glm::dvec3 front = glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
    if (glm::dot(front, ray.direction) > 0) {
      a->valid[0] = 0;
      return;
    }
  }
  if (m.alpha == Alpha::Opaque) return;
  const double u = RTCHitN_u(a->hit, 1, 0), v = RTCHitN_v(a->hit, 1, 0);
  const double coverage = coverageAt(*ray.model, triangle, {1.0 - u - v, u, v});
  if (coverage >= 1) return;
  if (!ray.shadow) {
    if (Random(ray.key, triangle).next() >= coverage) a->valid[0] = 0;
    return;
  }
  if (std::ranges::count(ray.seen, triangle) == 0) {
    ray.seen.push_back(triangle);
    ray.through *= 1.0 - coverage;
  }
  a->valid[0] = 0;
}

RTCRay rayOf(const glm::dvec3& origin, const glm::dvec3& direction, double far) {
  RTCRay r{};
  r.org_x = static_cast<float>(origin.x);
  r.org_y = static_cast<float>(origin.y);
  r.org_z = static_cast<float>(origin.z);
  r.dir_x = static_cast<float>(direction.x);
  r.dir_y = static_cast<float>(direction.y);
  r.dir_z = static_cast<float>(direction.z);
  r.tfar = static_cast<float>(far);
  r.mask = 0xffffffffu;
  return r;
}

Ray contextOf(const Model& model, const glm::dvec3& direction, uint32_t from, uint32_t to) {
  Ray ray{.model = &model, .from = from, .to = to, .direction = direction, .through = 1.0};
  rtcInitIntersectContext(&ray.context);
  ray.context.filter = filter;
  return ray;
}

}  // namespace

struct Tracer::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

Tracer::Tracer(const Model& model) : model_(model), scene_(std::make_unique<Scene>()) {
  scene_->device = rtcNewDevice(nullptr);
  if (scene_->device == nullptr) throw RuntimeError("Embree: no device");
  scene_->scene = rtcNewScene(scene_->device);
  // Without RTC_BUILD_QUALITY_HIGH no triangle is split.
  rtcSetSceneFlags(scene_->scene,
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const size_t n = model.triangles.size();
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * n));
  auto* indices = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), n));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw RuntimeError("Embree: no memory");
  }
  for (size_t i = 0; i < 3 * n; ++i) {
    for (int c = 0; c < 3; ++c)
      vertices[3 * i + size_t(c)] = static_cast<float>(model.triangles[i / 3].position[i % 3][c]);
    indices[i] = static_cast<uint32_t>(i);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_->scene);
  if (const RTCError error = rtcGetDeviceError(scene_->device); error != RTC_ERROR_NONE)
    throw RuntimeError(fmt::format("Embree: error {}", static_cast<int>(error)));
}

Tracer::~Tracer() = default;

std::optional<Hit> Tracer::closest(const glm::dvec3& origin, const glm::dvec3& direction, uint64_t key, uint32_t from,
                                   bool camera) const {
  Ray ray = contextOf(model_, direction, from, kNoTriangle);
  ray.key = key;
  ray.camera = camera;
  RTCRayHit r{};
  r.ray = rayOf(origin, direction, std::numeric_limits<float>::infinity());
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->scene, &ray.context, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  // Möller and Trumbore 1997 in double precision; Embree has said that the triangle is met.
  const Triangle& t = model_.triangles[r.hit.primID];
  const glm::dvec3 e1 = t.position[1] - t.position[0], e2 = t.position[2] - t.position[0];
  const glm::dvec3 p = glm::cross(direction, e2), s = origin - t.position[0], q = glm::cross(s, e1);
  const double determinant = glm::dot(e1, p);
  Hit hit{.triangle = r.hit.primID, .distance = r.ray.tfar};
  double u = r.hit.u, v = r.hit.v;
  if (determinant != 0) {
    u = std::clamp(glm::dot(s, p) / determinant, 0.0, 1.0);
    v = std::clamp(glm::dot(direction, q) / determinant, 0.0, 1.0 - u);
    hit.distance = glm::dot(e2, q) / determinant;
  }
  hit.barycentrics = {1.0 - u - v, u, v};
  return hit;
}

double Tracer::transmittance(const glm::dvec3& origin, const glm::dvec3& direction, double distance, uint32_t from,
                             uint32_t to) const {
  Ray ray = contextOf(model_, direction, from, to);
  ray.shadow = true;
  RTCRay r = rayOf(origin, direction, distance * (1.0 - 1e-6));
  rtcOccluded1(scene_->scene, &ray.context, &r);
  return r.tfar < 0 ? 0.0 : ray.through;
}

glm::dvec3 leave(const Surface& s) {
  const glm::dvec3 p = glm::abs(s.position);
  return s.position + (s.geometric + s.view) * (4.0 * 0x1p-23 * std::max({p.x, p.y, p.z, 1e-3}));
}

}  // namespace weir::oracle
