// in_<input>, out_<output> and param_<parameter> are declared from Scale::describe (passes/template/scale.cpp).
void run(uvec2 pixel) {
  const vec4 color = imageLoad(in_color, ivec2(pixel));
  imageStore(out_color, ivec2(pixel), vec4(param_factor * color.rgb, color.a));
}
