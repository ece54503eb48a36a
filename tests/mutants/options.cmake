# The bugs and what they are looked for in, shared by the quick test and the program for long runs.
find_package(CLI11 REQUIRED)
set(mutant_sources ${folder}/laboratory.cpp ${folder}/situations.cpp ${folder}/mutants.cpp)
target_sources(test_mutants PRIVATE ${mutant_sources})
add_dependencies(test_mutants weir_plugin_restir_di weir_plugin_gbuffer weir_plugin_output weir_plugin_reference)
add_executable(mutants ${folder}/main.cpp ${mutant_sources})
target_include_directories(mutants PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(mutants PRIVATE weir::framework weir_options weir_test_support CLI11::CLI11 nlohmann_json::nlohmann_json)
