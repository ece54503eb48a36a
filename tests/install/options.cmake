# `cmake --install` of this build, and the example that is built against it. Only a release build has no paths in debug
# information to strip.
add_dependencies(test_${name} weir_app)
target_compile_definitions(test_${name} PRIVATE
  TEST_CMAKE="${CMAKE_COMMAND}" TEST_COMPILER="${CMAKE_CXX_COMPILER}" TEST_RELEASE="${PROJECT_VERSION}"
  TEST_INSTALL_OPTIONS="$<$<NOT:$<CONFIG:Release>>:--strip>")
if(TARGET weir_chart)
  add_dependencies(test_${name} weir_chart)
  target_compile_definitions(test_${name} PRIVATE TEST_HAS_PAGE=1)
else()
  target_compile_definitions(test_${name} PRIVATE TEST_HAS_PAGE=0)
endif()
