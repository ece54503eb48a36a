# What every target shares: warnings, sanitizers, the compiler cache, where binaries land.
find_program(WEIR_CCACHE ccache)
if(WEIR_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${WEIR_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${WEIR_CCACHE})
endif()

# Program, framework, plugins and shaders lie beside each other, in the build tree as in a bundle.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_BUILD_RPATH_USE_ORIGIN ON)
set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")

add_library(weir_options INTERFACE)
target_compile_options(weir_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wno-missing-field-initializers
                                              -fno-gnu-unique)  # as weir_plugin.cmake says
if(WEIR_SANITIZE)
  target_compile_options(weir_options INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer
                                                -fno-sanitize-recover=undefined)
  target_link_options(weir_options INTERFACE -fsanitize=address,undefined)
endif()
find_program(WEIR_LLD ld.lld)
if(WEIR_LLD)
  add_link_options(-fuse-ld=lld)
endif()
