// Reservoirs of light samples and the target function. Bitterli et al. 2020 (ReSTIR), Lin et al. 2022 (GRIS): W is the unbiased
// contribution weight, c the confidence. The struct Reservoir is generated from passes/common/layouts.h.
#ifndef WEIR_RESERVOIR
#define WEIR_RESERVOIR

#include "mutants.glsl"
#include "bsdf.glsl"
#include "lights.glsl"
#include "reservoir_bits.glsl"
#include "visibility.glsl"

Reservoir emptyReservoir() { return Reservoir(0u, 0u, 0.0, 0.0); }
Reservoir nullReservoir(float confidence) { return Reservoir(0u, 0u, 0.0, confidence); }

// A reservoir that came from outside: whatever is not a finite, valid sample becomes a null sample, so that one bad value
// can't spread.
Reservoir sanitized(Reservoir r) {
  if (!(r.confidence > 0.0) || isinf(r.confidence)) return emptyReservoir();
  if (!(r.weight > 0.0) || isinf(r.weight) || lightOf(r) >= lightCount()) {
    r.weight = 0.0;
    r.light = 0u;
  }
  return r;
}

// Light that the sample sends to the viewer by way of the surface, unshadowed: BSDF · cosine · radiance · geometry term.
vec3 unshadowed(Surface s, LightSample light) {
  if (light.radiance == vec3(0.0)) return vec3(0.0);
  return bsdfCos(s, light.direction) * light.radiance;
}

// p̂: luminance of the unshadowed contribution.
float targetFunction(Surface s, LightSample light) { return luminance(unshadowed(s, light)); }

// The same to choose candidates by: nearly p̂, cheaper, and above 0 wherever p̂ is. What it is not in proportion is made up for by W.
struct QuickTarget {
  vec3 diffuse;  // c_diff / π and F0, weighed for luminance
  vec3 specular;
  float nv, a2, gv;
};

const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);

QuickTarget quickTarget(Surface s) {
  QuickTarget q;
  q.diffuse = kLuminance * s.diffuse / kPi;
  q.nv = max(dot(s.normal, s.view), 0.0);
  q.a2 = s.alpha * s.alpha;
  q.gv = sqrt(q.nv * q.nv * (1.0 - q.a2) + q.a2);
  q.specular = kLuminance * s.f0;
  return q;
}

float quickTargetOf(QuickTarget q, Surface s, LightSample light) {
  const float nl = dot(s.normal, light.direction);
  if (!(nl > 0.0) || !(dot(s.geometricNormal, light.direction) > 0.0)) return 0.0;
  const float vl = dot(s.view, light.direction), hh = 2.0 + 2.0 * vl;
  const float nh = nl + q.nv;
  const float m = 1.0 - sqrt(max(0.25 * hh, 0.0)), m2 = m * m, m5 = m2 * m2 * m;
  const float d = max(nh * nh / max(hh, 1e-6) * (q.a2 - 1.0) + 1.0, 0.5 * q.a2);
  const float lobe = q.a2 * 0.5 / (kPi * d * d * (nl * q.gv + q.nv * sqrt(nl * nl * (1.0 - q.a2) + q.a2)));
  const vec3 specular = q.specular + (kLuminance - q.specular) * m5;
  return nl * dot(q.diffuse * (1.0 - m5) + specular * lobe, light.radiance);
}

// Streaming weighted choice with the sum of weights. The caller's `u` is uniform in [0, 1).
struct Selection {
  uint light, place;
  float target;  // p̂ of the chosen sample at the merging pixel
  float sum;     // Σ w
  bool seen;     // the chosen one is known to be visible there
  bool hidden;   // it was hidden from there in the last frame
};

Selection noSelection() { return Selection(0u, 0u, 0.0, 0.0, false, false); }

// Whether it was taken: until another one is, it is what was chosen.
bool offer(inout Selection s, uint light, uint place, float target, float weight, bool seen, float u) {
  if (!(weight > 0.0) || isinf(weight)) return false;
  s.sum += weight;
  if (!(MUTANT(26, u * u, u) * s.sum < weight)) return false;
  s.light = light;
  s.place = place;
  s.target = target;
  s.seen = seen;
  s.hidden = false;
  return true;
}

Reservoir finish(Selection s, float confidence) {
  if (!(s.sum > 0.0)) return nullReservoir(confidence);
  const float weight = s.sum / MUTANT(27, s.target * 1.004, s.target);
  if (isinf(weight)) return nullReservoir(confidence);
  return Reservoir(s.light | (s.seen ? kSeen : 0u) | (s.hidden ? kHidden : 0u), s.place, weight, confidence);
}

#ifdef CAN_TRACE
// Shoots the shadow ray of a reservoir's own sample: a hidden one becomes a null sample (its W · f is zero either way).
void testVisibility(inout Reservoir r, Surface s) {
  if (isNull(r) || isSeen(r)) return;
  const float through = traceVisibility(s, evaluateLight(lightOf(r), r.place, s.position));
  if (MUTANT(28, through < 1.0, through <= 0.0)) {
    r.light = 0u;
    r.weight = 0.0;
  } else if (through >= 1.0) {
    r.light |= kSeen;
  }
}
#endif

#endif
