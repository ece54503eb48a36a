// A triangle as seen from a point, and directions uniform in its solid angle.
// Solid angle: Van Oosterom and Strackee 1983. Sampling: Arvo, "Stratified Sampling of Spherical Triangles", 1995.
#ifndef WEIR_SPHERICAL_TRIANGLE
#define WEIR_SPHERICAL_TRIANGLE

// Below this many steradians Arvo's angles lose too many bits in single precision; uniform area is then nearly uniform anyway.
const float kLeastSolidAngle = 1.0 / 128.0;

struct SphericalTriangle {
  vec3 a, b, c;      // unit, towards the corners
  float solidAngle;  // steradians
};

// From the vector to the first corner and the two edges from there.
SphericalTriangle sphericalTriangle(vec3 toCorner, vec3 edge1, vec3 edge2) {
  SphericalTriangle t;
  t.a = normalize(toCorner);
  t.b = normalize(toCorner + edge1);
  t.c = normalize(toCorner + edge2);
  const float volume = abs(dot(t.a, cross(t.b, t.c)));
  t.solidAngle = 2.0 * atan(volume, 1.0 + dot(t.a, t.b) + dot(t.b, t.c) + dot(t.c, t.a));
  return t;
}

// The component of v that is orthogonal to the unit vector `axis`, unit length.
vec3 awayFrom(vec3 axis, vec3 v) { return normalize(v - dot(v, axis) * axis); }

vec3 sampleSphericalTriangle(SphericalTriangle t, vec2 u) {
  const vec3 alongB = awayFrom(t.a, t.b), alongC = awayFrom(t.a, t.c);
  const float cosAlpha = clamp(dot(alongB, alongC), -1.0, 1.0);
  const float sinAlpha = length(cross(alongB, alongC));
  const float alpha = atan(sinAlpha, cosAlpha);
  const float part = u.x * t.solidAngle - alpha;
  const float sine = sin(part), cosine = cos(part);
  const float p = cosine - cosAlpha;
  const float q = sine + sinAlpha * dot(t.a, t.b);
  const float numerator = (q * cosine - p * sine) * cosAlpha - q;
  const float denominator = (q * sine + p * cosine) * sinAlpha;
  const float cosNew = denominator != 0.0 ? clamp(numerator / denominator, -1.0, 1.0) : 1.0;
  const vec3 corner = cosNew * t.a + sqrt(max(0.0, 1.0 - cosNew * cosNew)) * alongC;
  const float z = 1.0 - u.y * (1.0 - dot(corner, t.b));
  return normalize(z * t.b + sqrt(max(0.0, 1.0 - z * z)) * awayFrom(t.b, corner));
}

#endif
