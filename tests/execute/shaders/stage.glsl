// A number that depends on everything that this stage may read, and on nothing else.
uint stir(uint x) {
  x = (x ^ (x >> 16u)) * 0x7feb352du;
  x = (x ^ (x >> 15u)) * 0x846ca68bu;
  return x ^ (x >> 16u);
}

void run(uvec2 pixel) {
  const uint i = pixel.y * frameWidth + pixel.x;
  uint value = i + uint(param_salt) * 0x9e3779b9u + frameIndex;
#ifdef FIRST
  // A neighbour's value: whoever reads too early or too late reads another frame's.
  const uint other = (i * 7u + 13u) % (frameWidth * frameHeight);
#ifdef has_in_from
  value += stir(in_from[other].value);
#endif
#ifdef has_in_image
  value ^= stir(imageLoad(in_image, ivec2(other % frameWidth, other / frameWidth)).x + 1u);
#endif
  scratch_half[i].value = value;
#else
  const uint other = (i * 5u + 3u) % (frameWidth * frameHeight);
  value = stir(scratch_half[other].value) + value;
#ifdef has_in_old
  value += 3u * in_old[other].value;
#endif
  out_to[i].value = value;
  imageStore(out_image, ivec2(pixel), uvec4(value ^ 0x55aa55aau));
#endif
}
