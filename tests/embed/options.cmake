# A host uses Vulkan by itself, not through Weir. header.c is the proof that the header is C.
find_package(Vulkan REQUIRED)
add_library(test_${name}_header OBJECT embed/header.c)
target_compile_options(test_${name}_header PRIVATE -std=c11 -pedantic -Wall -Wextra -Werror)
target_link_libraries(test_${name}_header PRIVATE weir::framework)
target_sources(test_${name} PRIVATE embed/host.cpp)
target_link_libraries(test_${name} PRIVATE Vulkan::Vulkan test_${name}_header)
add_dependencies(test_${name} weir weir_embed_example weir_plugin_gbuffer weir_plugin_restir_di weir_plugin_output
                 weir_plugin_reference weir_plugin_template)
