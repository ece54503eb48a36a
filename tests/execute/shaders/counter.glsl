// What was there before, and one step more.
void run(uvec2 pixel) {
  const uint i = pixel.y * frameWidth + pixel.x;
  out_after[i].value = in_before[i].value + uint(param_step);
}
