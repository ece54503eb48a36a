// Light from all around (framework/scene/environment.h): radiance by direction, and directions picked from its table. Only in scenes
// with the trait SCENE_ENVIRONMENT and for passes that need scene.environment or scene.lights.
//
// A place on the environment is a cell of the table and a position in it, 16 bits a side: column · steps + step, with as many steps a
// cell as 16 bits allow. Within a cell they are evenly spread in longitude and in the cosine of latitude, so that places of one cell
// stand for equal solid angles, and the density of what is picked is exactly that of its cell.
#ifndef WEIR_ENVIRONMENT
#define WEIR_ENVIRONMENT

#include "mutants.glsl"
#include "random_bits.glsl"

const float kEnvironmentPi = 3.14159265358979;

// nit from texture coordinates.
vec3 environmentAt(vec2 uv) { return textureLod(sceneEnvironmentMap, uv, 0.0).rgb * sceneEnvironment.unit; }

vec2 environmentUv(vec3 direction) {
  const float across = length(direction.xz);
  const float longitude = across > 0.0 ? atan(direction.x, -direction.z) : 0.0;
  return vec2(0.5 + (longitude + sceneEnvironment.rotation) / (2.0 * kEnvironmentPi), atan(across, direction.y) / kEnvironmentPi);
}

// nit from a unit direction.
vec3 environmentRadiance(vec3 direction) { return environmentAt(environmentUv(direction)); }

struct EnvironmentPoint {
  vec3 direction;
  vec2 uv;
};

uvec2 environmentSteps() { return 65536u / uvec2(sceneEnvironment.columns, sceneEnvironment.rows); }

EnvironmentPoint environmentPoint(uint place) {
  const uvec2 code = uvec2(place & 0xffffu, place >> 16u), steps = environmentSteps();
  const uvec2 cell = min(code / steps, uvec2(sceneEnvironment.columns, sceneEnvironment.rows) - 1u);
  const vec2 part = (vec2(min(code - cell * steps, steps - 1u)) + 0.5) / vec2(steps);
  const vec2 size = vec2(sceneEnvironment.width, sceneEnvironment.height);
  const vec2 low = vec2(cell * sceneEnvironment.block) / size;
  const vec2 high = min(vec2((cell + 1u) * sceneEnvironment.block) / size, vec2(1.0));

  EnvironmentPoint p;
  p.uv.x = mix(low.x, high.x, part.x);
  // Uniform in the cosine of the angle θ from the nearer pole, by way of sin²(θ/2), which keeps its precision there.
  const bool south = low.y + high.y > 1.0;
  const vec2 ends = south ? 1.0 - vec2(high.y, low.y) : vec2(low.y, high.y);
  const vec2 halfSine = sin(ends * (0.5 * kEnvironmentPi));
  const float along = south ? 1.0 - part.y : part.y;
  const float square = mix(halfSine.x * halfSine.x, halfSine.y * halfSine.y, MUTANT(49, along * along, along));
  const float fromPole = atan(sqrt(square), sqrt(1.0 - square)) * (2.0 / kEnvironmentPi);
  p.uv.y = south ? 1.0 - fromPole : fromPole;
  const float sine = 2.0 * sqrt(square * (1.0 - square)), cosine = 1.0 - 2.0 * square;
  const float longitude = (p.uv.x - 0.5) * (2.0 * kEnvironmentPi) - sceneEnvironment.rotation;
  p.direction = vec3(sine * sin(longitude), south ? -cosine : cosine, -sine * cos(longitude));
  return p;
}

// The place that stands for a direction: environmentPoint()'s inverse.
uint environmentPlace(vec3 direction) {
  const uvec2 cells = uvec2(sceneEnvironment.columns, sceneEnvironment.rows), steps = environmentSteps();
  const vec2 size = vec2(sceneEnvironment.width, sceneEnvironment.height);
  vec2 uv = environmentUv(direction);
  uv.x -= floor(uv.x);
  const uvec2 cell = min(uvec2(uv * size) / sceneEnvironment.block, cells - 1u);
  const vec2 low = vec2(cell * sceneEnvironment.block) / size;
  const vec2 high = min(vec2((cell + 1u) * sceneEnvironment.block) / size, vec2(1.0));
  const bool south = low.y + high.y > 1.0;
  const vec2 ends = south ? 1.0 - vec2(high.y, low.y) : vec2(low.y, high.y);
  const vec2 halfSine = sin(ends * (0.5 * kEnvironmentPi)), squares = halfSine * halfSine;
  // sin²(θ/2) by whichever of its two forms keeps its precision.
  const float y = south ? -direction.y : direction.y;
  const float square = y > 0.0 ? dot(direction.xz, direction.xz) / (2.0 * (1.0 + y)) : 0.5 * (1.0 - y);
  const float row = (square - squares.x) / (squares.y - squares.x);
  const vec2 part = clamp(vec2((uv.x - low.x) / (high.x - low.x), south ? 1.0 - row : row), 0.0, 1.0);
  const uvec2 code = cell * steps + min(uvec2(part * vec2(steps)), steps - 1u);
  return code.x | (code.y << 16u);
}

// Density with which pickEnvironment() finds a place, per steradian.
float environmentDensity(uint place) {
  const uvec2 cells = uvec2(sceneEnvironment.columns, sceneEnvironment.rows);
  const uvec2 cell = min(uvec2(place & 0xffffu, place >> 16u) / environmentSteps(), cells - 1u);
  const float spread = sceneEnvironment.cells[cell.y * cells.x + cell.x].spread;
  return spread > 0.0 ? 1.0 / spread : 0.0;
}

// Picks a place from uniform bits; `spread` is 1 / its density, steradian.
uint pickEnvironment(uvec4 bits, out float spread) {
  uint cell = scaleBits(bits.x, sceneEnvironment.columns * sceneEnvironment.rows);
  if (!(unitFromBits(bits.y) < sceneEnvironment.cells[cell].threshold)) cell = sceneEnvironment.cells[cell].alias;
  spread = sceneEnvironment.cells[cell].spread;
  const uvec2 steps = environmentSteps();
  const uvec2 code = uvec2(cell % sceneEnvironment.columns, cell / sceneEnvironment.columns) * steps +
                     uvec2(scaleBits(bits.z, steps.x), scaleBits(bits.w, steps.y));
  return code.x | (code.y << 16u);
}

#endif
