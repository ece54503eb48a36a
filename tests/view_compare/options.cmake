target_link_libraries(test_${name} PRIVATE weir_view)
# Their passes and shaders are looked up at run time.
add_dependencies(test_${name} weir_plugin_gbuffer weir_plugin_restir_di weir_plugin_output weir_plugin_reference)
