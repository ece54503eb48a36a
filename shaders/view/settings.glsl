// What the host says of a picture of a port: sandbox/view/picture/settings.h has the same struct and numbers.
#extension GL_EXT_shader_image_load_formatted : require
#ifndef WEIR_VIEW_SETTINGS
#define WEIR_VIEW_SETTINGS

// As the prelude of graph kernels declares it.
struct Camera { vec4 origin, forward, right, up; };

struct Settings {
  Camera camera;        // of the frame that the port is of
  vec2 place, scale;    // where its top left corner lies on the canvas; canvas pixels for a pixel of it
  ivec2 clip;           // of the canvas this part alone is drawn
  uvec2 clipSize;       // measuring: number of cells
  uvec2 extent;         // pixels of the port; of a buffer without any: columns and rows of its elements
  uint elements;        // of a buffer
  uint perPixel, element, stride;  // which element of each pixel's; words of one
  uint code, word;      // which value, as the reader at hand counts them; where in the element it starts
  uint shows, flags;
  float low, high, gain;
  uint background;      // RGBA8, around the port
};

const uint kNumber = 0u, kColor = 1u, kDirection = 2u, kLabel = 3u, kState = 4u;
const uint kFalseColor = 1u, kLogarithmic = 2u, kEncoded = 4u, kMarkRange = 8u, kBox = 16u, kAbsolute = 32u, kSigned = 64u;

layout(std430, set = 0, binding = 1) readonly buffer SettingsBlock { Settings settings; };

// One value of a port: numbers, or a word that names something. `there` is false where the port has nothing to say: no surface,
// no sample.
struct Value {
  vec3 number;
  uint word;
  bool there;
};

Value numberOf(float x) { return Value(vec3(x), 0u, true); }
Value colorOf(vec3 c) { return Value(c, 0u, true); }
Value wordOf(uint w) { return Value(vec3(w), w, true); }
Value nothing() { return Value(vec3(0.0), 0u, false); }

// By the bits: compilers may take floats for finite.
bool isFinite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }

float luminanceOf(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

#endif
