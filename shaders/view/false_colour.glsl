// Dark violet over blue and green to light yellow, in equal steps to the eye; luminance grows all the way. tools/false_colour.py
// derives the polynomials. t in [0, 1]; encoded sRGB.
vec3 falseColor(float t) {
  const vec3 c0 = vec3(0.1759, 0.0423, 0.2692), c1 = vec3(-0.2274, 0.9947, 1.1763), c2 = vec3(6.4691, 0.1043, -0.6229),
             c3 = vec3(-45.0982, -0.3071, -2.5192), c4 = vec3(105.5855, 1.2039, 6.2775), c5 = vec3(-98.5673, -2.0846, -7.3578),
             c6 = vec3(32.6163, 0.9624, 3.3026);
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}
