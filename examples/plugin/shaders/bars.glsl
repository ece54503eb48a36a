// Ports and parameters are there by name, from the pass's description; BAR_ROWS comes from prepare().
void run(uvec2 id) {
  const ivec2 pixel = ivec2(id);
  vec4 color = imageLoad(in_color, pixel);
  const bool inBar = id.y < BAR_ROWS || id.y >= frameHeight - BAR_ROWS;
  if (inBar) color.rgb = ldexp(color.rgb, ivec3(-param_stops));
  imageStore(out_color, pixel, color);
}
