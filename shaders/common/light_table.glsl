// Builds an alias table from powers in parallel, each cell by itself (after Hübschle-Schneider and Sanders 2019, "Parallel Weighted Random
// Sampling", and Lehmann et al. 2021, "Weighted Random Sampling on GPUs"; framework/execute/light_table.h).
//
// With x = n · power / sum, lights of x < 1 ("low") keep their cell for as much and leave the rest of it to a light of x >= 1 ("high"). Walk
// through both in order: low light i lacks d_i, so that D_i = Σ d is what has been lacking up to it; high light j has x_j - 1 to give, up
// to it E_j = Σ (x - 1). Low light i is then filled by the first j with E_j > D_{i-1}; and j, when D passes E_j by o_j <= 1, keeps 1 - o_j
// of its own cell and leaves o_j to j + 1. So every cell needs one binary search.
//
// Sums are integers in units of 2^-SHIFT: they don't depend on the order of adding. Thresholds are floats; what they really leave over is
// what is added up, and E is scaled to end where D ends: no light inherits the rounding of a million others.
//
// STAGE: 0 sum of a group, 1 sum of all, 2 parts of a group, 3 parts before each group, 4 ranks, sums and low thresholds, 5 cells.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

layout(local_size_x = 256) in;
const uint kThreads = 256u, kItems = 8u, kGroup = kThreads * kItems;

struct Cell { float threshold; uint alias; };
// What stands before a light: low ones, and in units what the coarse and the fine ones of them lack and what high ones give.
struct Part { uint64_t coarse, fine, gives; uint low, pad; };

layout(set = 0, binding = 0, std430) readonly buffer PowerBlock { float powers[]; };
layout(set = 0, binding = 1, std430) writeonly buffer CellBlock { Cell cells[]; };
layout(set = 0, binding = 2, std430) writeonly buffer PdfBlock { float pdfs[]; };
layout(set = 0, binding = 3, std430) buffer SumBlock { double sums[]; };    // by group; then n over the sum of all, 0: no light
layout(set = 0, binding = 4, std430) buffer PartBlock { Part parts[]; };    // by group; then of all
layout(set = 0, binding = 5, std430) buffer StepBlock { uint64_t steps[]; };  // D of low lights by rank, then E of high ones
layout(set = 0, binding = 6, std430) buffer OrderBlock { uint order[]; };     // lights likewise
layout(push_constant) uniform Push { uint count, groups, shift, pdfStride, pdfOffset; };

// Powers that are no number of a power's kind shine for nothing.
float powerOf(uint light) {
  const float p = light < count ? powers[light] : 0.0;
  return p > 0.0 && !isinf(p) ? p : 0.0;
}

uint64_t whole() { return uint64_t(1) << shift; }

Part nothing() { return Part(uint64_t(0), uint64_t(0), uint64_t(0), 0u, 0u); }
Part plus(Part a, Part b) { return Part(a.coarse + b.coarse, a.fine + b.fine, a.gives + b.gives, a.low + b.low, 0u); }

#if STAGE == 0 || STAGE == 1
shared double partial[kThreads];
double total(double mine) {
  const uint t = gl_LocalInvocationIndex;
  partial[t] = mine;
  barrier();
  for (uint width = kThreads / 2u; width > 0u; width /= 2u) {
    if (t < width) partial[t] += partial[t + width];
    barrier();
  }
  return partial[0];
}
#endif

#if STAGE >= 2
// x of a light; the same in every stage.
double share(uint light) {
  precise double x = double(powerOf(light)) * sums[groups];
  return x;
}
float fineThreshold(double x) { return float(x); }

Part partOf(uint light) {
  Part p = nothing();
  if (light >= count) return p;
  precise double x = share(light);
  precise double units = double(whole());
  if (x >= 1.0) {
    p.gives = uint64_t((x - 1.0) * units + 0.5);
    return p;
  }
  p.low = 1u;
  // From 1/2 up thresholds are multiples of 2^-24, and sums of what they lack are rounded to that instead of each by itself.
  if (x >= 0.5) {
    precise double lacks = (1.0 - x) * units + 0.5;
    p.coarse = uint64_t(lacks);
  } else {
    precise double kept = double(fineThreshold(x)) * units + 0.5;
    p.fine = whole() - uint64_t(kept);
  }
  return p;
}
#endif

#if STAGE == 2 || STAGE == 3 || STAGE == 4
shared Part scanned[kThreads];
// Of the threads before this one; `all`: of the group.
Part before(Part mine, out Part all) {
  const uint t = gl_LocalInvocationIndex;
  scanned[t] = mine;
  barrier();
  for (uint distance = 1u; distance < kThreads; distance *= 2u) {
    Part sum = scanned[t];
    if (t >= distance) sum = plus(scanned[t - distance], sum);
    barrier();
    scanned[t] = sum;
    barrier();
  }
  all = scanned[kThreads - 1u];
  return t > 0u ? scanned[t - 1u] : nothing();
}
#endif

#if STAGE == 0
void main() {
  const uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  if (group >= groups) return;
  double sum = 0.0;
  for (uint k = 0u; k < kItems; ++k) sum += double(powerOf(group * kGroup + k * kThreads + gl_LocalInvocationIndex));
  sum = total(sum);
  if (gl_LocalInvocationIndex == 0u) sums[group] = sum;
}
#elif STAGE == 1
void main() {
  double sum = 0.0;
  for (uint g = gl_LocalInvocationIndex; g < groups; g += kThreads) sum += sums[g];
  sum = total(sum);
  if (gl_LocalInvocationIndex == 0u) sums[groups] = sum > 0.0 ? double(count) / sum : 0.0;
}
#elif STAGE == 2
void main() {
  const uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  if (group >= groups) return;
  Part mine = nothing(), all;
  for (uint k = 0u; k < kItems; ++k) mine = plus(mine, partOf(group * kGroup + gl_LocalInvocationIndex * kItems + k));
  before(mine, all);
  if (gl_LocalInvocationIndex == 0u) parts[group] = all;
}
#elif STAGE == 3
void main() {
  const uint each = (groups + kThreads - 1u) / kThreads, first = gl_LocalInvocationIndex * each;
  Part mine = nothing(), all;
  for (uint g = first; g < min(first + each, groups); ++g) mine = plus(mine, parts[g]);
  Part sum = before(mine, all);
  for (uint g = first; g < min(first + each, groups); ++g) {
    const Part part = parts[g];
    parts[g] = sum;
    sum = plus(sum, part);
  }
  if (gl_LocalInvocationIndex == 0u) parts[groups] = all;
}
#elif STAGE == 4
// To a multiple of 2^-24.
uint64_t rounded(uint64_t units) { return (units >> (shift - 24u)) << (shift - 24u); }

void main() {
  const uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  if (group >= groups) return;
  const uint first = group * kGroup + gl_LocalInvocationIndex * kItems;
  Part mine = nothing(), all;
  for (uint k = 0u; k < kItems; ++k) mine = plus(mine, partOf(first + k));
  Part sum = plus(parts[group], before(mine, all));
  const uint lowLights = parts[groups].low;
  for (uint light = first; light < min(first + kItems, count); ++light) {
    const Part part = partOf(light);
    const Part after = plus(sum, part);
    if (part.low == 1u) {
      const uint rank = sum.low;
      const uint64_t lacked = rounded(after.coarse) - rounded(sum.coarse);
      const float threshold = part.fine > uint64_t(0) ? fineThreshold(share(light))
                                                      : float(uint((whole() - lacked) >> (shift - 24u))) * (1.0 / 16777216.0);
      cells[light].threshold = threshold;
      pdfs[light * pdfStride + pdfOffset] = threshold / float(count);
      steps[rank] = rounded(after.coarse) + after.fine;
      order[rank] = light;
    } else {
      const uint rank = lowLights + light - sum.low;
      steps[rank] = after.gives;
      order[rank] = light;
    }
    sum = after;
  }
}
#elif STAGE == 5
uint lowLights, highLights;
uint64_t lacking;  // D of all
double scale;      // that takes E of all to it

uint64_t giving(uint rank) {
  if (rank + 1u == highLights) return lacking;
  precise double scaled = double(steps[lowLights + rank]) * scale + 0.5;
  return min(uint64_t(scaled), lacking);
}

void main() {
  const uint rank = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * kThreads;
  if (rank >= count) return;
  lowLights = parts[groups].low;
  highLights = count - lowLights;
  lacking = lowLights > 0u ? steps[lowLights - 1u] : uint64_t(0);
  const uint64_t gives = parts[groups].gives;
  scale = gives > uint64_t(0) ? double(lacking) / double(gives) : 1.0;
  const uint light = order[rank];
  if (highLights == 0u) {  // all alike, or all dark
    cells[light] = Cell(1.0, light);
    pdfs[light * pdfStride + pdfOffset] = 1.0 / float(count);
    return;
  }
  if (rank < lowLights) {
    const uint64_t lackedBefore = rank > 0u ? steps[rank - 1u] : uint64_t(0);
    uint low = 0u, high = highLights - 1u;  // the first that gives more
    while (low < high) {
      const uint middle = (low + high) / 2u;
      if (giving(middle) > lackedBefore) high = middle;
      else low = middle + 1u;
    }
    cells[light].alias = order[lowLights + low];
    return;
  }
  const uint mine = rank - lowLights;
  const uint64_t given = giving(mine);
  uint64_t over = uint64_t(0);
  if (given > uint64_t(0) && mine + 1u < highLights) {
    uint low = 0u, high = lowLights - 1u;  // the first that lacks as much
    while (low < high) {
      const uint middle = (low + high) / 2u;
      if (steps[middle] >= given) high = middle;
      else low = middle + 1u;
    }
    over = steps[low] - given;
  }
  const double unit = 1.0 / double(whole());
  cells[light] = Cell(float(1.0 - double(over) * unit), mine + 1u < highLights ? order[rank + 1u] : light);
  const uint64_t givenBefore = mine > 0u ? giving(mine - 1u) : uint64_t(0);
  pdfs[light * pdfStride + pdfOffset] = float((1.0 + double(given - givenBefore) * unit) / double(count));
}
#endif
