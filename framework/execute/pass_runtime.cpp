#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/execute/contexts.h>
#include <weir/execute/pass_runtime.h>

#include <algorithm>

namespace weir::execute {
namespace {

VkDescriptorType descriptorType(const PortType& type) {
  return type.kind == PortKind::Buffer ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

}  // namespace

PassRuntime::PassRuntime(Shared& shared, const graph::CompiledPass& pass)
    : shared_(shared), compiled_(pass), pass_(shared.registry->create(pass.type)) {
  interface_ = {shared.graph, &pass, {}, {}, shared.countRays, shared.scene->textureCount(), shared.scene->traits};
  const PassDescription& d = *pass.description;
  push_.assign(pushBytes(d) / 4, 0);
  push_[3] = pass.stream;
  for (const PushParam& p : pushParams(d))
    push_[p.offset / 4] = paramBits(*p.description, pass.params.at(p.description->name));
  for (const ParamDescription* p : specialParams(d)) constants_.push_back(paramBits(*p, pass.params.at(p->name)));
  Preparing context(*this);
  pass_->prepare(context);
}

PassRuntime::~PassRuntime() {
  VkDevice device = shared_.device->handle();
  pipelines_.clear();
  for (VkDescriptorPool pool : pools_) vkDestroyDescriptorPool(device, pool, nullptr);
  for (const OwnTexture& t : textures_) vkDestroySampler(device, t.sampler, nullptr);
  vkDestroyPipelineLayout(device, pipelineLayout_, nullptr);
  vkDestroyDescriptorSetLayout(device, setLayout_, nullptr);
}

void PassRuntime::record(const FrameCursor& cursor) {
  Recording context(*this, cursor);
  pass_->record(context);
}

uint64_t PassRuntime::scratchBytes() const {
  uint64_t sum = depth_ ? depth_.bytes() : 0;
  for (const Storage& s : scratch_) sum += s.bytes;
  return sum;
}

void PassRuntime::makeLayouts() {
  if (setLayout_ != VK_NULL_HANDLE) return;
  const PassDescription& d = *compiled_.description;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  uint32_t binding = 0;
  auto add = [&](VkDescriptorType type, bool used) {
    if (used) bindings.push_back({binding, type, 1, VK_SHADER_STAGE_ALL, nullptr});
    ++binding;
  };
  for (size_t i = 0; i < d.inputs.size(); ++i) {
    add(descriptorType(d.inputs[i].type), compiled_.inputs[i].resource != graph::kNone);
  }
  for (const PortDescription& output : d.outputs) add(descriptorType(output.type), true);
  for (const Scratch& s : interface_.scratch) add(descriptorType(s.type), true);
  for (size_t i = 0; i < textures_.size(); ++i) add(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, true);

  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.bindingCount = static_cast<uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(shared_.device->handle(), &info, nullptr, &setLayout_),
             "vkCreateDescriptorSetLayout");
  const std::array sets = {shared_.scene->layout(), setLayout_};
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, static_cast<uint32_t>(push_.size() * 4)};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = static_cast<uint32_t>(sets.size());
  layout.pSetLayouts = sets.data();
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  gpu::check(vkCreatePipelineLayout(shared_.device->handle(), &layout, nullptr, &pipelineLayout_),
             "vkCreatePipelineLayout");
}

shader::CompileRequest PassRuntime::request(shader::Stage stage, const std::string& source,
                                            const KernelOptions& options) const {
  shader::CompileRequest r;
  r.name = "prelude of " + compiled_.name;
  r.source = source;
  r.stage = stage;
  const std::filesystem::path own = shared_.registry->shaderFolder(compiled_.type);
  if (!own.empty()) r.includeFolders.push_back(own.string());
  r.includeFolders.push_back(commonShaderFolder().string());
  for (const auto& [name, text] : options.sources) r.virtualFiles[name] = text;
  r.defines = options.defines;
  return r;
}

const HitShaders& PassRuntime::hitShaders() {
  if (shared_.hitShaders) return *shared_.hitShaders;
  auto compile = [&](const char* file, shader::Stage stage) {
    shader::CompileRequest r;
    r.name = std::string("prelude of ") + file;
    r.source = hitShaderSource(file, shared_.scene->textureCount(), shared_.scene->traits);
    r.stage = stage;
    r.includeFolders.push_back(commonShaderFolder().string());
    return shared_.compiler->compile(r).spirv;
  };
  shared_.hitShaders = HitShaders{
      compile("closest_hit.glsl", shader::Stage::ClosestHit), compile("closest_any_hit.glsl", shader::Stage::AnyHit),
      compile("closest_miss.glsl", shader::Stage::Miss), compile("shadow_any_hit.glsl", shader::Stage::AnyHit),
      compile("shadow_miss.glsl", shader::Stage::Miss)};
  return *shared_.hitShaders;
}

Kernel PassRuntime::addKernel(KernelKind kind, const std::string& file, const KernelOptions& options) {
  makeLayouts();
  PreparedKernel kernel;
  std::string key = std::to_string(static_cast<int>(kind)) + file;
  for (const auto& [name, value] : options.defines) key += "|" + name + "=" + value;
  for (const auto& [name, text] : options.sources) key += "|" + name + ":" + text;
  for (const auto& [known, pipeline] : pipelines_) {
    if (known == key) kernel.pipeline = pipeline.get();
  }
  if (kernel.pipeline == nullptr) {
    const std::string name = compiled_.name + " " + file;
    auto spirv = [&](KernelKind which, shader::Stage stage) {
      return shared_.compiler->compile(request(stage, kernelSource(interface_, which, file), options)).spirv;
    };
    Pipeline made;
    if (kind == KernelKind::Vertex) {
      const auto vertex = spirv(KernelKind::Vertex, shader::Stage::Vertex);
      const auto fragment = spirv(KernelKind::Fragment, shader::Stage::Fragment);
      made = Pipeline::raster(*shared_.device, pipelineLayout_, vertex, fragment, VK_FORMAT_R32_UINT, constants_, name);
    } else if (kind == KernelKind::RayPipeline) {
      made = Pipeline::rays(*shared_.device, pipelineLayout_, spirv(kind, shader::Stage::RayGeneration), hitShaders(),
                            constants_, name);
    } else {
      made = Pipeline::compute(*shared_.device, pipelineLayout_, spirv(kind, shader::Stage::Compute), constants_, name);
    }
    stages_ |= made.stages();
    pipelines_.emplace_back(key, std::make_unique<Pipeline>(std::move(made)));
    kernel.pipeline = pipelines_.back().second.get();
  }
  kernel.sets = makeSets(options);
  kernels_.push_back(kernel);
  return {static_cast<uint32_t>(kernels_.size() - 1)};
}

const Storage& PassRuntime::storageNamed(const std::string& name, uint32_t parity) const {
  const PassDescription& d = *compiled_.description;
  for (size_t i = 0; i < d.inputs.size(); ++i) {
    const graph::Binding& b = compiled_.inputs[i];
    if (name == "in_" + d.inputs[i].name && b.resource != graph::kNone) {
      return shared_.resources->at(b.resource, parity, b.previous);
    }
  }
  for (size_t i = 0; i < d.outputs.size(); ++i) {
    if (name == "out_" + d.outputs[i].name) return shared_.resources->at(compiled_.outputs[i].resource, parity, false);
  }
  for (size_t i = 0; i < interface_.scratch.size(); ++i) {
    if (name == "scratch_" + interface_.scratch[i].name) return scratch_[i];
  }
  throw InputError(fmt::format("{} ({}): nothing is named '{}' there", compiled_.name, compiled_.type, name));
}

std::array<VkDescriptorSet, 2> PassRuntime::makeSets(const KernelOptions& options) {
  const PassDescription& d = *compiled_.description;
  struct Slot {
    std::string name;
    uint32_t binding;
    VkDescriptorType type;
  };
  std::vector<Slot> slots;
  uint32_t binding = 0;
  for (size_t i = 0; i < d.inputs.size(); ++i, ++binding) {
    if (compiled_.inputs[i].resource != graph::kNone)
      slots.push_back({"in_" + d.inputs[i].name, binding, descriptorType(d.inputs[i].type)});
  }
  for (const PortDescription& p : d.outputs) slots.push_back({"out_" + p.name, binding++, descriptorType(p.type)});
  for (const Scratch& s : interface_.scratch) slots.push_back({"scratch_" + s.name, binding++, descriptorType(s.type)});
  const uint32_t firstTexture = binding;

  const std::array<VkDescriptorPoolSize, 3> sizes = {
      {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2 * static_cast<uint32_t>(slots.size()) + 1},
       {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 2 * static_cast<uint32_t>(slots.size()) + 1},
       {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2 * static_cast<uint32_t>(textures_.size()) + 1}}};
  VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  poolInfo.maxSets = 2;
  poolInfo.poolSizeCount = static_cast<uint32_t>(sizes.size());
  poolInfo.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  gpu::check(vkCreateDescriptorPool(shared_.device->handle(), &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
  pools_.push_back(pool);
  const std::array layouts = {setLayout_, setLayout_};
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = 2;
  allocate.pSetLayouts = layouts.data();
  std::array<VkDescriptorSet, 2> sets{};
  gpu::check(vkAllocateDescriptorSets(shared_.device->handle(), &allocate, sets.data()), "vkAllocateDescriptorSets");

  for (uint32_t parity = 0; parity < 2; ++parity) {
    std::vector<VkDescriptorBufferInfo> buffers(slots.size());
    std::vector<VkDescriptorImageInfo> images(slots.size() + textures_.size());
    std::vector<VkWriteDescriptorSet> writes;
    for (size_t i = 0; i < slots.size() + textures_.size(); ++i) {
      VkWriteDescriptorSet w{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
      w.dstSet = sets[parity];
      w.descriptorCount = 1;
      if (i < slots.size()) {
        std::string name = slots[i].name;
        for (const auto& [from, to] : options.bind) {
          if (from == slots[i].name) name = to;
        }
        const Storage& storage = storageNamed(name, parity);
        w.dstBinding = slots[i].binding;
        w.descriptorType = slots[i].type;
        if (static_cast<bool>(storage.buffer) != (w.descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)) {
          throw InputError(fmt::format("{}: '{}' can't stand for '{}'", compiled_.name, name, slots[i].name));
        }
        buffers[i] = {storage.buffer.handle(), 0, VK_WHOLE_SIZE};
        images[i] = {VK_NULL_HANDLE, storage.image.view(), VK_IMAGE_LAYOUT_GENERAL};
        w.pBufferInfo = &buffers[i];
      } else {
        const OwnTexture& texture = textures_[i - slots.size()];
        w.dstBinding = firstTexture + static_cast<uint32_t>(i - slots.size());
        w.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        images[i] = {texture.sampler, texture.image.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
      }
      w.pImageInfo = &images[i];
      writes.push_back(w);
    }
    vkUpdateDescriptorSets(shared_.device->handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
  }
  return sets;
}

}  // namespace weir::execute
