# These tests write files with the libraries themselves, as other programs would.
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
target_link_libraries(test_image PRIVATE OpenEXR::OpenEXR PNG::PNG)

# `weir compare` against implementations of its figures that share nothing with it.
foreach(other python openimageio published)
  add_test(NAME compare.${other} COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/image/compare_independent.py
                                         ${other} $<TARGET_FILE:weir>)
  set_tests_properties(compare.${other} PROPERTIES SKIP_RETURN_CODE 77 LABELS image TIMEOUT 300)
endforeach()
