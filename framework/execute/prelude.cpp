#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/execute/prelude.h>
#include <weir/scene/upload.h>

#include <algorithm>
#include <bit>

namespace weir::execute {
namespace {

// Host sides: scene/prepared.h, scene/lights.h, scene/environment.h, scene/upload.h, execute/frame_constants.h.
constexpr const char* kStructs = R"(
struct Camera { vec4 origin, forward, right, up; };
struct Vertex { uint normal, tangent; vec2 uv; };
struct Instance { vec4 column0, column1, column2, column3; uint firstTriangle, opaqueTriangles, flipsWinding, firstDrawn; };
struct Material {
  vec4 baseColor; vec3 emission; float alphaCutoff; float metallic, roughness, normalScale; uint flags;
  int baseColorTexture, metallicRoughnessTexture, normalTexture, emissiveTexture;
};
struct Specular { vec3 f0; float weight; int colorTexture, weightTexture; uvec2 pad; };
struct TextureUse { vec4 linear; vec2 offset; uint uvSet; float texelLevel; };
struct Light { vec3 position; uint kind; vec3 radiance; float pdf; vec3 a; uint triangle; vec3 b; float area; };
struct AliasCell { float threshold; uint alias; };
layout(set = 0, binding = 0, std140) uniform FrameBlock {
  Camera camera, previousCamera;
  uint width, height, frame, seed, lights, instances;
  float diameter, nearPlane, largest, pad0, pad1, pad2;
} frameBlock;
#define frameWidth frameBlock.width
#define frameHeight frameBlock.height
#define frameSize vec2(frameBlock.width, frameBlock.height)
)";

const char* glslFormat(Format format) {
  switch (format) {
    case Format::R32F:
      return "r32f";
    case Format::RG32F:
      return "rg32f";
    case Format::RGBA32F:
      return "rgba32f";
    case Format::RGBA16F:
      return "rgba16f";
    case Format::RGBA8:
      return "rgba8";
    case Format::R32U:
      return "r32ui";
  }
  return "rgba32f";
}

std::string extensions(bool pipeline, bool query) {
  std::string s = "#version 460\n#extension GL_EXT_nonuniform_qualifier : require\n";
  if (pipeline) s += "#extension GL_EXT_ray_tracing : require\n";
  if (query) s += "#extension GL_EXT_ray_query : require\n";
  return s;
}

std::string buffer(uint32_t binding, const char* access, const char* type, const char* name) {
  return fmt::format("layout(set = 0, binding = {0}, std430) {1} buffer Block_{3} {{ {2} {3}[]; }};\n", binding, access,
                     type, name);
}

struct SceneParts {
  bool geometry = false, materials = false, lights = false, environment = false, acceleration = false;
  bool previousGeometry = false, previousLights = false, previousAcceleration = false;
};

// Alpha tests of rays read materials, and lights read emission textures: those come along.
SceneParts partsOf(const PassDescription& d, const scene::SceneTraits& traits) {
  SceneParts p;
  p.previousAcceleration = d.has(Need::SceneAcceleration, true);
  p.previousLights = d.has(Need::SceneLights, true);
  p.previousGeometry = d.has(Need::SceneGeometry, true);
  p.acceleration = d.has(Need::SceneAcceleration) || p.previousAcceleration;
  p.lights = d.has(Need::SceneLights) || p.previousLights;
  p.environment = traits.environment && (d.has(Need::SceneEnvironment) || p.lights);
  p.materials = d.has(Need::SceneMaterials) || p.lights || p.acceleration;
  p.geometry = d.has(Need::SceneGeometry) || p.materials || p.previousGeometry;
  return p;
}

/// Last frame's scene. What doesn't move is declared once: both names then mean the same data.
std::string previousDeclarations(const SceneParts& parts, const scene::SceneTraits& traits) {
  std::string s;
  if (parts.previousGeometry) {
    s += traits.deforms ? buffer(scene::kBindPreviousPositions, "readonly", "float", "scenePreviousPositions")
                        : "#define scenePreviousPositions scenePositions\n";
    s += traits.animated ? buffer(scene::kBindPreviousInstances, "readonly", "Instance", "scenePreviousInstances")
                         : "#define scenePreviousInstances sceneInstances\n";
  }
  if (parts.previousLights) {
    s += traits.animated ? buffer(scene::kBindPreviousLights, "readonly", "Light", "scenePreviousLights")
                         : "#define scenePreviousLights sceneLights\n";
  }
  return s;
}

std::string sceneDeclarations(const SceneParts& parts, uint32_t textures, const scene::SceneTraits& traits) {
  std::string s;
  if (traits.energyCompensation)  // of the BSDF, wherever that is evaluated
    s += buffer(scene::kBindSpecularAlbedo, "readonly", "float", "sceneSpecularAlbedo");
  if (parts.geometry) {
    s += "#define NEED_SCENE_GEOMETRY 1\n#define sceneInstanceCount frameBlock.instances\n";
    s += "#define sceneDiameter frameBlock.diameter\n#define sceneNear frameBlock.nearPlane\n";
    s += "#define sceneLargest frameBlock.largest\n";
    s += buffer(scene::kBindPositions, "readonly", "float", "scenePositions");
    s += buffer(scene::kBindVertices, "readonly", "Vertex", "sceneVertices");
    s += buffer(scene::kBindTriangles, "readonly", "uvec4", "sceneTriangles");
    s += buffer(scene::kBindInstances, "readonly", "Instance", "sceneInstances");
  }
  if (parts.materials) {
    s += "#define NEED_SCENE_MATERIALS 1\n";
    s += buffer(scene::kBindMaterials, "readonly", "Material", "sceneMaterials");
    s += fmt::format("layout(set = 0, binding = {}) uniform sampler2D sceneTextures[{}];\n",
                     uint32_t{scene::kBindTextures}, textures);
    if (traits.vertexColors) s += buffer(scene::kBindColors, "readonly", "uvec2", "sceneColors");
    if (traits.uvSets) s += buffer(scene::kBindUvs1, "readonly", "vec2", "sceneUvs1");
    if (traits.specularGlossiness || traits.dielectricSpecular)
      s += buffer(scene::kBindSpeculars, "readonly", "Specular", "sceneSpeculars");
    if (traits.uvSets || traits.uvTransforms || traits.mipmaps)
      s += "#define SCENE_TEXTURE_USES 1\n" +
           buffer(scene::kBindTextureUses, "readonly", "TextureUse", "sceneTextureUses");
  }
  if (parts.lights) {
    s += "#define NEED_SCENE_LIGHTS 1\n#define sceneLightCount frameBlock.lights\n";
    s += buffer(scene::kBindLights, "readonly", "Light", "sceneLights");
    s += buffer(scene::kBindAlias, "readonly", "AliasCell", "sceneAlias");
    if (traits.triangleLights)
      s += fmt::format(
          "layout(set = 0, binding = {}, std430) readonly buffer LitTriangleBlock {{ uint first, count, lights[]; }} "
          "sceneLitTriangles;\n",
          uint32_t{scene::kBindLightOfTriangle});
  }
  if (parts.environment) {
    s += fmt::format(R"(struct EnvironmentCell {{ float threshold; uint alias; float spread; }};
layout(set = 0, binding = {}, std430) readonly buffer EnvironmentBlock {{
  uint columns, rows, block, width, height; float unit, rotation; uint pad; EnvironmentCell cells[];
}} sceneEnvironment;
layout(set = 0, binding = {}) uniform sampler2D sceneEnvironmentMap;
)",
                     uint32_t{scene::kBindEnvironment}, uint32_t{scene::kBindEnvironmentMap});
  }
  return s;
}

std::string port(const std::string& prefix, const std::string& name, const PortType& type, uint32_t perPixel,
                 uint32_t binding, const char* access) {
  const std::string full = prefix + "_" + name;
  std::string s = fmt::format("#define has_{} 1\nconst uint {}_count = {}u;\n", full, full, perPixel);
  if (type.kind == PortKind::Buffer) {
    s += fmt::format("layout(set = 1, binding = {0}, std430) {1} buffer Block_{2} {{ {3} {2}[]; }};\n", binding, access,
                     full, type.layout.name);
  } else {
    const char* dimension = type.format == Format::R32U ? "uimage2D" : "image2D";
    s += fmt::format("layout(set = 1, binding = {}, {}) {} uniform {} {};\n", binding, glslFormat(type.format), access,
                     dimension, full);
  }
  return s;
}

/// Host sides: scene/light_tree.h, scene/upload_light_tree.h.
std::string lightTree(uint32_t binding) {
  return fmt::format(R"(#define HAS_LIGHT_TREE 1
layout(set = 1, binding = {}, std430) readonly buffer LightNodeBlock {{ uvec4 lightNodes[]; }};
layout(set = 1, binding = {}, std430) readonly buffer PlacedLightBlock {{ vec4 placedLights[]; }};
layout(set = 1, binding = {}, std430) readonly buffer LightTreeBlock {{
  uint lights, unplaced, levels, cutLevels; vec3 origin; float unit; uint unplacedShare, pad[3]; uvec2 entries[];
}} lightTree;
)",
                     binding, binding + 1, binding + 2);
}

std::string ports(const KernelInterface& k) {
  std::string structs, s;
  std::vector<std::string> known;
  auto layout = [&](const PortType& type) {
    if (type.kind != PortKind::Buffer || std::ranges::count(known, type.layout.name) != 0) return;
    known.push_back(type.layout.name);
    structs += type.layout.glsl() + "\n";
  };
  const PassDescription& d = *k.pass->description;
  uint32_t binding = 0;
  for (size_t i = 0; i < d.inputs.size(); ++i, ++binding) {
    layout(d.inputs[i].type);
    const uint32_t resource = k.pass->inputs[i].resource;
    if (resource == graph::kNone) continue;
    const uint32_t perPixel = k.graph->resources[resource].perPixel;
    s += port("in", d.inputs[i].name, d.inputs[i].type, perPixel, binding, "readonly");
  }
  for (size_t i = 0; i < d.outputs.size(); ++i, ++binding) {
    layout(d.outputs[i].type);
    const graph::Resource& r = k.graph->resources[k.pass->outputs[i].resource];
    const uint32_t perPixel = r.perPixel;
    // Work for an output that nobody reads can be left out.
    if (r.history || r.graphOutput || r.kept || r.external || r.lastUse != r.producer)
      s += fmt::format("#define wanted_out_{} 1\n", d.outputs[i].name);
    s += port("out", d.outputs[i].name, d.outputs[i].type, perPixel, binding, "");
  }
  for (const Scratch& scratch : k.scratch) {
    layout(scratch.type);
    s += port("scratch", scratch.name, scratch.type, scratch.perPixel, binding++, "");
  }
  for (const auto& [name, volume] : k.textures) {
    s += fmt::format("layout(set = 1, binding = {}) uniform {} texture_{};\n", binding++,
                     volume ? "sampler3D" : "sampler2D", name);
  }
  if (k.lightTree) s += lightTree(binding);
  return structs + s;
}

std::string params(const PassDescription& d) {
  std::string block = "layout(push_constant) uniform LaunchBlock {\n  uvec2 size; uint index; uint stream;\n";
  std::string names;
  for (const PushParam& p : pushParams(d)) {
    const ParamType type = p.description->type;
    const char* glsl = type == ParamType::Float ? "float" : type == ParamType::Bool ? "uint" : "int";
    block += fmt::format("  {} p_{};\n", glsl, p.description->name);
    names += fmt::format("#define param_{0} (launchBlock.p_{0}{1})\n", p.description->name,
                         type == ParamType::Bool ? " != 0u" : "");
  }
  block +=
      "} launchBlock;\n#define launchSize launchBlock.size\n#define launchIndex launchBlock.index\n#define "
      "launchStream launchBlock.stream\n";
  uint32_t id = 0;
  for (const ParamDescription* p : specialParams(d)) {
    const char* glsl = p->type == ParamType::Float ? "float" : p->type == ParamType::Bool ? "bool" : "int";
    const char* value = p->type == ParamType::Bool ? "false" : "0";
    names += fmt::format("layout(constant_id = {}) const {} param_{} = {};\n", id++, glsl, p->name, value);
  }
  return block + names;
}

std::string vertexMain() {
  return R"(
layout(location = 0) flat out uvec2 weirTriangle;
layout(location = 1) out vec2 weirBarycentrics;
void main() {
  begin();
  const uint instance = uint(gl_InstanceIndex), place = uint(gl_VertexIndex) / 3u, corner = uint(gl_VertexIndex) % 3u;
  weirTriangle = uvec2(sceneInstances[instance].firstTriangle + place, sceneInstances[instance].firstDrawn + place);
  weirBarycentrics = vec2(corner == 1u, corner == 2u);
  gl_Position = vertex(instance, weirTriangle.x, corner);
}
)";
}

std::string fragmentMain() {
  return R"(
layout(location = 0) flat in uvec2 weirTriangle;
layout(location = 1) in vec2 weirBarycentrics;
layout(location = 0) out uint weirTarget;
void main() {
  begin();
  if (!fragment(weirTriangle.x, weirBarycentrics, uvec2(gl_FragCoord.xy))) discard;
  weirTarget = weirTriangle.y;
}
)";
}

}  // namespace

std::vector<PushParam> pushParams(const PassDescription& description) {
  std::vector<PushParam> result;
  uint32_t offset = kLaunchBytes;
  for (const ParamDescription& p : description.params) {
    if (p.specialises || p.type == ParamType::String) continue;
    result.push_back({&p, offset});
    offset += 4;
  }
  return result;
}

uint32_t pushBytes(const PassDescription& description) {
  const auto bytes = static_cast<uint32_t>(kLaunchBytes + 4 * pushParams(description).size());
  if (bytes > kPushLimit) {
    throw InputError(
        fmt::format("{}: {} bytes of parameters, more than the {} that every device takes; let some specialise",
                    description.type, bytes, kPushLimit));
  }
  return bytes;
}

std::vector<const ParamDescription*> specialParams(const PassDescription& description) {
  std::vector<const ParamDescription*> result;
  for (const ParamDescription& p : description.params) {
    if (p.specialises && p.type != ParamType::String) result.push_back(&p);
  }
  return result;
}

uint32_t paramBits(const ParamDescription& description, const ParamValue& value) {
  switch (description.type) {
    case ParamType::Bool:
      return std::get<bool>(value) ? 1 : 0;
    case ParamType::Int:
      return static_cast<uint32_t>(std::get<int32_t>(value));
    case ParamType::Float:
      return std::bit_cast<uint32_t>(std::get<float>(value));
    case ParamType::Enum: {
      const auto found = std::ranges::find(description.choices, std::get<std::string>(value));
      return static_cast<uint32_t>(found - description.choices.begin());
    }
    default:
      return 0;
  }
}

std::string kernelSource(const KernelInterface& k, KernelKind kind, const std::string& file,
                         const KernelOptions& options) {
  const PassDescription& d = *k.pass->description;
  const SceneParts parts = partsOf(d, k.traits);
  const bool traces = kind == KernelKind::RayPipeline || kind == KernelKind::RayQuery;
  std::string s = extensions(kind == KernelKind::RayPipeline, kind == KernelKind::RayQuery);
  s += scene::traitDefines(k.traits);
  s += kStructs;
  s += sceneDeclarations(parts, k.sceneTextures, k.traits);
  s += previousDeclarations(parts, k.traits);
  if (traces) {
    s += fmt::format("layout(set = 0, binding = {}) uniform accelerationStructureEXT sceneAcceleration;\n",
                     uint32_t{scene::kBindAcceleration});
    if (parts.previousAcceleration) {
      s += "#define NEED_PREVIOUS_ACCELERATION 1\n";
      s += k.traits.animated
               ? fmt::format(
                     "layout(set = 0, binding = {}) uniform accelerationStructureEXT scenePreviousAcceleration;\n",
                     uint32_t{scene::kBindPreviousAcceleration})
               : "#define scenePreviousAcceleration sceneAcceleration\n";
    }
    s += fmt::format("#define CAN_TRACE 1\n#define {} 1\n",
                     kind == KernelKind::RayPipeline ? "TRACE_PIPELINE" : "TRACE_QUERY");
    if (k.countRays) {
      s += fmt::format(
          "#define COUNT_RAYS 1\nlayout(set = 0, binding = {}, std430) buffer RayBlock {{ uint count; }} rayCounter;\n",
          uint32_t{scene::kBindRays});
    }
  }
  s += ports(k);
  s += params(d);
  std::string begin = "void begin() {\n";
  if (d.has(Need::FrameCamera)) {
    s += "Camera camera;\n";
    begin += "  camera = frameBlock.camera;\n";
  }
  if (d.has(Need::FrameCamera, true)) {
    s += "Camera previousCamera;\n";
    begin += "  previousCamera = frameBlock.previousCamera;\n";
  }
  if (d.has(Need::FrameIndex)) s += "#define frameIndex frameBlock.frame\n#define frameSeed frameBlock.seed\n";
  s += begin + "}\n";
  if (kind == KernelKind::Vertex) s += "#define STAGE_VERTEX 1\n";
  if (kind == KernelKind::Fragment) s += "#define STAGE_FRAGMENT 1\n";
  s += fmt::format("#include \"{}\"\n", file);

  switch (kind) {
    case KernelKind::RayPipeline:
      s += "void main() {\n  begin();\n  run(gl_LaunchIDEXT.xy);\n}\n";
      break;
    case KernelKind::Vertex:
      s += vertexMain();
      break;
    case KernelKind::Fragment:
      s += fragmentMain();
      break;
    default:
      if (options.linear) {
        s += fmt::format("layout(local_size_x = {}) in;\nvoid main() {{\n  begin();\n", kRowGroup);
        s += fmt::format(
            "  const uint id = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * {}u + "
            "gl_LocalInvocationID.x;\n",
            kRowGroup);
        s += "  if (id < launchSize.x) run(uvec2(id, 0u));\n}\n";
        break;
      }
      s += fmt::format("layout(local_size_x = {0}, local_size_y = {0}) in;\n", options.group.side);
      s += "void main() {\n  begin();\n";
      if (!options.group.whole) s += "  if (all(lessThan(gl_GlobalInvocationID.xy, launchSize)))";
      s += "  run(gl_GlobalInvocationID.xy);\n}\n";
  }
  return s;
}

std::string hitShaderSource(const std::string& file, uint32_t sceneTextures, const scene::SceneTraits& traits) {
  return extensions(true, false) + scene::traitDefines(traits) + kStructs +
         sceneDeclarations({.geometry = true, .materials = true}, sceneTextures, traits) +
         fmt::format("#include \"trace/{}\"\n", file);
}

}  // namespace weir::execute
