# The program too, and the page where it can be built.
add_dependencies(test_${name} weir)
if(NOT TARGET weir_chart)
  target_compile_definitions(test_${name} PRIVATE TEST_HAS_PAGE=0)
  return()
endif()
target_compile_definitions(test_${name} PRIVATE TEST_HAS_PAGE=1)
add_dependencies(test_${name} weir_chart)
add_test(NAME chart.modules COMMAND ${WEIR_NODE} --test ${folder}/modules_test.mjs)
add_test(NAME chart.page COMMAND ${WEIR_NODE} ${folder}/page_test.mjs --weir $<TARGET_FILE:weir>
                                 --modules ${CMAKE_BINARY_DIR}/tools/chart/node_modules --python ${Python3_EXECUTABLE})
# Skipped, and said so, where there is no Chromium.
set_tests_properties(chart.page PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300 LABELS chart)
set_tests_properties(chart.modules PROPERTIES LABELS chart)
