// The pinhole camera of this frame and of the last one.
#ifndef WEIR_CAMERA
#define WEIR_CAMERA

// Direction through a point of the picture, in pixels from the top left; unit length.
vec3 cameraDirection(Camera camera, vec2 point, vec2 size) {
  const vec2 ndc = point / size * 2.0 - 1.0;
  return normalize(camera.forward.xyz + ndc.x * camera.right.xyz - ndc.y * camera.up.xyz);
}

// Where a world position lies in the picture, in pixels; z > 0 in front of the camera.
vec3 cameraProject(Camera camera, vec3 position, vec2 size) {
  const vec3 d = position - camera.origin.xyz;
  const float z = dot(d, camera.forward.xyz);
  const float x = dot(d, camera.right.xyz) / dot(camera.right.xyz, camera.right.xyz);
  const float y = dot(d, camera.up.xyz) / dot(camera.up.xyz, camera.up.xyz);
  return vec3((vec2(x, -y) / z * 0.5 + 0.5) * size, z);
}

#endif
