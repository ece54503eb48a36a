# cmake --install: a tree that works wherever it is moved to. Plugins have their install rules from weir_plugin().
#
#   bin/weir  lib/libweir.so  lib/weir/{libweir_*.so,weir_*.json,shaders}  lib/cmake/weir
#   include/weir  share/weir/{graphs,scenes}
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/weir)
install(TARGETS weir_framework EXPORT weirTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS weir weir-view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/common ${PROJECT_SOURCE_DIR}/shaders/view DESTINATION ${CMAKE_INSTALL_LIBDIR}/weir/shaders)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/graphs DESTINATION ${CMAKE_INSTALL_DATADIR}/weir FILES_MATCHING PATTERN *.json)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/weir
        FILES_MATCHING PATTERN *.glb PATTERN *.hdr)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/weir)

# Without the headers that only their own room includes: they need what the packages of a user don't have.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/framework/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/weir
        FILES_MATCHING PATTERN *.h
        PATTERN gpu/vma.h EXCLUDE PATTERN gpu/probe.h EXCLUDE PATTERN graph/checked.h EXCLUDE
        PATTERN graph/json_tree.h EXCLUDE PATTERN chart/place.h EXCLUDE PATTERN chart/configuration.h EXCLUDE PATTERN image/exr_guard.h EXCLUDE PATTERN scene/gltf_*.h EXCLUDE
        PATTERN embed/objects.h EXCLUDE PATTERN embed/call.h EXCLUDE)
install(FILES ${CMAKE_BINARY_DIR}/generated/weir_vulkan_names.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# The layouts that plugins share: <weir/passes/common/layouts.h>.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/passes/common DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/weir/passes
        FILES_MATCHING PATTERN *.h)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/weirConfig.cmake.in ${CMAKE_BINARY_DIR}/package/weirConfig.cmake
                              INSTALL_DESTINATION ${package})
# Plugins are rebuilt for each release.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/weirConfigVersion.cmake COMPATIBILITY ExactVersion)
install(EXPORT weirTargets NAMESPACE weir:: DESTINATION ${package})
install(FILES ${CMAKE_BINARY_DIR}/package/weirConfig.cmake ${CMAKE_BINARY_DIR}/package/weirConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/weir_plugin.cmake ${CMAKE_CURRENT_LIST_DIR}/manifest.json.in
        DESTINATION ${package})
