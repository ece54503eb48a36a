// What a host's device was made with decides what Weir does on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "node.h"

extern "C" {
size_t sizeOfFrameInC(void);
size_t sizeOfImageInC(void);
WeirStatus openAndCloseInC(void);
}

namespace weir::test {
namespace {

bool anyHas(const std::vector<std::string>& lines, const std::string& words) {
  return std::ranges::any_of(lines, [&](const std::string& l) { return l.find(words) != std::string::npos; });
}

/// Finds a structure in a feature chain.
template <typename T>
T& in(VkPhysicalDeviceFeatures2& chain, VkStructureType type) {
  auto* s = reinterpret_cast<VkBaseOutStructure*>(&chain);
  while (s->sType != type) s = s->pNext;
  return *reinterpret_cast<T*>(s);
}

void withoutExtensions(std::vector<const char*>& extensions, const std::vector<std::string>& gone) {
  std::erase_if(extensions, [&](const char* name) { return std::ranges::count(gone, std::string(name)) > 0; });
}

/// Cuts everything behind Vulkan 1.3's features off: the structures of ray tracing.
void withoutRays(VkPhysicalDeviceFeatures2& features, std::vector<const char*>& extensions) {
  in<VkPhysicalDeviceVulkan13Features>(features, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES).pNext = nullptr;
  extensions.clear();
}

TEST(EmbedHeader, IsC) {
  EXPECT_EQ(sizeOfFrameInC(), sizeof(WeirFrame));
  EXPECT_EQ(sizeOfImageInC(), sizeof(WeirImage));
  EXPECT_EQ(openAndCloseInC(), WEIR_OK);
}

TEST(EmbedMissing, NamesWhatTheDeviceWasMadeWithout) {
  Host host;
  EXPECT_EQ(weirMissing(host.weir(), &host.info(), nullptr), WEIR_OK) << host.message();
  EXPECT_EQ(host.lines(), std::vector<std::string>{});

  WeirHost bare = host.info();
  bare.features = nullptr;
  bare.apiVersion = VK_API_VERSION_1_2;
  bare.device = VK_NULL_HANDLE;
  EXPECT_EQ(weirMissing(host.weir(), &bare, nullptr), WEIR_OK) << host.message();
  for (const char* name : {"bufferDeviceAddress", "synchronization2", "runtimeDescriptorArray", "Vulkan 1.3", "1.2"})
    EXPECT_TRUE(anyHas(host.lines(), name)) << name;

  bare = host.info();
  bare.features = nullptr;
  WeirContext* context = nullptr;
  EXPECT_EQ(weirCreateContext(host.weir(), &bare, &context), WEIR_BAD_INPUT);
  EXPECT_EQ(context, nullptr);
  EXPECT_NE(host.message().find("timelineSemaphore"), std::string::npos) << host.message();
  bare = host.info();
  bare.queueFamily = 77;
  EXPECT_EQ(weirMissing(host.weir(), &bare, nullptr), WEIR_OK) << host.message();
  EXPECT_TRUE(anyHas(host.lines(), "queue family 77"));
}

TEST(EmbedMissing, ReadsTheStructuresOfExtensionsToo) {
  Host host;
  VkPhysicalDeviceMaintenance4Features maintenance{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES};
  VkPhysicalDeviceDynamicRenderingFeatures rendering{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
                                                     &maintenance};
  VkPhysicalDeviceShaderDemoteToHelperInvocationFeatures demote{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_DEMOTE_TO_HELPER_INVOCATION_FEATURES, &rendering};
  VkPhysicalDeviceSynchronization2Features synchronization{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES,
                                                           &demote};
  VkPhysicalDeviceTimelineSemaphoreFeatures timeline{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES,
                                                     &synchronization};
  VkPhysicalDeviceHostQueryResetFeatures reset{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES, &timeline};
  VkPhysicalDeviceDescriptorIndexingFeatures indexing{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DESCRIPTOR_INDEXING_FEATURES,
                                                      &reset};
  VkPhysicalDeviceScalarBlockLayoutFeatures scalar{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SCALAR_BLOCK_LAYOUT_FEATURES,
                                                   &indexing};
  VkPhysicalDeviceBufferDeviceAddressFeatures address{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
                                                      &scalar};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &address};
  features.features.shaderInt64 = features.features.shaderStorageImageReadWithoutFormat =
      features.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  maintenance.maintenance4 = rendering.dynamicRendering = demote.shaderDemoteToHelperInvocation =
      synchronization.synchronization2 = timeline.timelineSemaphore = reset.hostQueryReset = scalar.scalarBlockLayout =
          address.bufferDeviceAddress = VK_TRUE;
  indexing.runtimeDescriptorArray = indexing.shaderSampledImageArrayNonUniformIndexing =
      indexing.descriptorBindingPartiallyBound = VK_TRUE;
  WeirHost info = host.info();
  info.features = &features;
  EXPECT_EQ(weirMissing(host.weir(), &info, nullptr), WEIR_OK) << host.message();
  EXPECT_EQ(host.lines(), (std::vector<std::string>{"Weir needs descriptorBindingVariableDescriptorCount"}));
}

TEST(EmbedDevice, WithoutRaysPassAndFeatureAreNamedAndTheRestRuns) {
  Host host({.adjust = withoutRays});
  const std::string file = sourcePath("graphs/restir_di.json");
  WeirGraphInfo graph{.size = sizeof(WeirGraphInfo), .file = file.c_str(), .width = kWidth, .height = kHeight};
  EXPECT_EQ(weirMissing(host.weir(), &host.info(), &graph), WEIR_OK) << host.message();
  EXPECT_TRUE(anyHas(host.lines(), "pass 'gbuffer' (gbuffer.RayTraced) may trace rays: VK_KHR_acceleration_structure"));
  EXPECT_TRUE(anyHas(host.lines(), "VK_KHR_ray_query"));
  EXPECT_FALSE(anyHas(host.lines(), "tonemap"));

  // The physical device could; this device was made without, so it is not tried.
  try {
    const Node node(host, {.file = file.c_str()});
    ADD_FAILURE() << "a graph that traces was made";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("gbuffer.RayTraced"), std::string::npos) << error.what();
  }
  const char* json = R"({"version": 1, "name": "raster", "passes": { "gbuffer": { "type": "gbuffer.Raster" } },
                         "outputs": { "emission": "gbuffer.emission" } })";
  graph.file = nullptr;
  graph.json = json;
  EXPECT_EQ(weirMissing(host.weir(), &host.info(), &graph), WEIR_OK) << host.message();
  EXPECT_EQ(host.lines(), std::vector<std::string>{});
  Node node(host, {.json = json, .external = Texts{"gbuffer.emission"}});
  const HostImage out = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
  ASSERT_EQ(node.bind("gbuffer.emission", 0, out, kNothing, kStorage), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) { EXPECT_EQ(node.record(commands, 0, 0), WEIR_OK) << host.message(); });
}

/// Only what weirMissing calls indispensable, and ray queries.
void leastWithQueries(VkPhysicalDeviceFeatures2& f, std::vector<const char*>& extensions) {
  f.features = {};
  f.features.shaderInt64 = f.features.shaderStorageImageReadWithoutFormat =
      f.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  auto& v11 = in<VkPhysicalDeviceVulkan11Features>(f, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
  v11 = {v11.sType, v11.pNext};
  auto& v12 = in<VkPhysicalDeviceVulkan12Features>(f, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  v12 = {v12.sType, v12.pNext};
  v12.bufferDeviceAddress = v12.scalarBlockLayout = v12.descriptorIndexing = v12.runtimeDescriptorArray =
      v12.shaderSampledImageArrayNonUniformIndexing = v12.descriptorBindingPartiallyBound =
          v12.descriptorBindingVariableDescriptorCount = v12.hostQueryReset = v12.timelineSemaphore = VK_TRUE;
  auto& v13 = in<VkPhysicalDeviceVulkan13Features>(f, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  v13 = {v13.sType, v13.pNext};
  v13.synchronization2 = v13.maintenance4 = v13.shaderDemoteToHelperInvocation = v13.dynamicRendering = VK_TRUE;
  in<VkPhysicalDeviceRayTracingPipelineFeaturesKHR>(f,
                                                    VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR)
      .rayTracingPipeline = VK_FALSE;
  withoutExtensions(extensions, {VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME});
  // The structure of an extension that is off may not be in the chain.
  auto* s = reinterpret_cast<VkBaseOutStructure*>(&f);
  while (s->pNext != nullptr) {
    if (s->pNext->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR)
      s->pNext = s->pNext->pNext;
    else
      s = s->pNext;
  }
}

TEST(EmbedDevice, WithTheLeastAndRayQueriesGraphsRun) {
  Host host({.adjust = leastWithQueries});
  const std::string file = sourcePath("graphs/restir_di.json");
  WeirGraphInfo graph{.size = sizeof(WeirGraphInfo), .file = file.c_str(), .width = kWidth, .height = kHeight};
  EXPECT_EQ(weirMissing(host.weir(), &host.info(), &graph), WEIR_OK) << host.message();
  EXPECT_EQ(host.lines(), std::vector<std::string>{});
  graph.trace = "pipeline";
  EXPECT_EQ(weirMissing(host.weir(), &host.info(), &graph), WEIR_OK) << host.message();
  EXPECT_TRUE(anyHas(host.lines(), "VK_KHR_ray_tracing_pipeline"));
  EXPECT_THROW(Node(host, {.file = file.c_str(), .trace = "pipeline"}), std::runtime_error);
  Node traced(host, {.file = file.c_str(), .external = Texts{"tonemap.color"}});
  Node drawn(host, {.json = R"({"version": 1, "name": "raster", "passes": { "gbuffer": { "type": "gbuffer.Raster" } },
                                "outputs": { "emission": "gbuffer.emission" } })",
                    .external = Texts{"gbuffer.emission"}});
  const HostImage out = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight),
                  other = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
  ASSERT_EQ(traced.bind("tonemap.color", 0, out, kNothing, kStorage), WEIR_OK) << host.message();
  ASSERT_EQ(drawn.bind("gbuffer.emission", 0, other, kNothing, kStorage), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    EXPECT_EQ(traced.record(commands, 0, 0), WEIR_OK) << host.message();
    EXPECT_EQ(drawn.record(commands, 0, 0), WEIR_OK) << host.message();
  });
}

TEST(EmbedDevice, NamesAndLabelsOnlyWhereTheInstanceHasDebugUtils) {
  {
    Host host({.debugUtils = false});
    const int names = watched().names, labels = watched().labels;
    EXPECT_EQ(MeanNode(host).meanWith(1.0f), 2.0f);
    EXPECT_EQ(watched().names, names);
    EXPECT_EQ(watched().labels, labels);
  }
  Host host;  // the pointers serve an instance that came later and has it
  const int names = watched().names, labels = watched().labels;
  EXPECT_EQ(MeanNode(host).meanWith(1.0f), 2.0f);
  EXPECT_GT(watched().names, names);
  EXPECT_GT(watched().labels, labels);
}

PFN_vkVoidFunction VKAPI_PTR foreign(VkInstance, const char*) {
  return nullptr;
}

TEST(EmbedDevice, AnotherLoaderIsRefused) {
  Host host;
  WeirHost info = host.info();
  info.getInstanceProcAddr = foreign;
  WeirContext* context = nullptr;
  EXPECT_EQ(weirCreateContext(host.weir(), &info, &context), WEIR_FAILED);
  EXPECT_NE(host.message().find("another Vulkan loader"), std::string::npos) << host.message();
}

TEST(EmbedLifetime, ParentsStayWhileTheirChildrenDo) {
  Host host;
  {
    MeanNode node(host);
    EXPECT_EQ(weirDestroyScene(node.scene()), WEIR_IN_USE);
    EXPECT_EQ(weirDestroyContext(host.context()), WEIR_IN_USE);
    EXPECT_NE(host.message().find("scene"), std::string::npos) << host.message();
    EXPECT_EQ(weirClose(host.weir()), WEIR_IN_USE);
    EXPECT_EQ(node.meanWith(1.0f), 2.0f);
  }
  EXPECT_EQ(weirDestroyGraph(nullptr), WEIR_OK);
  EXPECT_EQ(weirDestroyScene(nullptr), WEIR_OK);
  EXPECT_EQ(weirDestroyContext(nullptr), WEIR_OK);
  EXPECT_EQ(weirClose(nullptr), WEIR_OK);
}

TEST(EmbedCalls, NullAndWrongSizesAreRefused) {
  Host host;
  MeanNode node(host);
  EXPECT_EQ(weirSet(nullptr, Texts{"a.b=1"}), WEIR_BAD_INPUT);
  EXPECT_EQ(weirRecord(node.graph(), VK_NULL_HANDLE, nullptr), WEIR_BAD_INPUT);
  EXPECT_EQ(weirEnable(node.graph(), nullptr, 1), WEIR_BAD_INPUT);
  WeirFrame frame{};
  EXPECT_EQ(weirRecord(node.graph(), VK_NULL_HANDLE, &frame), WEIR_BAD_INPUT);
  EXPECT_NE(host.message().find("WeirFrame.size is 0"), std::string::npos) << host.message();
  frame.size = sizeof frame;
  EXPECT_EQ(weirRecord(node.graph(), VK_NULL_HANDLE, &frame), WEIR_BAD_INPUT);
  const WeirOpenInfo open{};
  Weir* weir = nullptr;
  EXPECT_EQ(weirOpen(&open, &weir), WEIR_BAD_INPUT);
  EXPECT_EQ(weirOpen(nullptr, nullptr), WEIR_BAD_INPUT);
  const WeirSceneInfo scene{.size = sizeof(WeirSceneInfo)};
  WeirScene* made = nullptr;
  EXPECT_EQ(weirCreateScene(host.context(), &scene, &made), WEIR_BAD_INPUT);
  EXPECT_NE(host.message().find("WeirSceneInfo.file"), std::string::npos) << host.message();
  EXPECT_EQ(weirCreateScene(host.context(), &scene, nullptr), WEIR_BAD_INPUT);
  EXPECT_EQ(weirMissing(host.weir(), nullptr, nullptr), WEIR_BAD_INPUT);
}

}  // namespace
}  // namespace weir::test
