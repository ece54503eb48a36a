// Which values a port holds: the picture is shared out among cells, and each says its smallest and largest number, how many pixels are
// finite and not, and one of its values, so that the host can tell percentiles. Cells of one pixel tell the values themselves.
#include "settings.glsl"
#include "read.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

struct Cell {
  float value[3];
  uint word;
  float low, high;
  uint finite, others;  // pixels; those with nothing to say are neither
};
layout(std430, set = 0, binding = 2) writeonly buffer Cells { Cell cells[]; };

float component(Value v, uint c) {
  if (settings.shows == kDirection) return length(v.number.xy);
  return settings.shows == kNumber ? v.number.x : v.number[c];
}

void main() {
  const uvec2 id = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(id, settings.clipSize))) return;
  const uvec2 first = id * settings.extent / settings.clipSize, last = (id + 1u) * settings.extent / settings.clipSize;
  const uint pixels = (last.x - first.x) * (last.y - first.y);
  const uint wanted = (id.y * settings.clipSize.x + id.x) * 2654435769u >> 8u;
  const uint chosen = pixels > 0u ? wanted % pixels : 0u;
  const uint components = settings.shows == kColor ? 3u : 1u;
  Cell cell = Cell(float[3](0.0, 0.0, 0.0), 0u, 0.0, 0.0, 0u, 0u);
  uint seen = 0u;
  bool taken = false;
  for (uint y = first.y; y < last.y; ++y) {
    for (uint x = first.x; x < last.x; ++x, ++seen) {
      const Value v = valueAt(uvec2(x, y));
      if (!v.there) continue;
      bool finite = true;
      for (uint c = 0u; c < components; ++c) finite = finite && isFinite(component(v, c));
      // The chosen pixel, or the first one after it that has a value; else the last one before.
      if (finite && (!taken || seen <= chosen)) {
        for (int c = 0; c < 3; ++c) cell.value[c] = component(v, uint(c));
        cell.word = v.word;
        taken = seen >= chosen;
      }
      if (!finite) {
        ++cell.others;
        continue;
      }
      for (uint c = 0u; c < components; ++c) {
        const float value = component(v, c);
        cell.low = cell.finite == 0u && c == 0u ? value : min(cell.low, value);
        cell.high = cell.finite == 0u && c == 0u ? value : max(cell.high, value);
      }
      ++cell.finite;
    }
  }
  cells[id.y * settings.clipSize.x + id.x] = cell;
}
