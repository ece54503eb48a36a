#include "bsdf_sample.glsl"

Surface surfaceOf(Lobe lobe) {
  Surface s;
  s.position = vec3(0.0);
  s.normal = vec3(lobe.nx, lobe.ny, lobe.nz);
  s.geometricNormal = s.normal;
  s.view = vec3(lobe.vx, lobe.vy, lobe.vz);
  s.diffuse = vec3(lobe.diffuse);
  s.f0 = vec3(lobe.f0);
  s.alpha = lobe.alpha;
  s.distance = 1.0;
  s.error = 0.0;
  finishSurface(s);
  return s;
}
