// Running mean with a sum of two floats: D. E. Knuth, The Art of Computer Programming vol. 2, 4.2.2 (TwoSum), and
// T. J. Dekker, "A floating-point technique for extending the available precision", 1971 (FastTwoSum).
// `precise` keeps the compiler from simplifying the error terms to zero.
// A frame that isn't finite leaves a mean that isn't either, so that it shows, until the history is cleared; a mean
// with a limit forgets, so it starts anew instead.

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

bool isFinite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const vec4 color = imageLoad(in_color, ivec2(pixel));
  MeanState s = in_history[index];
  if (param_limit > 0) {
    const bool lost = !isFinite(s.highR + s.highG + s.highB);
    if (lost) s = MeanState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    // The sum as if one frame fewer had brought the same mean.
    const float most = float(param_limit - 1);
    if (s.count > most) {
      const float keep = most / s.count;
      s.highR *= keep;
      s.highG *= keep;
      s.highB *= keep;
      s.lowR *= keep;
      s.lowG *= keep;
      s.lowB *= keep;
      s.count = most;
    }
  }
  addTo(s.highR, s.lowR, color.r);
  addTo(s.highG, s.lowG, color.g);
  addTo(s.highB, s.lowB, color.b);
  s.count += 1.0;
  out_state[index] = s;
  imageStore(out_color, ivec2(pixel), vec4(vec3(s.highR, s.highG, s.highB) / s.count, color.a));
}
