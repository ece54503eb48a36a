// PNG and JPEG decoding behind guards. The one place where stb_image is compiled.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS (1 << 20)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/scene/gltf_import.h>

#include <algorithm>
#include <memory>
#include <string_view>

namespace weir::scene {
namespace {

// DEFLATE expands at most 1032-fold; a JPEG of one colour does not do better than that either. A header that promises
// more texels than its file can hold is refused before anything is allocated.
constexpr uint64_t kMaxExpansion = 1032;
// A progressive JPEG passes over the whole picture once a scan; real ones have about ten.
constexpr int kMaxJpegScans = 64;

bool looksLikeJpeg(std::span<const uint8_t> bytes) {
  return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
}

int jpegScans(std::span<const uint8_t> bytes) {
  int scans = 0;
  for (size_t i = 0; i + 1 < bytes.size(); ++i) scans += bytes[i] == 0xFF && bytes[i + 1] == 0xDA;
  return scans;
}

/// What else the bytes are, for the message; by the formats' own first bytes.
std::string otherFormat(std::span<const uint8_t> bytes) {
  const auto has = [&](size_t at, std::string_view magic) {
    return bytes.size() >= at + magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin() + at,
                                                           [](char a, uint8_t b) { return uint8_t(a) == b; });
  };
  if (has(0, "\xABKTX 20")) return ": a KTX2 image (KHR_texture_basisu), which is not implemented";
  if (has(0, "RIFF") && has(8, "WEBP")) return ": a WebP image (EXT_texture_webp), which is not implemented";
  if (has(0, "DDS ")) return ": a DDS image (MSFT_texture_dds), which is not implemented";
  if (has(4, "ftypavif")) return ": an AVIF image (EXT_texture_avif), which is not implemented";
  return "";
}

}  // namespace

bool checkImageHeader(std::span<const uint8_t> bytes, const ImportLimits& limits, uint32_t& width, uint32_t& height,
                      std::string& reason) {
  int w = 0, h = 0, channels = 0;
  if (bytes.size() > 0x7fffffff ||
      !stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &w, &h, &channels)) {
    reason = "neither PNG nor JPEG" + otherFormat(bytes);
    return false;
  }
  if (w < 1 || h < 1 || static_cast<uint32_t>(w) > limits.imageSide || static_cast<uint32_t>(h) > limits.imageSide) {
    reason =
        std::to_string(w) + " x " + std::to_string(h) + " texels; sides go up to " + std::to_string(limits.imageSide);
    return false;
  }
  // PNGs go down to one bit a texel.
  if (static_cast<uint64_t>(w) * h / 8 > kMaxExpansion * bytes.size()) {
    reason = std::to_string(w) + " x " + std::to_string(h) + " texels can't come from " + std::to_string(bytes.size()) +
             " bytes";
    return false;
  }
  if (looksLikeJpeg(bytes) && jpegScans(bytes) > kMaxJpegScans) {
    reason = "a JPEG of more than " + std::to_string(kMaxJpegScans) + " scans";
    return false;
  }
  width = static_cast<uint32_t>(w);
  height = static_cast<uint32_t>(h);
  return true;
}

std::optional<Image> decodeImage(std::span<const uint8_t> bytes, const ImportLimits& limits, std::string& reason) {
  Image image;
  if (!checkImageHeader(bytes, limits, image.width, image.height, reason)) return std::nullopt;
  int w = 0, h = 0, channels = 0;
  const auto size = static_cast<int>(bytes.size());
  const bool wide = stbi_is_16_bit_from_memory(bytes.data(), size) != 0;
  const std::unique_ptr<void, void (*)(void*)> texels(
      wide ? static_cast<void*>(stbi_load_16_from_memory(bytes.data(), size, &w, &h, &channels, 4))
           : static_cast<void*>(stbi_load_from_memory(bytes.data(), size, &w, &h, &channels, 4)),
      stbi_image_free);
  if (!texels || static_cast<uint32_t>(w) != image.width || static_cast<uint32_t>(h) != image.height) {
    const char* why = stbi_failure_reason();
    reason = std::string("can't be decoded") + (why ? std::string(" (") + why + ")" : "");
    return std::nullopt;
  }
  const size_t values = static_cast<size_t>(w) * h * 4;
  if (wide) {
    // Rounded, where stb itself would cut the lower byte off: 16 bits hold 257 times an 8-bit value.
    const auto* from = static_cast<const uint16_t*>(texels.get());
    image.rgba.resize(values);
    std::transform(from, from + values, image.rgba.begin(),
                   [](uint16_t v) { return static_cast<uint8_t>((v + 128u) / 257u); });
  } else {
    const auto* from = static_cast<const uint8_t*>(texels.get());
    image.rgba.assign(from, from + values);
  }
  return image;
}

void importImages(GltfImport& import) {
  Scene& scene = import.scene;
  std::vector<char> used(scene.images.size(), 0);
  for (const Material& material : scene.materials)
    for (const TextureSlot* slot : material.slots())
      if (*slot) used[scene.textures[slot->texture].image] = 1;

  // Finding bytes may read files and throws; that and the size checks stay on this thread.
  struct Work {
    size_t image;
    std::span<const uint8_t> bytes;
  };
  std::vector<Work> work;
  uint64_t texels = 0;
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const auto bytes = import.file.image(i);
    const std::string place = "/images/" + std::to_string(i);
    std::string reason;
    uint32_t width = 0, height = 0;
    if (!checkImageHeader(bytes, import.limits, width, height, reason)) import.file.fail(place, reason);
    texels += static_cast<uint64_t>(width) * height;
    if (texels > import.limits.imageTexels)
      import.file.fail(place, "all images together exceed " + std::to_string(import.limits.imageTexels) + " texels");
    work.push_back({i, bytes});
  }

  // Each image is its own; of several broken ones the first in the file is reported.
  parallelFor(work.size(), [&](size_t i) {
    std::string reason;
    std::optional<Image> image = decodeImage(work[i].bytes, import.limits, reason);
    if (!image) import.file.fail("/images/" + std::to_string(work[i].image), reason);
    image->name = std::move(scene.images[work[i].image].name);
    scene.images[work[i].image] = std::move(*image);
  });
}

}  // namespace weir::scene
