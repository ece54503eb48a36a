# Restarts run graphs of the house.
add_dependencies(test_${name} weir_plugin_gbuffer weir_plugin_restir_di weir_plugin_output weir_plugin_reference)
