target_link_libraries(test_${name} PRIVATE weir_test_ui)
add_dependencies(test_${name} weir_plugin_restir_di weir_plugin_gbuffer weir_plugin_output weir_plugin_reference
                              weir_plugin_template weir_plugin_floor)
