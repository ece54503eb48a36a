// Tracing: one interface, two back ends (ray-tracing pipeline, ray query). A ray kernel (CAN_TRACE) calls
//   Hit traceClosest(origin, direction, tMax, key, flags)  nearest surface; BLEND surfaces are there with the probability of their
//                                                        alpha. flags: kEverySide, or kCameraSides for what a camera sees: glTF
//                                                        hides the back of single-sided surfaces
//   float traceTransmittance(origin, direction, tMax)    0: blocked, 1: free, between: through BLEND surfaces
//   float traceTransmittancePrevious(…)                  the same through last frame's scene, for passes that need
//                                                        scene.acceleration@previous
// Distances are in units of `direction`.
#ifndef WEIR_TRACE
#define WEIR_TRACE

#include "trace_types.glsl"

const uint kEverySide = 0u, kCameraSides = 0x10u;  // the latter is gl_RayFlagsCullBackFacingTrianglesEXT

void countRay() {
#ifdef COUNT_RAYS
  atomicAdd(rayCounter.count, 1u);
#endif
}

#ifdef TRACE_PIPELINE
layout(location = 0) rayPayloadEXT HitPayload tracePayload;
layout(location = 1) rayPayloadEXT float traceThrough;

Hit traceClosest(vec3 origin, vec3 direction, float tMax, uint key, uint flags) {
  countRay();
  tracePayload.triangle = kNoTriangle;
  tracePayload.key = key;
  traceRayEXT(sceneAcceleration, flags, 0xffu, 0u, 0u, 0u, origin, 0.0, direction, tMax, 0);
  return Hit(tracePayload.triangle, tracePayload.instance, tracePayload.barycentrics);
}

// A structure can't be a function's parameter, so that each has its own. Nothing but any-hit touches the payload on the way; an
// accepted hit ends the ray, and only a miss says so: its shader turns a surviving transmittance τ into -τ.
#define DEFINE_TRANSMITTANCE(name, structure)                                                                             \
  float name(vec3 origin, vec3 direction, float tMax) {                                                                   \
    countRay();                                                                                                           \
    traceThrough = 1.0;                                                                                                   \
    traceRayEXT(structure, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 1u, 0u, 1u,     \
                origin, 0.0, direction, tMax, 1);                                                                         \
    return traceThrough < 0.0 ? -traceThrough : 0.0;                                                                      \
  }
#endif

#ifdef TRACE_QUERY
Hit traceClosest(vec3 origin, vec3 direction, float tMax, uint key, uint flags) {
  countRay();
  rayQueryEXT query;
  rayQueryInitializeEXT(query, sceneAcceleration, flags, 0xffu, origin, 0.0, direction, tMax);
  while (rayQueryProceedEXT(query)) {
    const uint instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, false);
    const uint triangle = hitTriangle(instance, rayQueryGetIntersectionGeometryIndexEXT(query, false),
                                      rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    const float coverage = triangleCoverage(triangle, rayQueryGetIntersectionBarycentricsEXT(query, false));
    if (coversPixel(coverage, triangle, key)) rayQueryConfirmIntersectionEXT(query);
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) {
    return Hit(kNoTriangle, 0u, vec2(0.0));
  }
  const uint instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
  return Hit(hitTriangle(instance, rayQueryGetIntersectionGeometryIndexEXT(query, true),
                         rayQueryGetIntersectionPrimitiveIndexEXT(query, true)),
             instance, rayQueryGetIntersectionBarycentricsEXT(query, true));
}

#define DEFINE_TRANSMITTANCE(name, structure)                                                                             \
  float name(vec3 origin, vec3 direction, float tMax) {                                                                   \
    countRay();                                                                                                           \
    rayQueryEXT query;                                                                                                    \
    rayQueryInitializeEXT(query, structure, gl_RayFlagsTerminateOnFirstHitEXT, 0xffu, origin, 0.0, direction, tMax);      \
    float through = 1.0;                                                                                                  \
    while (rayQueryProceedEXT(query)) {                                                                                   \
      const uint triangle = hitTriangle(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false),                      \
                                        rayQueryGetIntersectionGeometryIndexEXT(query, false),                            \
                                        rayQueryGetIntersectionPrimitiveIndexEXT(query, false));                          \
      through *= 1.0 - triangleCoverage(triangle, rayQueryGetIntersectionBarycentricsEXT(query, false));                  \
      if (through <= 0.0) {                                                                                               \
        rayQueryTerminateEXT(query);                                                                                      \
        return 0.0;                                                                                                       \
      }                                                                                                                   \
    }                                                                                                                     \
    return rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT ? through : 0.0;        \
  }
#endif

#ifdef CAN_TRACE
DEFINE_TRANSMITTANCE(traceTransmittance, sceneAcceleration)
#ifdef NEED_PREVIOUS_ACCELERATION
#ifdef SCENE_ANIMATED
DEFINE_TRANSMITTANCE(traceTransmittancePrevious, scenePreviousAcceleration)
#else
#define traceTransmittancePrevious traceTransmittance
#endif
#endif
#endif

#endif
