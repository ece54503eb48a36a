# The pass's parts without a device are tested directly.
target_sources(test_passes_output PRIVATE ${PROJECT_SOURCE_DIR}/passes/output/built_in_config.cpp
                                          ${PROJECT_SOURCE_DIR}/passes/output/shader_text.cpp
                                          ${PROJECT_SOURCE_DIR}/passes/output/view_transform.cpp)
target_include_directories(test_passes_output PRIVATE ${PROJECT_SOURCE_DIR}/passes)
target_link_libraries(test_passes_output PRIVATE OpenColorIO::OpenColorIO)
