void run(uvec2 pixel) {
  const uint i = pixel.y * frameWidth + pixel.x;
  out_word[i].value = VERSION;
#ifdef has_in_before
  out_word[i].value += in_before[i].value;
#endif
}
