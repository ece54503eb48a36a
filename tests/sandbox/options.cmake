add_dependencies(test_${name} weir test_plugin_good test_plugin_throws)
target_compile_definitions(test_${name} PRIVATE TEST_PLUGIN_FOLDER="${CMAKE_BINARY_DIR}/tests/plugins")
