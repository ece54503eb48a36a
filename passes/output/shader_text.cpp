#include "output/shader_text.h"

#include <fmt/format.h>
#include <weir/core/error.h>

#include <algorithm>

namespace weir::passes {
namespace {

namespace ocio = OCIO_NAMESPACE;

// A sampler's filter has weights of 8 bits only, which in a coarse table is a visible error: so by hand, from texels.
// Overloads because one-dimensional tables are asked for with one coordinate, and long ones, in rows, with two.
constexpr const char* kLookups = R"(
vec4 lookup(bool smoothly, sampler2D table, vec2 at) {
  const ivec2 last = textureSize(table, 0) - 1;
  const vec2 place = clamp(at, 0.0, 1.0) * vec2(last + 1);
  if (!smoothly) return texelFetch(table, clamp(ivec2(floor(place)), ivec2(0), last), 0);
  const vec2 low = floor(place - 0.5), t = place - 0.5 - low;
  const ivec2 a = clamp(ivec2(low), ivec2(0), last), b = clamp(ivec2(low) + 1, ivec2(0), last);
  const vec4 top = mix(texelFetch(table, a, 0), texelFetch(table, ivec2(b.x, a.y), 0), t.x);
  const vec4 bottom = mix(texelFetch(table, ivec2(a.x, b.y), 0), texelFetch(table, b, 0), t.x);
  return mix(top, bottom, t.y);
}
vec4 lookup(bool smoothly, sampler2D table, float at) { return lookup(smoothly, table, vec2(at, 0.5)); }
vec4 lookup(bool smoothly, sampler3D table, vec3 at) {
  const ivec3 last = textureSize(table, 0) - 1;
  const vec3 place = clamp(at, 0.0, 1.0) * vec3(last + 1);
  if (!smoothly) return texelFetch(table, clamp(ivec3(floor(place)), ivec3(0), last), 0);
  const vec3 low = floor(place - 0.5), t = place - 0.5 - low;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 8; ++i) {
    const ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    const vec3 w = mix(1.0 - t, t, vec3(corner));
    sum += w.x * w.y * w.z * texelFetch(table, clamp(ivec3(low) + corner, ivec3(0), last), 0);
  }
  return sum;
}
)";

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// A table's declaration goes (the pass's own takes its place), and its reads become lookups in texture_<name>.
void useTexture(std::string& text, const char* type, const char* sampler, ocio::Interpolation filter,
                const std::string& name) {
  replaceAll(text, fmt::format("uniform {} {};", type, sampler), "");
  const bool smoothly = filter != ocio::INTERP_NEAREST && filter != ocio::INTERP_TETRAHEDRAL;
  replaceAll(text, fmt::format("texture({},", sampler), fmt::format("lookup({}, texture_{},", smoothly, name));
}

TextureData table(const float* values, uint32_t width, uint32_t height, uint32_t depth, uint32_t channels) {
  TextureData data = {.width = width, .height = height, .depth = depth, .linear = false};
  const size_t texels = size_t{width} * height * std::max(depth, 1u);
  data.rgba.reserve(4 * texels);
  for (size_t i = 0; i < texels; ++i, values += channels) {
    const bool gray = channels == 1;
    data.rgba.insert(data.rgba.end(), {values[0], values[gray ? 0 : 1], values[gray ? 0 : 2], 1.0f});
  }
  return data;
}

}  // namespace

ViewTransform shaderText(const ocio::Processor& processor, const std::string& name) {
  ocio::GpuShaderDescRcPtr shader = ocio::GpuShaderDesc::CreateShaderDesc();
  shader->setLanguage(ocio::GPU_LANGUAGE_GLSL_4_0);
  shader->setFunctionName("viewTransform");
  shader->setResourcePrefix("ocio");
  const auto optimization = ocio::OPTIMIZATION_DEFAULT | ocio::OPTIMIZATION_NO_DYNAMIC_PROPERTIES;
  processor.getOptimizedGPUProcessor(static_cast<ocio::OptimizationFlags>(optimization))->extractGpuShaderInfo(shader);
  if (shader->getNumUniforms() > 0) {
    ocio::GpuShaderDesc::UniformData data;
    throw InputError(fmt::format("{}: its transform wants \"{}\" set at run time, which Weir doesn't do", name,
                                 shader->getUniform(0, data)));
  }

  ViewTransform result;
  std::string text = shader->getShaderText();
  for (unsigned i = 0; i < shader->getNumTextures(); ++i) {
    const char *texture = nullptr, *sampler = nullptr;
    unsigned width = 0, height = 0;
    ocio::GpuShaderDesc::TextureType channels{};
    ocio::Interpolation filter{};
    const float* values = nullptr;
    shader->getTexture(i, texture, sampler, width, height, channels, filter);
    shader->getTextureValues(i, values);
    const std::string own = fmt::format("table{}", i);
    useTexture(text, height > 1 ? "sampler2D" : "sampler1D", sampler, filter, own);
    const uint32_t count = channels == ocio::GpuShaderDesc::TEXTURE_RED_CHANNEL ? 1 : 3;
    result.textures.emplace_back(own, table(values, width, height, 0, count));
  }
  for (unsigned i = 0; i < shader->getNum3DTextures(); ++i) {
    const char *texture = nullptr, *sampler = nullptr;
    unsigned edge = 0;
    ocio::Interpolation filter{};
    const float* values = nullptr;
    shader->get3DTexture(i, texture, sampler, edge, filter);
    shader->get3DTextureValues(i, values);
    const std::string own = fmt::format("volume{}", i);
    useTexture(text, "sampler3D", sampler, filter, own);
    result.textures.emplace_back(own, table(values, edge, edge, edge, 3));
  }
  result.glsl = (result.textures.empty() ? "" : kLookups) + text;
  return result;
}

}  // namespace weir::passes
