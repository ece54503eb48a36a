# The program itself and every plugin that it finds beside it.
add_dependencies(test_${name} weir)
file(GLOB cli_plugins CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/plugins/*/CMakeLists.txt)
foreach(cli_plugin IN LISTS cli_plugins)
  get_filename_component(cli_plugin ${cli_plugin} DIRECTORY)
  get_filename_component(cli_plugin ${cli_plugin} NAME)
  add_dependencies(test_${name} weir_plugin_${cli_plugin})
endforeach()
