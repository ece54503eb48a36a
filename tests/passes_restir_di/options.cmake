# What the tests compare with: formulas from the papers in double precision, and the scenes and surfaces they are asked about.
target_sources(test_passes_restir_di PRIVATE ${folder}/oracle.cpp ${folder}/setup.cpp)
target_include_directories(test_passes_restir_di PRIVATE ${PROJECT_SOURCE_DIR}/passes)
# Tests find the plugins where the build puts them.
add_dependencies(test_passes_restir_di weir_plugin_restir_di weir_plugin_gbuffer weir_plugin_output weir_plugin_reference)
