// The driver's compiled pipelines, kept on disk between runs.
#include <fmt/format.h>
#include <weir/core/cache_folder.h>
#include <weir/core/text.h>
#include <weir/gpu/probe.h>

#include <cstring>

namespace weir::gpu {
namespace {

/// In front of the driver's own bytes: drivers check their header, but not that the rest is whole.
struct Header {
  char magic[8] = {'W', 'E', 'I', 'R', 'P', 'I', 'P', '1'};
  uint64_t size = 0;
  uint64_t checksum = 0;
};

uint64_t checksum(const char* data, size_t size) {
  return fnv1a(std::string_view(data, size));
}

/// One file for a device and a driver version: either's change makes the old contents useless.
std::string filePath(VkPhysicalDevice physical, const std::string& folder) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  std::string uuid;
  for (const uint8_t byte : properties.pipelineCacheUUID) uuid += fmt::format("{:02x}", byte);
  return fmt::format("{}/pipelines/{:04x}-{:04x}-{}-{:08x}.bin", folder, properties.vendorID, properties.deviceID, uuid,
                     properties.driverVersion);
}

/// The driver's bytes in a file of ours, or nothing when it isn't a whole one.
std::vector<char> contents(const std::string& path) {
  std::vector<char> bytes = readCacheFile(path);
  Header header;
  if (bytes.size() < sizeof(Header)) return {};
  std::memcpy(&header, bytes.data(), sizeof(Header));
  const size_t size = bytes.size() - sizeof(Header);
  const bool whole = std::memcmp(header.magic, Header().magic, sizeof header.magic) == 0 && header.size == size &&
                     header.checksum == checksum(bytes.data() + sizeof(Header), size);
  if (!whole) return {};
  bytes.erase(bytes.begin(), bytes.begin() + sizeof(Header));
  return bytes;
}

}  // namespace

VkPipelineCache loadPipelineCache(VkDevice device, VkPhysicalDevice physical, const std::string& folder) {
  std::vector<char> bytes;
  if (!folder.empty()) bytes = contents(filePath(physical, folder));
  VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                 .initialDataSize = bytes.size(),
                                 .pInitialData = bytes.data()};
  VkPipelineCache cache = VK_NULL_HANDLE;
  if (vkCreatePipelineCache(device, &info, nullptr, &cache) != VK_SUCCESS && !bytes.empty()) {
    info.initialDataSize = 0;
    check(vkCreatePipelineCache(device, &info, nullptr, &cache), "vkCreatePipelineCache");
  }
  return cache;
}

void savePipelineCache(VkDevice device, VkPhysicalDevice physical, VkPipelineCache cache, const std::string& folder) {
  if (folder.empty() || cache == VK_NULL_HANDLE) return;
  size_t size = 0;
  if (vkGetPipelineCacheData(device, cache, &size, nullptr) != VK_SUCCESS) return;
  // A cache without pipelines is its 32-byte header alone: not worth a file.
  if (size <= sizeof(VkPipelineCacheHeaderVersionOne)) return;
  std::vector<char> bytes(sizeof(Header) + size);
  if (vkGetPipelineCacheData(device, cache, &size, bytes.data() + sizeof(Header)) != VK_SUCCESS) return;
  bytes.resize(sizeof(Header) + size);
  Header header;
  header.size = size;
  header.checksum = checksum(bytes.data() + sizeof(Header), size);
  std::memcpy(bytes.data(), &header, sizeof(Header));
  const std::string path = filePath(physical, folder);
  if (readCacheFile(path) != bytes) writeCacheFile(path, bytes);
}

}  // namespace weir::gpu
