// Reservoirs in the field's terms.
LAYOUT_STRUCT
#include "light_place.glsl"
#include "reservoir_bits.glsl"

// 0: empty, 1: confidence without a sample, 2: a sample, 3: hidden in the last frame, 4: seen.
uint stateOf(Reservoir r) {
  if (isNull(r)) return r.confidence > 0.0 ? 1u : 0u;
  return isSeen(r) ? 4u : wasHidden(r) ? 3u : 2u;
}

Value valueAt(uvec2 pixel) {
  uint first;
  if (!elementAt(pixel, first)) return nothing();
  const Reservoir r = Reservoir(words[first], words[first + 1u], uintBitsToFloat(words[first + 2u]), uintBitsToFloat(words[first + 3u]));
  switch (settings.code) {
    case 0u: return wordOf(stateOf(r));
    case 1u: return isNull(r) ? nothing() : wordOf(lightOf(r));
    case 2u: return isNull(r) ? nothing() : colorOf(vec3(unpackPlace(r.place), 0.0));
    case 3u: return numberOf(r.weight);
    default: return numberOf(r.confidence);
  }
}
