// The one definition of Vulkan's entry points: volk is a single header that carries its implementation.
#define VOLK_IMPLEMENTATION
#include <weir/gpu/vulkan.h>
