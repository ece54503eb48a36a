# One file a family of closed forms.
file(GLOB forms CONFIGURE_DEPENDS ${folder}/*.cpp)
list(FILTER forms EXCLUDE REGEX "_test\\.cpp$")
target_sources(test_${name} PRIVATE ${forms})
add_dependencies(test_${name} weir_plugin_restir_di weir_plugin_gbuffer weir_plugin_output weir_plugin_reference)
