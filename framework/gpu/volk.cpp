// The one definition of Vulkan's entry points, exported to plugins under the names that weir_vulkan_names.h gives them.
#include <weir/gpu/vulkan.h>

#define VOLK_DEFAULT_VISIBILITY
#include <volk.c>
