// Images of floats, whatever their format.
layout(set = 0, binding = 0) readonly uniform image2D source;

Value valueAt(uvec2 pixel) {
  const vec4 v = imageLoad(source, ivec2(pixel));
  switch (settings.code) {
    case 0u: return numberOf(v.r);
    case 1u: return numberOf(v.g);
    case 2u: return numberOf(v.b);
    case 3u: return numberOf(v.a);
    case 4u: return colorOf(v.rgb);
    case 5u: return numberOf(luminanceOf(v.rgb));
    case 6u: return numberOf(length(v.rg));
    default: return colorOf(vec3(v.rg, 0.0));
  }
}
