# volk hides its entry points in the library that holds it by default, because a library that exported variables called
# vkCreateBuffer would come between an application and libvulkan. Plugins need ours, so they are exported under names
# of our own: this writes the header that renames them, from the volk that is installed.
find_path(WEIR_VOLK_INCLUDE volk.h REQUIRED)
file(STRINGS ${WEIR_VOLK_INCLUDE}/volk.h lines REGEX "^extern PFN_vk[A-Za-z0-9]+ vk[A-Za-z0-9]+;")
set(text "// Written by cmake/vulkan_names.cmake from volk.h: Weir's own names for Vulkan's entry points.\n#pragma once\n")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^extern PFN_vk[A-Za-z0-9]+ (vk[A-Za-z0-9]+);.*" "#define \\1 weir_\\1\n" define "${line}")
  string(APPEND text "${define}")
endforeach()
foreach(name Initialize InitializeCustom GetInstanceVersion LoadInstance LoadInstanceOnly LoadDevice GetLoadedInstance
             GetLoadedDevice LoadDeviceTable)
  string(APPEND text "#define volk${name} weir_volk${name}\n")
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/weir_vulkan_names.h CONTENT "${text}" @ONLY)
