# Small plugins, most of them wrong in one way, each in a folder of its own with its manifest.
set(TEST_PLUGIN_FOLDER ${CMAKE_BINARY_DIR}/tests/plugins)
file(GLOB plugin_sources CONFIGURE_DEPENDS ${folder}/plugins/*.cpp)
foreach(source IN LISTS plugin_sources)
  get_filename_component(WEIR_PLUGIN_NAME ${source} NAME_WE)
  set(target test_plugin_${WEIR_PLUGIN_NAME})
  add_library(${target} MODULE ${source})
  target_link_libraries(${target} PRIVATE weir::framework weir_options)
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME weir_${WEIR_PLUGIN_NAME} LIBRARY_OUTPUT_DIRECTORY ${TEST_PLUGIN_FOLDER}/${WEIR_PLUGIN_NAME}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  configure_file(${WEIR_PLUGIN_TEMPLATE} ${TEST_PLUGIN_FOLDER}/${WEIR_PLUGIN_NAME}/weir_${WEIR_PLUGIN_NAME}.json @ONLY)
  add_dependencies(test_${name} ${target})
endforeach()
target_compile_definitions(test_${name} PRIVATE TEST_PLUGIN_FOLDER="${TEST_PLUGIN_FOLDER}")
