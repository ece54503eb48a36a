// Storage-buffer blocks, read from the SPIR-V: what the device will run is what gets compared with the host.
#include <weir/shader/sources.h>

#include <glslang/SPIRV/spirv.hpp>
#include <map>

namespace weir::shader {
namespace {

/// What reflection needs of a module, by result id.
struct Ids {
  std::map<uint32_t, std::string> names;
  std::map<uint32_t, uint32_t> sets, bindings, strides;
  std::map<uint32_t, uint32_t> pointees;               ///< pointer to a storage buffer → its type
  std::map<uint32_t, uint32_t> elements;               ///< array → its element
  std::map<uint32_t, std::vector<uint32_t>> members;   ///< struct → its members' types
  std::map<uint32_t, uint32_t> runtimeArrays;          ///< as `elements`, of those without a length
  std::vector<std::pair<uint32_t, uint32_t>> buffers;  ///< variable, pointer type
};

void readInstruction(const uint32_t* words, uint32_t count, Ids& ids) {
  switch (words[0] & 0xffff) {
    case spv::OpName:
      ids.names[words[1]] = reinterpret_cast<const char*>(words + 2);
      break;
    case spv::OpDecorate:
      if (words[2] == spv::DecorationDescriptorSet) ids.sets[words[1]] = words[3];
      if (words[2] == spv::DecorationBinding) ids.bindings[words[1]] = words[3];
      if (words[2] == spv::DecorationArrayStride) ids.strides[words[1]] = words[3];
      break;
    case spv::OpTypePointer:
      if (words[2] == spv::StorageClassStorageBuffer) ids.pointees[words[1]] = words[3];
      break;
    case spv::OpTypeArray:
      ids.elements[words[1]] = words[2];
      break;
    case spv::OpTypeRuntimeArray:
      ids.elements[words[1]] = words[2];
      ids.runtimeArrays[words[1]] = words[2];
      break;
    case spv::OpTypeStruct:
      ids.members[words[1]].assign(words + 2, words + count);
      break;
    case spv::OpVariable:
      if (words[3] == spv::StorageClassStorageBuffer) ids.buffers.emplace_back(words[2], words[1]);
      break;
    default:
      break;
  }
}

}  // namespace

std::vector<BufferBlock> reflectBuffers(const CompileRequest& request) {
  Sources sources(request);
  const std::vector<uint32_t> spirv = compileToSpirv(request, sources);
  Ids ids;
  constexpr size_t kHeaderWords = 5;
  for (size_t at = kHeaderWords; at < spirv.size();) {
    const uint32_t count = spirv[at] >> 16;
    if (count == 0) break;
    readInstruction(&spirv[at], count, ids);
    at += count;
  }
  std::vector<BufferBlock> blocks;
  for (const auto& [variable, pointer] : ids.buffers) {
    uint32_t type = ids.pointees[pointer];
    // An array of buffers: each is such a block.
    while (ids.elements.contains(type)) type = ids.elements[type];
    BufferBlock block{.name = ids.names[type], .set = ids.sets[variable], .binding = ids.bindings[variable]};
    const std::vector<uint32_t>& members = ids.members[type];
    if (!members.empty() && ids.runtimeArrays.contains(members.back())) block.arrayStride = ids.strides[members.back()];
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace weir::shader
