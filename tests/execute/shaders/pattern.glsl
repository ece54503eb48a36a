// Checks every element of every input against what its producer must have written, then writes a pattern of its own:
// numbers that follow from the output, the frame and the element. tests/execute/pattern_passes.h has the host's half.
// Ports are named by what they carry: u an image of 32-bit numbers, f floats at half size, c bytes at a quarter, w a
// buffer of words, m one of three words for each pixel of half size.
#ifdef CAN_TRACE
#include "trace.glsl"
#endif

uint stir(uint x) {
  x = (x ^ (x >> 16u)) * 0x7feb352du;
  x = (x ^ (x >> 15u)) * 0x846ca68bu;
  return x ^ (x >> 16u);
}
uint valueOf(uint key, uint frame, uint element) { return stir(key + 0x9e3779b9u * frame + 0x85ebca6bu * element); }
uint keyOf(uint port) { return stir(uint(param_salt) * 16u + port); }

float asFloat(uint v) { return float(v & 0xffffffu); }
uvec4 asBytes(uint v) { return uvec4(v, v >> 8u, v >> 16u, v >> 24u) & 255u; }

// Runs `body` for this invocation's elements of a resource with so many for each pixel of the frame's size by `scale`.
// They lie at the other end of it from the invocation's own place: what others wrote is read.
#define EACH(scale, count, body)                                                          \
  {                                                                                       \
    const uvec2 extent = (uvec2(frameWidth, frameHeight) + (scale - 1u)) / (scale);       \
    if (all(lessThan(id, extent)))                                                        \
      for (uint k = 0u; k < (count); ++k) {                                               \
        const uint n = extent.x * extent.y * (count);                                     \
        const uint i = n - 1u - ((id.y * extent.x + id.x) * (count) + k);                 \
        const ivec2 at = ivec2(i % extent.x, i / extent.x);                               \
        body                                                                              \
      }                                                                                   \
  }
// `got` must be `wanted`, a function of v, or `empty` where there is no frame before.
#define CHECK(scale, count, got, wanted, empty, key, previous)                            \
  EACH(scale, count, {                                                                    \
    const uint v = valueOf(uint(key), frameIndex - ((previous) ? 1u : 0u), i);            \
    const bool right = (previous) && frameIndex == 0u ? (got) == (empty) : (got) == (wanted); \
    ++faults.checked;                                                                     \
    if (!right) ++faults.wrong;                                                           \
  })

void run(uvec2 id) {
  Faults faults = Faults(0u, 0u);
#ifdef FIRST_HALF
  // What is checked goes on with the second half, through memory.
  EACH(1u, 1u, { scratch_words[i].value = valueOf(keyOf(8u), frameIndex, i); })
  EACH(2u, 1u, { imageStore(scratch_image, at, uvec4(valueOf(keyOf(9u), frameIndex, i))); })
#endif
#ifdef SECOND_HALF
  const uint own = id.y * frameWidth + id.x;
  faults = out_faults[own];
  CHECK(1u, 1u, scratch_words[i].value, v, v, keyOf(8u), false)
  CHECK(2u, 1u, imageLoad(scratch_image, at).x, v, v, keyOf(9u), false)
#else
  const uint own = id.y * frameWidth + id.x;
  faults = in_before[own];
#ifdef has_in_u0
  CHECK(1u, 1u, imageLoad(in_u0, at).x, v, 0u, param_key_u0, param_old_u0)
#endif
#ifdef has_in_u1
  CHECK(1u, 1u, imageLoad(in_u1, at).x, v, 0u, param_key_u1, param_old_u1)
#endif
#ifdef has_in_f0
  CHECK(2u, 1u, imageLoad(in_f0, at).x, asFloat(v), 0.0, param_key_f0, param_old_f0)
#endif
#ifdef has_in_c0
  CHECK(4u, 1u, uvec4(round(imageLoad(in_c0, at) * 255.0)), asBytes(v), uvec4(0u), param_key_c0, param_old_c0)
#endif
#ifdef has_in_w0
  CHECK(1u, 1u, in_w0[i].value, v, 1000u, param_key_w0, param_old_w0)
#endif
#ifdef has_in_w1
  CHECK(1u, 1u, in_w1[i].value, v, 1000u, param_key_w1, param_old_w1)
#endif
#ifdef has_in_m0
  CHECK(2u, 3u, in_m0[i].value, v, 1000u, param_key_m0, param_old_m0)
#endif
#endif
#ifdef has_scratch_drawn
  // The scene is a square of two triangles that fills the picture.
  EACH(1u, 1u, { ++faults.checked; if (imageLoad(scratch_drawn, at).x > 1u) ++faults.wrong; })
#endif
#ifdef CAN_TRACE
  // One ray through the middle of the square, one that ends before it.
  faults.checked += 2u;
  if (traceTransmittance(vec3(0.2, 0.1, 1.0), vec3(0, 0, -1), 2.0) > 0.0) ++faults.wrong;
  if (traceTransmittance(vec3(0.2, 0.1, 1.0), vec3(0, 0, -1), 0.5) < 1.0) ++faults.wrong;
#endif
  out_faults[own] = faults;
#ifndef FIRST_HALF
#ifdef has_out_u
  EACH(1u, 1u, { imageStore(out_u, at, uvec4(valueOf(keyOf(0u), frameIndex, i))); })
#endif
#ifdef has_out_f
  EACH(2u, 1u, { imageStore(out_f, at, vec4(asFloat(valueOf(keyOf(1u), frameIndex, i)))); })
#endif
#ifdef has_out_c
  EACH(4u, 1u, { imageStore(out_c, at, vec4(asBytes(valueOf(keyOf(2u), frameIndex, i))) / 255.0); })
#endif
#ifdef has_out_w
  EACH(1u, 1u, { out_w[i].value = valueOf(keyOf(3u), frameIndex, i); })
#endif
#ifdef has_out_m
  EACH(2u, 3u, { out_m[i].value = valueOf(keyOf(4u), frameIndex, i); })
#endif
#endif
}
