target_link_libraries(test_${name} PRIVATE weir_view)
add_dependencies(test_${name} weir_plugin_gbuffer weir_plugin_restir_di weir_plugin_output)
