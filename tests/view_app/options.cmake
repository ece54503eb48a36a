target_link_libraries(test_${name} PRIVATE weir_view)
