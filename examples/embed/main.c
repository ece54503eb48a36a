/* A host that has Weir in its frame: three nodes, two frames in flight, everything its own.
 *
 *   motion    the host's: what moved since the last frame. Here nothing did, so it is a clear; an engine has this
 * already weir      a graph that reads the host's motion instead of its own and writes the host's picture compose   the
 * host's: the picture into a frame
 *
 * The last frame is written as a PFM. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <weir/embed/embed.h>

#include "host.h"

enum { kBorder = 4 };
static const float kBorderColor[4] = {0.25f, 0.5f, 0.75f, 1.0f};

typedef struct Options {
  const char *graph, *scene, *out, *device;
  uint32_t width, height, frames, seed;
  int validate;
} Options;

/* What a frame in flight has for itself. */
typedef struct Slot {
  VkCommandPool pool;
  VkCommandBuffer commands;
  VkFence fence;
  Image motion, picture;
} Slot;

typedef struct Engine {
  Options options;
  Host host;
  Weir* weir;
  WeirContext* context;
  WeirScene* scene;
  WeirGraph* graph;
  Slot slots[kFramesInFlight];
  Image composed; /* of the frame that was submitted last */
  Readback readback;
  VkQueryPool queries;
  uint32_t queriesPerFrame;
} Engine;

/* The one place where a failing Weir call ends up. */
static void weirMust(const Engine* e, WeirStatus status, const char* what) {
  if (status == WEIR_OK) return;
  fprintf(stderr, "%s: %s\n", what, weirMessage(e->weir));
  exit(status == WEIR_BAD_INPUT ? 2 : 1);
}
#define WEIR(call) weirMust(e, (call), #call)

static const char* const kProvided[] = {"gbuffer.motion"};
static const char* const kExternal[] = {"tonemap.color"};

/* Asks what to switch on, makes the device so, and asks whether the graph will run on it. */
static WeirHost makeWeirDevice(Engine* e, WeirNeeds** needs, const WeirGraphInfo* graph) {
  static const char* const kDebugUtils[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  WeirHost host = {.size = sizeof host,
                   .getInstanceProcAddr = vkGetInstanceProcAddr,
                   .instance = e->host.instance,
                   .apiVersion = VK_API_VERSION_1_3,
                   .instanceExtensions = {kDebugUtils, e->options.validate ? 1 : 0},
                   .physicalDevice = e->host.physical,
                   .queueFamily = e->host.queueFamily};
  WEIR(weirCreateNeeds(e->weir, &host, needs));
  host.features = weirNeededFeatures(*needs);
  host.deviceExtensions = weirNeededExtensions(*needs);
  WEIR(weirMissing(e->weir, &host, graph));
  const WeirTexts missing = weirLines(e->weir);
  for (uint32_t i = 0; i < missing.count; ++i) fprintf(stderr, "the device lacks: %s\n", missing.texts[i]);
  if (missing.count > 0) exit(1);
  makeDevice(&e->host, host.features, host.deviceExtensions.texts, host.deviceExtensions.count);
  host.device = e->host.device;
  host.queue = e->host.queue;
  return host;
}

static void startWeir(Engine* e) {
  const Options* o = &e->options;
  if (weirOpen(NULL, &e->weir) != WEIR_OK) exit(1);
  const WeirGraphInfo graph = {.size = sizeof graph,
                               .file = o->graph,
                               .width = o->width,
                               .height = o->height,
                               .provided = {kProvided, 1},
                               .external = {kExternal, 1}};
  WeirNeeds* needs = NULL;
  const WeirHost host = makeWeirDevice(e, &needs, &graph);
  WEIR(weirCreateContext(e->weir, &host, &e->context));
  weirDestroyNeeds(needs);
  const WeirSceneInfo scene = {.size = sizeof scene, .file = o->scene, .width = o->width, .height = o->height};
  WEIR(weirCreateScene(e->context, &scene, &e->scene));
  WEIR(weirCreateGraph(e->scene, &graph, &e->graph));
}

static const Use kNothing = {VK_PIPELINE_STAGE_2_NONE, 0, VK_IMAGE_LAYOUT_UNDEFINED};
static const Use kCleared = {VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
static const Use kCopiedTo = {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
static const Use kCopiedFrom = {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};

static WeirAccess access(Use use) {
  const WeirAccess a = {use.stages, use.access, use.layout};
  return a;
}

/* Makes the image that a port of the graph asks for, and tells Weir how it is handed over and wanted back. */
static Image makePortImage(Engine* e, const char* name, uint32_t slot, VkImageUsageFlags usage, Use before, Use after) {
  WeirPort port = {.size = sizeof port};
  WEIR(weirDescribePort(e->graph, name, &port));
  const Image image = makeImage(&e->host, port.format, port.width, port.height, usage | VK_IMAGE_USAGE_STORAGE_BIT);
  const WeirImage binding = {.size = sizeof binding,
                             .name = name,
                             .slot = slot,
                             .image = image.image,
                             .view = image.view,
                             .format = image.format,
                             .width = image.width,
                             .height = image.height,
                             .usage = image.usage,
                             .before = access(before),
                             .after = access(after)};
  WEIR(weirBindImage(e->graph, &binding));
  return image;
}

static void makeSlots(Engine* e) {
  for (uint32_t s = 0; s < kFramesInFlight; ++s) {
    Slot* slot = &e->slots[s];
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = e->host.queueFamily};
    VK(vkCreateCommandPool(e->host.device, &pool, NULL, &slot->pool));
    const VkCommandBufferAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = slot->pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
    VK(vkAllocateCommandBuffers(e->host.device, &allocate, &slot->commands));
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                     .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    VK(vkCreateFence(e->host.device, &fence, NULL, &slot->fence));
    slot->motion = makePortImage(e, kProvided[0], s, VK_IMAGE_USAGE_TRANSFER_DST_BIT, kCleared, kCleared);
    slot->picture = makePortImage(e, kExternal[0], s, VK_IMAGE_USAGE_TRANSFER_SRC_BIT, kNothing, kCopiedFrom);
  }
  const Image* picture = &e->slots[0].picture;
  e->composed = makeImage(&e->host, picture->format, picture->width + 2 * kBorder, picture->height + 2 * kBorder,
                          VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT);
  e->readback = makeReadback(&e->host, (VkDeviceSize)16 * e->composed.width * e->composed.height);
  WEIR(weirDescribePasses(e->graph, &e->queriesPerFrame));
  const VkQueryPoolCreateInfo queries = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                         .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                         .queryCount = kFramesInFlight * e->queriesPerFrame};
  VK(vkCreateQueryPool(e->host.device, &queries, NULL, &e->queries));
}

/* The first node. An engine that draws its own motion vectors has the pass that does so here. */
static void recordMotion(const Slot* slot) {
  const Use before = {VK_PIPELINE_STAGE_2_CLEAR_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
  const VkClearColorValue still = {{0, 0, 0, 0}};
  const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  barrier(slot->commands, &slot->motion, before, kCleared);
  vkCmdClearColorImage(slot->commands, slot->motion.image, kCleared.layout, &still, 1, &all);
}

/* The last node: a border of the host's and the node's picture inside. The picture comes back ready to be copied. */
static void recordCompose(const Engine* e, const Slot* slot) {
  VkClearColorValue border;
  memcpy(border.float32, kBorderColor, sizeof kBorderColor);
  const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  /* The frame before read it; what was in it is not wanted. */
  const Use before = {VK_PIPELINE_STAGE_2_COPY_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
  barrier(slot->commands, &e->composed, before, kCleared);
  vkCmdClearColorImage(slot->commands, e->composed.image, kCleared.layout, &border, 1, &all);
  barrier(slot->commands, &e->composed, kCleared, kCopiedTo);
  const VkImageSubresourceLayers layer = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  const VkImageCopy copy = {.srcSubresource = layer,
                            .dstSubresource = layer,
                            .dstOffset = {kBorder, kBorder, 0},
                            .extent = {slot->picture.width, slot->picture.height, 1}};
  vkCmdCopyImage(slot->commands, slot->picture.image, kCopiedFrom.layout, e->composed.image, kCopiedTo.layout, 1,
                 &copy);
  barrier(slot->commands, &e->composed, kCopiedTo, kCopiedFrom);
}

/* On a screen this would be a swapchain; here the last frame goes to memory that the program reads. */
static void recordReadback(const Engine* e, const Slot* slot) {
  const VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                  .imageExtent = {e->composed.width, e->composed.height, 1}};
  vkCmdCopyImageToBuffer(slot->commands, e->composed.image, kCopiedFrom.layout, e->readback.buffer, 1, &copy);
  const VkMemoryBarrier2 toHost = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
  const VkDependencyInfo info = {
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &toHost};
  vkCmdPipelineBarrier2(slot->commands, &info);
}

static void frame(Engine* e, uint32_t index) {
  const uint32_t s = index % kFramesInFlight;
  Slot* slot = &e->slots[s];
  VK(vkWaitForFences(e->host.device, 1, &slot->fence, VK_TRUE, UINT64_MAX));
  VK(vkResetFences(e->host.device, 1, &slot->fence));
  VK(vkResetCommandPool(e->host.device, slot->pool, 0));
  const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                          .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  VK(vkBeginCommandBuffer(slot->commands, &begin));
  recordMotion(slot);
  const WeirFrame node = {.size = sizeof node,
                          .slot = s,
                          .index = index,
                          .seed = e->options.seed,
                          .queries = e->queries,
                          .firstQuery = s * e->queriesPerFrame};
  WEIR(weirRecord(e->graph, slot->commands, &node));
  recordCompose(e, slot);
  if (index + 1 == e->options.frames) recordReadback(e, slot);
  VK(vkEndCommandBuffer(slot->commands));
  const VkCommandBufferSubmitInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                              .commandBuffer = slot->commands};
  const VkSubmitInfo2 submit = {
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commands};
  VK(vkQueueSubmit2(e->host.queue, 1, &submit, slot->fence));
}

static void printTimes(Engine* e) {
  const uint32_t slot = (e->options.frames - 1) % kFramesInFlight, passes = e->queriesPerFrame - 2;
  double* milliseconds = calloc(passes, sizeof *milliseconds);
  if (milliseconds == NULL) exit(1);
  WEIR(weirReadTimes(e->graph, e->queries, slot * e->queriesPerFrame, milliseconds, passes));
  WEIR(weirDescribePasses(e->graph, NULL));
  const WeirTexts names = weirLines(e->weir);
  for (uint32_t p = 0; p < passes; ++p) printf("%-12s %8.3f ms\n", names.texts[p], milliseconds[p]);
  free(milliseconds);
}

static void writePfm(const Engine* e) {
  FILE* file = fopen(e->options.out, "wb");
  const uint32_t width = e->composed.width, height = e->composed.height;
  int good = file != NULL && fprintf(file, "PF\n%u %u\n-1.0\n", width, height) > 0;
  for (uint32_t y = height; good && y-- > 0;) /* bottom row first */
    for (uint32_t x = 0; good && x < width; ++x)
      good = fwrite(&e->readback.pixels[4 * ((size_t)y * width + x)], sizeof(float), 3, file) == 3;
  if (file == NULL || fclose(file) != 0 || !good) {
    fprintf(stderr, "%s cannot be written\n", e->options.out);
    exit(1);
  }
}

static void stop(Engine* e) {
  VK(vkDeviceWaitIdle(e->host.device));
  WEIR(weirDestroyGraph(e->graph));
  WEIR(weirDestroyScene(e->scene));
  WEIR(weirDestroyContext(e->context));
  WEIR(weirClose(e->weir));
  for (uint32_t s = 0; s < kFramesInFlight; ++s) {
    Slot* slot = &e->slots[s];
    destroyImage(&e->host, &slot->motion);
    destroyImage(&e->host, &slot->picture);
    vkDestroyFence(e->host.device, slot->fence, NULL);
    vkDestroyCommandPool(e->host.device, slot->pool, NULL);
  }
  vkDestroyQueryPool(e->host.device, e->queries, NULL);
  destroyImage(&e->host, &e->composed);
  destroyReadback(&e->host, &e->readback);
  destroyHost(&e->host);
}

static Options readOptions(int argc, char** argv) {
  Options o = {.width = 256, .height = 256, .frames = 16};
  const char** const places[] = {&o.graph, &o.scene, &o.out};
  int next = 0;
  for (int i = 1; i < argc; ++i) {
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (strcmp(argv[i], "--validate") == 0) {
      o.validate = 1;
    } else if (strcmp(argv[i], "--size") == 0 && sscanf(value, "%ux%u", &o.width, &o.height) == 2) {
      ++i;
    } else if (strcmp(argv[i], "--frames") == 0 && sscanf(value, "%u", &o.frames) == 1 && o.frames > 0) {
      ++i;
    } else if (strcmp(argv[i], "--seed") == 0 && sscanf(value, "%u", &o.seed) == 1) {
      ++i;
    } else if (strcmp(argv[i], "--device") == 0 && *value != '\0') {
      o.device = argv[++i];
    } else if (next < 3 && argv[i][0] != '-') {
      *places[next++] = argv[i];
    } else {
      next = -1;
      break;
    }
  }
  if (next == 3) return o;
  fprintf(stderr,
          "usage: %s GRAPH SCENE OUT.pfm [--size WxH] [--frames N] [--seed S] [--device NAME] [--validate]\n"
          "The graph has a pass 'gbuffer' with an output 'motion' and a pass 'tonemap' with an output 'color'.\n",
          argv[0]);
  exit(2);
}

int main(int argc, char** argv) {
  static Engine engine;
  Engine* e = &engine;
  e->options = readOptions(argc, argv);
  makeInstance(&e->host, e->options.validate, e->options.device);
  startWeir(e);
  makeSlots(e);
  for (uint32_t i = 0; i < e->options.frames; ++i) frame(e, i);
  VK(vkDeviceWaitIdle(e->host.device));
  printTimes(e);
  writePfm(e);
  stop(e);
  if (e->host.messages > 0) fprintf(stderr, "%u validation messages\n", e->host.messages);
  return e->host.messages > 0 ? 1 : 0;
}
