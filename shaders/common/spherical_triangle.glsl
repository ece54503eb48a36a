// A triangle as seen from a point, and directions uniform in its solid angle.
// Source: Peters, "BRDF Importance Sampling for Polygonal Lights", SIGGRAPH 2021: Van Oosterom and Strackee's tangent of half the
// solid angle, inverted for the triangle that a sample cuts off. Written so that no term is a difference of nearly equal numbers:
// a surface that touches a light sees a sliver, long and with hardly any solid angle, whose points are still worlds apart.
#ifndef WEIR_SPHERICAL_TRIANGLE
#define WEIR_SPHERICAL_TRIANGLE

// A triangle whose longest side is below this part of the distance to it may as well be sampled by area: cos / d² then varies over
// it by less than ((1 + r) / (1 - r))³, about 2, and single precision serves area better.
const float kNearRatio = 1.0 / 8.0;

struct SphericalTriangle {
  vec3 a, b, c;        // unit, towards the corners
  float g0, g1, g2;    // tan(Ω / 2) = g0 / (g1 + g2)
  float solidAngle;    // steradians; 0 where the point lies in the triangle's plane, as far as its error can tell
  bool near;           // to be sampled by solid angle
};

// From the vector to the first corner and the two edges from there; `error` is that of the vector, metres.
SphericalTriangle sphericalTriangle(vec3 toCorner, vec3 edge1, vec3 edge2, float error) {
  SphericalTriangle t;
  const vec3 corner1 = toCorner + edge1, corner2 = toCorner + edge2, edge3 = edge2 - edge1;
  const float d0 = length(toCorner), d1 = length(corner1), d2 = length(corner2);
  const float longest2 = max(max(dot(edge1, edge1), dot(edge2, edge2)), dot(edge3, edge3));
  const float nearest = min(min(d0, d1), d2);
  t.near = longest2 > kNearRatio * kNearRatio * nearest * nearest;
  t.a = toCorner / d0;
  t.b = corner1 / d1;
  t.c = corner2 / d2;
  // The volume by the height over the plane, 1 + a·b by the chord a + b: neither cancels in a sliver.
  const vec3 normal = cross(edge1, edge2);
  const float height = abs(dot(toCorner, normal));
  t.g0 = height > error * length(normal) ? height / (d0 * d1 * d2) : 0.0;
  const vec3 chord = t.a + t.b;
  t.g1 = dot(chord, t.c);
  t.g2 = 0.5 * dot(chord, chord);
  t.solidAngle = t.g0 > 0.0 ? 2.0 * atan(t.g0, t.g1 + t.g2) : 0.0;
  return t;
}

// Only for a solid angle above 0.
vec3 sampleSphericalTriangle(SphericalTriangle t, vec2 u) {
  // The corner c moves along its side to a, until what is left of the triangle has the part u.x of the solid angle.
  const float halfAngle = 0.5 * u.x * t.solidAngle;
  const vec3 r = (t.g0 * cos(halfAngle) - t.g1 * sin(halfAngle)) * t.a + t.g2 * sin(halfAngle) * t.c;
  const vec3 moved = 2.0 * dot(t.a, r) / dot(r, r) * r - t.a;
  // Then from b towards the moved corner, uniform in the cosine.
  const vec3 across = moved - t.b;
  const float whole = 0.5 * dot(across, across);  // 1 - cosine of the arc
  // Seen from a point between b and the moved corner, by rounding: no arc leads from one to the other.
  if (!(whole < 2.0)) return t.b;
  const float part = u.y * whole;
  const float scale = whole > 0.0 ? sqrt(u.y * (2.0 - part) / (2.0 - whole)) : 0.0;
  return normalize((1.0 - part) * t.b + scale * (across + whole * t.b));
}

#endif
