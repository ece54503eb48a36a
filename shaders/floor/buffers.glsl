// Words one frame's size apart, so that neighbours read and write neighbours.
void run(uvec2 pixel) {
  const uint pixels = frameWidth * frameHeight, index = pixel.y * frameWidth + pixel.x;
  for (uint w = 0u; w < out_words_count; ++w) out_words[w * pixels + index] = scratch_from[w * pixels + index];
}
