# The program itself and every plugin that it finds beside it.
add_dependencies(test_${name} weir)
file(GLOB cli_plugins CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/plugins/*/CMakeLists.txt)
foreach(cli_plugin IN LISTS cli_plugins)
  get_filename_component(cli_plugin ${cli_plugin} DIRECTORY)
  get_filename_component(cli_plugin ${cli_plugin} NAME)
  add_dependencies(test_${name} weir_plugin_${cli_plugin})
endforeach()

# Whole runs of `weir bench`, one after the other: those that are killed must not be done too soon.
foreach(bench_case schema kill parallel slurm)
  add_test(NAME bench.${bench_case} COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/cli/bench_check.py $<TARGET_FILE:weir>
                                            ${PROJECT_SOURCE_DIR} cpu ${bench_case})
  set_tests_properties(bench.${bench_case} PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77 LABELS cli
                       ENVIRONMENT "WEIR_CACHE_DIR=${CMAKE_BINARY_DIR}/test-cache")
endforeach()
