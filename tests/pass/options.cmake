# Small plugins, most of them wrong in one way, each in a folder of its own with its manifest.
set(TEST_PLUGIN_FOLDER ${CMAKE_BINARY_DIR}/tests/plugins)
function(add_test_plugin target plugin folder source)
  add_library(${target} MODULE ${source})
  target_link_libraries(${target} PRIVATE weir::framework weir_options)
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME weir_${plugin} LIBRARY_OUTPUT_DIRECTORY ${TEST_PLUGIN_FOLDER}/${folder}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  set(WEIR_PLUGIN_NAME ${plugin})
  configure_file(${WEIR_PLUGIN_TEMPLATE} ${TEST_PLUGIN_FOLDER}/${folder}/weir_${plugin}.json @ONLY)
endfunction()
file(GLOB plugin_sources CONFIGURE_DEPENDS ${folder}/plugins/*.cpp)
foreach(source IN LISTS plugin_sources)
  get_filename_component(plugin ${source} NAME_WE)
  add_test_plugin(test_plugin_${plugin} ${plugin} ${plugin} ${source})
  add_dependencies(test_${name} test_plugin_${plugin})
endforeach()
# One plugin in several versions. Visible to all, as a plugin that isn't built by weir_plugin() may be: then only
# -fno-gnu-unique lets it go.
file(GLOB plugin_sources CONFIGURE_DEPENDS ${folder}/plugins/reload/*.cpp)
foreach(source IN LISTS plugin_sources)
  get_filename_component(version ${source} NAME_WE)
  add_test_plugin(test_plugin_reload_${version} reload reload-${version} ${source})
  set_target_properties(test_plugin_reload_${version} PROPERTIES CXX_VISIBILITY_PRESET default VISIBILITY_INLINES_HIDDEN OFF)
  add_dependencies(test_${name} test_plugin_reload_${version})
endforeach()
# Found by the plugin through a run path that is relative to it.
add_library(test_plugin_helper SHARED ${folder}/plugins/helper/helper.cpp)
set_target_properties(test_plugin_helper PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${TEST_PLUGIN_FOLDER}/with_helper)
target_link_libraries(test_plugin_with_helper PRIVATE test_plugin_helper)
set_target_properties(test_plugin_with_helper PROPERTIES BUILD_RPATH "$ORIGIN;$ORIGIN/../its_own")
target_compile_definitions(test_${name} PRIVATE TEST_PLUGIN_FOLDER="${TEST_PLUGIN_FOLDER}")
