# These tests write files with the libraries themselves, as other programs would.
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
target_link_libraries(test_image PRIVATE OpenEXR::OpenEXR PNG::PNG)
