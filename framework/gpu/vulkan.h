// Vulkan through volk (entry points loaded at run time), and VMA's types.
#pragma once

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <weir_vulkan_names.h>  // first: renames what volk declares, see cmake/vulkan_names.cmake

#include <volk.h>

using VmaAllocator = struct VmaAllocator_T*;
using VmaAllocation = struct VmaAllocation_T*;
