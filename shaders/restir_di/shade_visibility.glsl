// The final shadow rays: of samples that are not known to be seen (shade.glsl).
#include "mutants.glsl"
#include "reservoir.glsl"
#include "ray_order.glsl"

void run(uvec2 id) {
  uvec2 pixel;
  if (!pixelOfRay(id.x, pixel)) return;
  const uint index = pixel.y * frameWidth + pixel.x;
  const Surface surface = unpackSurface(in_surface[index], pixel, camera, frameSize);
  vec3 arrives = vec3(0.0), hidden = vec3(0.0);
  for (uint k = 0u; k < in_reservoirs_count; ++k) {
    Reservoir r = sanitized(in_reservoirs[index * in_reservoirs_count + k]);
    if (isNull(r)) continue;
    const LightSample light = evaluateLight(lightOf(r), r.place, surface.position);
    const float through = isSeen(r) ? 1.0 : traceVisibility(surface, light);
#ifdef wanted_out_reservoirs
    if (!isSeen(r)) {
      r.light = lightOf(r) | (through >= 1.0 ? kSeen : through <= 0.0 ? kHidden : 0u);
      out_reservoirs[index * in_reservoirs_count + k] = r;
    }
#endif
    if (in_reservoirs_count == 1u && through >= 1.0) return;
    const vec3 f = unshadowed(surface, light) * r.weight;
    arrives += f * through;
    hidden += f * (1.0 - through);
  }
#ifdef has_in_light
  arrives = imageLoad(in_light, ivec2(pixel)).rgb * float(in_reservoirs_count) - MUTANT(70, 0.5, 1.0) * hidden;
#endif
  imageStore(out_color, ivec2(pixel), vec4(imageLoad(in_emission, ivec2(pixel)).rgb + arrives / float(in_reservoirs_count), 1.0));
}
