# The tests write compressed files with the libraries that the importer reads them with.
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
target_link_libraries(test_scene PRIVATE draco::draco meshoptimizer::meshoptimizer)
