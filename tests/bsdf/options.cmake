# The picture comes from passes of the house.
add_dependencies(test_${name} weir_plugin_gbuffer weir_plugin_reference)
