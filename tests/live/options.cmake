# Two versions of one plugin, which a test puts in each other's place.
foreach(version 1 2)
  add_library(test_live_plugin_${version} MODULE ${folder}/plugins/paint.cpp)
  target_compile_definitions(test_live_plugin_${version} PRIVATE LIVE_VERSION=${version})
  target_link_libraries(test_live_plugin_${version} PRIVATE weir::framework weir_options)
  set_target_properties(test_live_plugin_${version} PROPERTIES OUTPUT_NAME weir_live_${version} CXX_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests/live/plugins)
  add_dependencies(test_live test_live_plugin_${version})
endforeach()
