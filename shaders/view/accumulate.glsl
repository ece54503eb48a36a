// Adds a frame to a running mean and to the sum of squared deviations from it, each kept in two floats so that a million
// frames lose nothing. Sums: D. E. Knuth, The Art of Computer Programming vol. 2, 4.2.2 (TwoSum), and T. J. Dekker,
// "A floating-point technique for extending the available precision", 1971 (FastTwoSum). Deviations: B. P. Welford,
// "Note on a method for calculating corrected sums of squares and products", 1962.
// A frame that isn't finite leaves a mean that isn't either, so that it shows, until it all starts over.
#extension GL_EXT_shader_image_load_formatted : require
layout(local_size_x = 8, local_size_y = 8) in;

struct Sums {
  vec4 high, low;   // rgb: of radiance; a: the low part of squares.r, and of squares.g
  vec4 squares;     // rgb: of deviations; a: the low part of squares.b
};
layout(set = 0, binding = 0) readonly uniform image2D frame;
layout(set = 0, binding = 1, std430) buffer SumsOfPixels { Sums sums[]; };
layout(set = 0, binding = 2, rgba32f) writeonly uniform image2D mean;
layout(push_constant) uniform Push {
  uvec2 size;
  uint count;     // of frames, with this one; 1: what was there is forgotten
  float epsilon;  // of relMSE
};

// sum + value, exactly, as high + low.
void addTo(inout float high, inout float low, float value) {
  precise const float sum = high + value;
  precise const float part = sum - high;
  precise const float error = (high - (sum - part)) + (value - part);
  precise const float rest = low + error;
  precise const float total = sum + rest;
  precise const float left = rest - (total - sum);
  high = total;
  low = left;
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= size.x || pixel.y >= size.y) return;
  const uint index = pixel.y * size.x + pixel.x;
  const vec4 color = imageLoad(frame, ivec2(pixel));
  Sums s = Sums(vec4(0), vec4(0), vec4(0));
  if (count > 1u) s = sums[index];
  const float n = float(count);
  float squaresLow[3] = float[3](s.high.a, s.low.a, s.squares.a);
  float error = 0.0;
  vec3 now;
  for (int c = 0; c < 3; ++c) {
    const float before = count > 1u ? s.high[c] / (n - 1.0) : color[c];
    addTo(s.high[c], s.low[c], color[c]);
    now[c] = s.high[c] / n;
    addTo(s.squares[c], squaresLow[c], (color[c] - before) * (color[c] - now[c]));
    // Of the mean: its variance, in the measure of relMSE.
    if (count > 1u) error += max(s.squares[c], 0.0) / (n * (n - 1.0)) / (now[c] * now[c] + epsilon);
  }
  s.high.a = squaresLow[0];
  s.low.a = squaresLow[1];
  s.squares.a = squaresLow[2];
  sums[index] = s;
  imageStore(mean, ivec2(pixel), vec4(now, error / 3.0));
}
