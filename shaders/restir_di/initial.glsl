// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. Several reservoirs of a pixel share the candidates and choose from them independently.
#include "random.glsl"
#include "reservoir.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  Selection selections[out_reservoirs_count];
  for (uint k = 0u; k < out_reservoirs_count; ++k) selections[k] = noSelection();

  const bool lit = isSurface(packed) && lightCount() > 0u;
  Surface surface;
  if (lit) {
    surface = unpackSurface(packed, pixel, camera, frameSize);
    Random random = randomFor(pixel, 0u);
    for (int i = 0; i < param_candidates; ++i) {
      const vec4 u = next4(random);
      const uint light = pickLight(u.x, u.y);
      const uint place = packPlace(u.zw);
      const LightSample s = evaluateLight(light, place, surface.position);
      const float target = targetFunction(surface, s);
      if (!(target > 0.0)) continue;
      // 1/M · p̂ / p, with p = pdf of the light / its area.
      const float weight = target * s.area / (sceneLights[light].pdf * float(param_candidates));
      const vec4 keep = next4(random);
      for (uint k = 0u; k < out_reservoirs_count; ++k) {
        offer(selections[k], light, place, target, weight, false, keep[k]);
      }
    }
  }
  for (uint k = 0u; k < out_reservoirs_count; ++k) {
    Reservoir r = lit ? finish(selections[k], 1.0) : emptyReservoir();
#ifdef CAN_TRACE
    if (param_visibility && lit) testVisibility(r, surface);
#endif
    out_reservoirs[index * out_reservoirs_count + k] = r;
  }
}
