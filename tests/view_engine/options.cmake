target_link_libraries(test_${name} PRIVATE weir_view)
foreach(plugin gbuffer restir_di output reference)
  add_dependencies(test_${name} weir_plugin_${plugin})
endforeach()
