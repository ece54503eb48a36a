// Textures of a scene: images with their smaller levels, samplers, and how each is read.
#include <weir/core/parallel.h>
#include <weir/scene/upload.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace weir::scene {
namespace {

VkSamplerAddressMode addressMode(Wrap wrap) {
  switch (wrap) {
    case Wrap::MirroredRepeat:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case Wrap::ClampToEdge:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    default:
      return VK_SAMPLER_ADDRESS_MODE_REPEAT;
  }
}

VkFilter filter(Filter f) {
  return f == Filter::Nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
}

bool sameSampler(const PreparedTexture& a, const PreparedTexture& b) {
  return a.wrapS == b.wrapS && a.wrapT == b.wrapT && a.magFilter == b.magFilter && a.minFilter == b.minFilter &&
         a.mipFilter == b.mipFilter;
}

/// An image of Scene::images (-1: white) as textures of one content read it.
struct ImageUse {
  int image;
  MipContent content;
  bool mipmapped;
  std::vector<uint8_t> levels = {};  // from level 1 on
};

GpuTextureUse packUse(const PreparedTexture& t, const Image& image) {
  GpuTextureUse use;
  use.linear = {t.transform.linear[0], t.transform.linear[1]};
  use.offset = t.transform.offset;
  use.uvSet = t.uvSet;
  const double texels = std::abs(glm::determinant(glm::dmat2(t.transform.linear))) * image.width * image.height;
  // Coordinates that don't change are those of one texel.
  use.texelLevel = texels > 0.0 ? static_cast<float>(0.5 * std::log2(texels)) : 0.0f;
  return use;
}

}  // namespace

VkSampler SceneGpu::samplerOf(const PreparedTexture& texture) {
  for (const auto& [like, sampler] : samplers_)
    if (sameSampler(like, texture)) return sampler;
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = filter(texture.magFilter);
  info.minFilter = filter(texture.minFilter);
  info.mipmapMode =
      texture.mipFilter == MipFilter::Linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = addressMode(texture.wrapS);
  info.addressModeV = addressMode(texture.wrapT);
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  // Vulkan's own way to say "no levels, yet choose between the two filters": a quarter still rounds to level 0.
  info.maxLod = texture.mipFilter == MipFilter::None ? 0.25f : VK_LOD_CLAMP_NONE;
  VkSampler sampler = VK_NULL_HANDLE;
  gpu::check(vkCreateSampler(device_->handle(), &info, nullptr, &sampler), "vkCreateSampler");
  samplers_.emplace_back(texture, sampler);
  return sampler;
}

void SceneGpu::uploadTextures(const Scene& scene, const PreparedScene& prepared) {
  const Image white{"white", 1, 1, {255, 255, 255, 255}};
  std::vector<PreparedTexture> textures = prepared.textures;
  if (textures.empty()) textures.emplace_back();  // so that the array is never empty
  const auto imageOf = [&](int index) -> const Image& { return index < 0 ? white : scene.images[index]; };

  std::vector<ImageUse> images;
  std::vector<GpuTextureUse> uses;
  for (const PreparedTexture& t : textures) {
    auto found = std::ranges::find_if(
        images, [&](const ImageUse& use) { return use.image == t.image && use.content == t.content; });
    if (found == images.end()) found = images.insert(images.end(), ImageUse{t.image, t.content, false});
    found->mipmapped |= t.mipFilter != MipFilter::None;
    textures_.push_back({static_cast<uint32_t>(found - images.begin()), samplerOf(t)});
    uses.push_back(packUse(t, imageOf(t.image)));
  }

  // Smaller levels on all cores: on one, a large scene's take as long as all the rest of its loading.
  parallelFor(images.size(), [&](size_t i) {
    if (images[i].mipmapped) images[i].levels = makeMipmaps(imageOf(images[i].image), images[i].content);
  });
  for (const ImageUse& use : images) {
    const Image& source = imageOf(use.image);
    gpu::ImageDesc desc;
    desc.width = source.width;
    desc.height = source.height;
    desc.mipLevels = use.mipmapped ? mipLevelCount(source.width, source.height) : 1;
    desc.format = use.content.srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM;
    images_.push_back(gpu::uploadImage(*device_, desc, std::as_bytes(std::span(source.rgba)),
                                       std::as_bytes(std::span(use.levels)), "texture " + source.name));
  }
  const SceneTraits& has = prepared.traits;
  if (!has.uvSets && !has.uvTransforms && !has.mipmaps) uses.clear();
  textureUses_ = gpu::uploadBuffer(*device_, uses, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "scene texture uses");
}

}  // namespace weir::scene
