# The floor's passes are tested behind others.
add_dependencies(test_passes_floor weir_plugin_gbuffer weir_plugin_restir_di)
