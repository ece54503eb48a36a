// Buffers by the fields of their layout: a float, a word, or a vector of floats at an offset.
Value valueAt(uvec2 pixel) {
  uint first;
  if (!elementAt(pixel, first)) return nothing();
  const uint at = first + settings.word, w = words[at];
  switch (settings.code) {
    case 0u: return numberOf(uintBitsToFloat(w));
    case 1u: return wordOf(w);
    case 2u: return Value(vec3(int(w)), w, true);
    case 3u: return colorOf(vec3(w >> 21u, (w >> 10u) & 2047u, w & 1023u) / vec3(2047.0, 2047.0, 1023.0));
    case 4u: return colorOf(vec3(uintBitsToFloat(w), uintBitsToFloat(words[at + 1u]), 0.0));
    default: return colorOf(vec3(uintBitsToFloat(w), uintBitsToFloat(words[at + 1u]), uintBitsToFloat(words[at + 2u])));
  }
}
