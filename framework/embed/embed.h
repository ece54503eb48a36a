// Weir inside an engine that has a Vulkan device already: a graph becomes one node of the host's frame, recorded into
// the host's own command buffer, on the host's images, under the host's synchronization. C11; docs/embedding.md goes
// through it. Implemented in libweir.so.
//
// Conventions
// - Every function returns a status. Nothing is thrown, nothing global is changed; what went wrong is told by
//   weirMessage() of the Weir that the object belongs to, until the next call on that Weir.
// - Structures begin with `size`: sizeof the structure as the caller knows it. All else may be zero unless it says
//   otherwise. Texts are UTF-8, copied; arrays of texts come as pointer and count.
// - A Weir and everything made from it is for one thread at a time. Different Weirs know nothing of each other.
// - Objects are destroyed before the one that they were made from, else WEIR_IN_USE, and nothing has happened.
// Destroying
//   NULL is fine.
// - weirRecord touches no queue, waits for nothing and submits nothing. What creates or changes an object may submit to
//   the queue and wait for that: the host's other threads must leave the queue alone meanwhile.
#ifndef WEIR_EMBED_H
#define WEIR_EMBED_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { WEIR_SLOTS = 2 }; /* frames of one graph in flight */

typedef enum WeirStatus {
  WEIR_OK = 0,
  WEIR_FAILED = 1,    /* the input was fine and the work failed: device lost, out of memory */
  WEIR_BAD_INPUT = 2, /* what was given is wrong; the message says where, and the nearest valid name */
  WEIR_IN_USE = 3,    /* something made from it is still there */
  WEIR_NOT_READY = 4  /* the GPU has not got there yet */
} WeirStatus;

typedef struct Weir Weir;               /* passes found, shaders compiled: needs no device */
typedef struct WeirNeeds WeirNeeds;     /* what a device should be made with */
typedef struct WeirContext WeirContext; /* a device of the host's */
typedef struct WeirScene WeirScene;     /* a scene on it */
typedef struct WeirGraph WeirGraph;     /* a graph over the scene: one node of a frame */

typedef struct WeirTexts {
  const char* const* texts;
  uint32_t count;
} WeirTexts;

/* ------------------------------------------------------------------------------------------------------- Weir */

typedef struct WeirOpenInfo {
  size_t size;
  WeirTexts pluginFolders; /* searched before WEIR_PLUGIN_PATH and the folder of libweir.so */
  const char* cacheFolder; /* compiled shaders and pipelines; NULL: as weir does, "-": nowhere */
} WeirOpenInfo;

/* `info` may be NULL. On failure there is nothing to ask for a message: memory ran out, or `info->size` is wrong. */
WeirStatus weirOpen(const WeirOpenInfo* info, Weir** weir);
WeirStatus weirClose(Weir* weir);
/* Why the last call on this Weir failed; empty when it did not. Valid until the next call. */
const char* weirMessage(const Weir* weir);
/* Lines that the last call left besides its status (each function says which). Valid until the next call. */
WeirTexts weirLines(const Weir* weir);

/* ----------------------------------------------------------------------------------------------------- device */

/* The host's Vulkan objects and what they were made with. Weir owns none of them; they outlive the context. */
typedef struct WeirHost {
  size_t size;
  PFN_vkGetInstanceProcAddr getInstanceProcAddr; /* NULL: libvulkan.so.1's. One Vulkan loader a process */
  VkInstance instance;
  uint32_t apiVersion;          /* VkApplicationInfo::apiVersion: at least VK_API_VERSION_1_3 */
  WeirTexts instanceExtensions; /* with VK_EXT_debug_utils Weir names its objects and labels its passes */
  VkPhysicalDevice physicalDevice;
  VkDevice device;
  VkQueue queue; /* of a family that computes */
  uint32_t queueFamily;
  const VkPhysicalDeviceFeatures2* features; /* VkDeviceCreateInfo::pNext, with whatever else is chained there */
  WeirTexts deviceExtensions;
} WeirHost;

/* What a VkDevice should be made with. Of `host` only getInstanceProcAddr, instance and physicalDevice are looked at.
   Lines: what the physical device lacks of Weir's minimum, none when it will do. */
WeirStatus weirCreateNeeds(Weir* weir, const WeirHost* host, WeirNeeds** needs);
/* A chain for VkDeviceCreateInfo::pNext. The host may switch on more in it, or chain more behind it. */
VkPhysicalDeviceFeatures2* weirNeededFeatures(WeirNeeds* needs);
WeirTexts weirNeededExtensions(const WeirNeeds* needs);
WeirStatus weirDestroyNeeds(WeirNeeds* needs);

/* WEIR_BAD_INPUT when the device was made without Weir's minimum. */
WeirStatus weirCreateContext(Weir* weir, const WeirHost* host, WeirContext** context);
/* Waits until the context's queue is idle. */
WeirStatus weirDestroyContext(WeirContext* context);

/* ------------------------------------------------------------------------------------------------------ scene */

typedef struct WeirSceneInfo {
  size_t size;
  const char* file;           /* glTF */
  uint32_t width, height;     /* of the frame: a camera made to frame the scene asks for its shape; 0: square */
  uint32_t lights, lightSeed; /* so many generated point lights, for scenes without any; seed 0: 1 */
  uint32_t replaceLights;     /* not 0: take the scene's own away */
  const char* environment;    /* .exr or .hdr */
  float environmentScale, environmentRotation; /* scale 0: 1; degrees */
  const char* camera;                          /* as `weir render --camera`; NULL: the scene's first */
  uint32_t animate;                            /* not 0: frame i shows the clip at startTime + i * timeStep */
  const char* clip;                            /* NULL: the first */
  double startTime, timeStep;                  /* seconds */
  uint32_t energyCompensation;                 /* not 0: as `weir render --energy-compensation` */
} WeirSceneInfo;

/* Lines: what of the file was left out or mended. */
WeirStatus weirCreateScene(WeirContext* context, const WeirSceneInfo* info, WeirScene** scene);
WeirStatus weirDestroyScene(WeirScene* scene);

/* ------------------------------------------------------------------------------------------------------ graph */

typedef struct WeirGraphInfo {
  size_t size;
  const char* file;       /* JSON; or */
  const char* json;       /* the text itself */
  uint32_t width, height; /* of the frame */
  WeirTexts set;          /* "pass.parameter=value", as --set */
  WeirTexts enable, disable;
  WeirTexts provided; /* "pass.port" or "pass.port@previous": content of the host's, so that the pass need not run */
  WeirTexts external; /* "pass.port": written into the host's image or buffer */
  const char* trace;  /* "auto" (NULL), "pipeline" or "query" */
} WeirGraphInfo;

/* Lines: what the device that `host` describes lacks, for Weir at all and, where `graph` is not NULL, for each pass
   that would run. None: it will do. Builds nothing; `host->device` need not exist yet. */
WeirStatus weirMissing(Weir* weir, const WeirHost* host, const WeirGraphInfo* graph);

/* Compiles everything; says all that is wrong with the graph at once. */
WeirStatus weirCreateGraph(WeirScene* scene, const WeirGraphInfo* info, WeirGraph** graph);
/* No frame of it may be in flight. */
WeirStatus weirDestroyGraph(WeirGraph* graph);

/* Changes between two frames, while earlier frames may be in flight. When one fails, the graph is as it was. History
   goes on wherever pass, layout and size stay; where a value is compiled into shaders, the change takes as long as
   compiling them does. */
WeirStatus weirSet(WeirGraph* graph, WeirTexts set);
WeirStatus weirEnable(WeirGraph* graph, const char* pass, uint32_t enabled);
/* History starts anew, and every image and buffer of the host's has to be bound again. */
WeirStatus weirResize(WeirGraph* graph, uint32_t width, uint32_t height);
/* The next frame starts without a past. */
WeirStatus weirResetHistory(WeirGraph* graph);

/* ------------------------------------------------------------------------------------- the host's images and buffers
 */

/* What the graph expects in a place of the host's. */
typedef struct WeirPort {
  size_t size;            /* filled in by the caller, as everywhere */
  VkFormat format;        /* VK_FORMAT_UNDEFINED: a buffer */
  uint32_t width, height; /* images; for buffers with elements per pixel, of what they cover */
  uint64_t bytes;         /* buffers: at least so many */
  uint32_t written;       /* 1: the graph writes it; 0: it reads it */
} WeirPort;

/* `name`: one of `provided` or `external`. Lines: the names of all. */
WeirStatus weirDescribePort(WeirGraph* graph, const char* name, WeirPort* port);

/* What the host did last before the node, or does first behind it. */
typedef struct WeirAccess {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
  VkImageLayout layout; /* images */
} WeirAccess;

/* The graph's node begins with a barrier from `before` to its own use (layout GENERAL) and ends with one to `after`.
   `before.layout` may be UNDEFINED where the graph writes all of it. One image may stand for two ports of a slot when
   both are only read and it is handed over in the same way for both. */
typedef struct WeirImage {
  size_t size;
  const char* name;
  uint32_t slot; /* below WEIR_SLOTS; its last recorded frame must be done */
  VkImage image; /* one level, one layer, exclusive to the queue's family */
  VkImageView view;
  VkFormat format;
  uint32_t width, height;
  VkImageUsageFlags usage; /* VK_IMAGE_USAGE_STORAGE_BIT among them */
  WeirAccess before, after;
} WeirImage;

typedef struct WeirBuffer {
  size_t size;
  const char* name;
  uint32_t slot;
  VkBuffer buffer;
  uint64_t bytes;           /* of the whole buffer */
  VkBufferUsageFlags usage; /* VK_BUFFER_USAGE_STORAGE_BUFFER_BIT among them */
  WeirAccess before, after; /* `layout` means nothing here */
} WeirBuffer;

/* Bound until bound anew, the graph is resized, or a change does away with the port. */
WeirStatus weirBindImage(WeirGraph* graph, const WeirImage* image);
WeirStatus weirBindBuffer(WeirGraph* graph, const WeirBuffer* buffer);

/* ------------------------------------------------------------------------------------------------------ frame */

typedef struct WeirCamera {
  float eye[3];      /* metres; right-handed, +Y up */
  float forward[3];  /* any length */
  float up[3];       /* any length; need not be orthogonal to forward, nor may it be parallel */
  float verticalFov; /* radians */
} WeirCamera;

typedef struct WeirFrame {
  size_t size;
  uint32_t slot;            /* the frame last recorded for it must be done on the GPU */
  uint32_t index, seed;     /* keys of the random numbers */
  uint32_t cut;             /* not 0: the camera jumped, so there is no past */
  const WeirCamera* camera; /* NULL: the scene's, where its clip has taken it */
  const double* time;       /* seconds into the clip; NULL: by index */
  VkQueryPool queries;      /* timestamps; VK_NULL_HANDLE: none */
  uint32_t firstQuery;      /* the first of as many as weirDescribePasses says */
} WeirFrame;

/* Records the node, outside of a render pass, into a buffer that is submitted once, to the context's queue, in the
   order in which the frames of a graph were recorded. On WEIR_BAD_INPUT nothing was recorded; on WEIR_FAILED the buffer
   is to be thrown away. */
WeirStatus weirRecord(WeirGraph* graph, VkCommandBuffer commands, const WeirFrame* frame);

/* Lines: names of the passes that run, in order. `queries`, when not NULL: how many a frame's timestamps take. */
WeirStatus weirDescribePasses(WeirGraph* graph, uint32_t* queries);
/* Milliseconds of each pass of the last frame that was recorded with these queries, in that order, into `milliseconds`,
   which has room for `count`. Does not wait: WEIR_NOT_READY until they are there. */
WeirStatus weirReadTimes(WeirGraph* graph, VkQueryPool queries, uint32_t firstQuery, double* milliseconds,
                         uint32_t count);

#ifdef __cplusplus
}
#endif

#endif
