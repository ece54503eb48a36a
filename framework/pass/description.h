// What a pass says of itself, statically: ports, parameters, and what it takes from scene and frame. This one
// description yields the graph's validation, the shader's bindings, `weir passes`, the JSON Schema and the generated
// documentation.
#pragma once

#include <weir/core/text.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace weir {

// ---------------------------------------------------------------------------------------------------- layouts

/// One field of a structured buffer's element, as LayoutOf declares it: GLSL type (float, uint, int, vec2, uvec4, …)
/// and name.
struct Field {
  const char* type;
  const char* name;
};

/// The same in a Layout, which owns its texts: a description outlives the library that it came from.
struct LayoutField {
  std::string type;
  std::string name;
};

/// The layout of a buffer element, shared by host and shader: the GLSL struct is generated from it.
/// Two ports can be connected when name, version, stride and hash agree.
struct Layout {
  std::string name;
  uint32_t version = 1;
  uint32_t stride = 0;     ///< bytes, by std430's rules
  uint64_t hash = 0;       ///< FNV-1a of name, version and fields
  uint32_t emptyWord = 0;  ///< 32-bit pattern that an unwritten history is filled with
  std::vector<LayoutField> fields;
  std::string glsl() const;  ///< "struct Name { … };"
};

/// Specialise for a host struct: `static constexpr const char* name; static constexpr uint32_t version;
/// static constexpr std::array<Field, N> fields; static constexpr uint32_t emptyWord;`
template <typename T>
struct LayoutOf;

/// Stride of a std430 array of a struct with these fields, in bytes; 0 for an unknown type.
constexpr uint32_t std430Stride(const Field* fields, size_t count) {
  constexpr struct {
    std::string_view type;
    uint32_t size, align;
  } kTypes[] = {{"float", 4, 4},  {"uint", 4, 4},    {"int", 4, 4},    {"vec2", 8, 8},
                {"uvec2", 8, 8},  {"ivec2", 8, 8},   {"vec3", 12, 16}, {"uvec3", 12, 16},
                {"vec4", 16, 16}, {"uvec4", 16, 16}, {"ivec4", 16, 16}};
  uint32_t offset = 0, align = 4;
  for (size_t i = 0; i < count; ++i) {
    bool known = false;
    for (const auto& t : kTypes) {
      if (t.type != fields[i].type) continue;
      offset = (offset + t.align - 1) / t.align * t.align + t.size;
      align = t.align > align ? t.align : align;
      known = true;
    }
    if (!known) return 0;
  }
  return (offset + align - 1) / align * align;
}

/// Assembles a Layout; the hash covers name, version and every field.
Layout makeLayout(const char* name, uint32_t version, uint32_t emptyWord, const Field* fields, size_t count);

template <typename T>
Layout layoutOf() {
  using L = LayoutOf<T>;
  static_assert(std430Stride(L::fields.data(), L::fields.size()) == sizeof(T), "host and shader layouts differ");
  return makeLayout(L::name, L::version, L::emptyWord, L::fields.data(), L::fields.size());
}

// ------------------------------------------------------------------------------------------------------ ports

enum class Format : uint8_t { R32F, RG32F, RGBA32F, RGBA16F, RGBA8, R32U };
const char* formatName(Format format);
uint32_t formatBytes(Format format);

enum class PortKind : uint8_t { Buffer, Image };

/// What a port carries: a storage buffer of structs or a storage image, sized relative to the frame.
struct PortType {
  PortKind kind = PortKind::Buffer;
  Layout layout;                                      ///< buffers
  Format format = Format::RGBA32F;                    ///< images
  uint32_t scaleNumerator = 1, scaleDenominator = 1;  ///< of the frame's width and height, rounded up
  uint32_t fixedCount = 0;                            ///< buffers: this many elements, whatever the frame; 0: per pixel
  /// Elements a pixel: a constant, the value of an integer parameter, or the count of one of the pass's inputs.
  uint32_t perPixel = 1;
  std::string perPixelFromParam, perPixelFromInput;
  bool anyPerPixel = false;  ///< inputs: whatever count arrives
};

/// A buffer with one T (or more: see the modifiers below) for each pixel.
template <typename T>
PortType perPixel() {
  PortType t;
  t.layout = layoutOf<T>();
  return t;
}
/// A buffer of `count` T, whatever the frame's size.
template <typename T>
PortType fixedBuffer(uint32_t count) {
  PortType t;
  t.layout = layoutOf<T>();
  t.fixedCount = count;
  return t;
}
/// A storage image of the frame's size.
PortType storageImage(Format format);

/// How an image's numbers are meant; a PNG encodes radiance and writes display values as they are.
enum class Meaning : uint8_t { Data, Radiance, Display };

struct PortDescription {
  std::string name;
  PortType type;
  std::string doc;
  bool required = true;             ///< inputs: must be connected
  std::string passesThrough;        ///< outputs: the input that stands for this output when the pass is disabled
  bool absentWhenDisabled = false;  ///< outputs: then nothing does, and optional inputs that read it are left open
  Meaning meaning = Meaning::Data;
};

// ------------------------------------------------------------------------------------------------- parameters

using ParamValue = std::variant<bool, int32_t, float, std::string>;
enum class ParamType : uint8_t { Bool, Int, Float, Enum, String };
const char* paramTypeName(ParamType type);
std::string toText(const ParamValue& value);

struct ParamDescription {
  std::string name;
  ParamType type = ParamType::Float;
  ParamValue defaultValue;
  std::optional<double> low, high;   ///< inclusive
  std::vector<std::string> choices;  ///< Enum; its value on the GPU is the index
  std::string unit, doc;
  bool specialises = false;  ///< a specialisation constant: the pipeline is rebuilt when it changes
};

// ----------------------------------------------------------------------------------------- scene and frame data

/// What a pass may take from outside the graph. Nothing that is not declared can be reached from its shaders.
enum class Need : uint8_t {
  SceneGeometry,      ///< triangles, vertices, instances
  SceneMaterials,     ///< materials and textures
  SceneLights,        ///< light table and alias table, and the environment
  SceneEnvironment,   ///< radiance from beyond the scene
  SceneAcceleration,  ///< rays: closest hit and occlusion
  FrameCamera,
  FrameIndex,  ///< frame number and seed, so: random numbers
  Count
};
const char* needName(Need need);  ///< "scene.geometry", …
std::optional<Need> needFromName(std::string_view name);

struct NeedDescription {
  Need need;
  bool previous = false;  ///< "…@previous": also as it was in the last frame
};

// ------------------------------------------------------------------------------------------------ description

class PassDescription {
 public:
  class Port {
   public:
    explicit Port(PortDescription& d) : d_(d) {}
    Port& doc(std::string text);
    Port& optional();                        ///< inputs
    Port& passesThrough(std::string input);  ///< outputs
    Port& absentWhenDisabled();              ///< outputs that pass nothing through
    Port& times(std::string intParam);       ///< outputs: elements a pixel = that parameter
    Port& countOf(std::string input);        ///< outputs: elements a pixel as in that input
    Port& anyCount();                        ///< inputs: any number of elements a pixel
    Port& scale(uint32_t numerator, uint32_t denominator);
    Port& radiance();  ///< linear Rec.709 radiance
    Port& display();   ///< display-referred, [0, 1]

   private:
    PortDescription& d_;
  };
  class Param {
   public:
    explicit Param(ParamDescription& d) : d_(d) {}
    Param& range(double low, double high);
    Param& oneOf(std::vector<std::string> choices);  ///< turns a text parameter into an Enum
    Param& unit(std::string text);
    Param& doc(std::string text);
    Param& specialises();

   private:
    ParamDescription& d_;
  };

  PassDescription& doc(std::string text);
  Port input(std::string name, PortType type);
  Port output(std::string name, PortType type);
  Param param(std::string name, bool value);
  Param param(std::string name, int value);
  Param param(std::string name, float value);
  Param param(std::string name, const char* value);
  PassDescription& needs(Need need);
  PassDescription& needsPrevious(Need need);
  PassDescription& rasterises();  ///< has a rasterKernel: asks for a queue that draws

  bool has(Need need, bool previous = false) const;
  const PortDescription* findInput(std::string_view name) const;
  const PortDescription* findOutput(std::string_view name) const;
  const ParamDescription* findParam(std::string_view name) const;

  /// Throws InputError when the description contradicts itself: a name twice, a default out of range,
  /// passesThrough or countOf naming no input, times naming no integer parameter. The registry calls it.
  void check() const;

  std::string type;  ///< "plugin.Pass", set by the registry
  std::string text;  ///< one line of documentation
  std::vector<PortDescription> inputs, outputs;
  std::vector<ParamDescription> params;
  std::vector<NeedDescription> wants;
  bool draws = false;  ///< rasterises()
};

/// Whether an output's resource can be read through an input, element counts aside (those are compared in the compiled
/// graph).
bool compatible(const PortType& output, const PortType& input);
/// "Reservoir v1 (16 bytes, hash 0x…)" or "image RGBA32F", for messages.
std::string describe(const PortType& type);

}  // namespace weir
