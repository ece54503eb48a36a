# weir_plugin(NAME [SOURCES file...] [SHADERS folder] [LIBRARIES library...])
#
# A plugin library, target weir_plugin_NAME, with its manifest and its shaders beside it, ready for --plugin-path in
# CMAKE_LIBRARY_OUTPUT_DIRECTORY or, if that isn't set, in the folder `weir` of the build tree. Installed, it goes where
# Weir's own plugins are: lib/weir. Without SOURCES and SHADERS: every .cpp of plugins/NAME and passes/NAME, and
# shaders/NAME, below the project's folder.
#
# Weir's own plugins are built by this function, and those of others, for whom find_package(weir) brings it.
set(WEIR_PLUGIN_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/manifest.json.in)
function(weir_plugin name)
  cmake_parse_arguments(arg "" "SHADERS" "SOURCES;LIBRARIES" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "weir_plugin(${name}): '${arg_UNPARSED_ARGUMENTS}' is none of SOURCES, SHADERS, LIBRARIES")
  endif()
  if(NOT arg_SOURCES)
    file(GLOB arg_SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/passes/${name}/*.cpp
                                            ${PROJECT_SOURCE_DIR}/plugins/${name}/*.cpp)
  endif()
  if(NOT arg_SHADERS)
    set(arg_SHADERS ${PROJECT_SOURCE_DIR}/shaders/${name})
  endif()
  get_filename_component(arg_SHADERS ${arg_SHADERS} ABSOLUTE)
  set(folder ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  if(NOT folder)
    set(folder ${PROJECT_BINARY_DIR}/weir)
  endif()

  set(target weir_plugin_${name})
  add_library(${target} MODULE ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE weir::framework ${arg_LIBRARIES})
  if(TARGET weir_options)
    target_link_libraries(${target} PRIVATE weir_options)
  endif()
  # A library with symbols that are unique in the process could never be unloaded, so a rebuilt one wouldn't replace it.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/passes)
  set_target_properties(${target} PROPERTIES PREFIX lib OUTPUT_NAME weir_${name} LIBRARY_OUTPUT_DIRECTORY ${folder}
                                             CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                             INSTALL_RPATH $ORIGIN)
  set(WEIR_PLUGIN_NAME ${name})
  configure_file(${WEIR_PLUGIN_TEMPLATE} ${folder}/weir_${name}.json @ONLY)

  include(GNUInstallDirs)
  set(destination ${CMAKE_INSTALL_LIBDIR}/weir)
  install(TARGETS ${target} LIBRARY DESTINATION ${destination})
  install(FILES ${folder}/weir_${name}.json DESTINATION ${destination})
  file(MAKE_DIRECTORY ${folder}/shaders)
  if(IS_DIRECTORY ${arg_SHADERS})
    file(CREATE_LINK ${arg_SHADERS} ${folder}/shaders/${name} SYMBOLIC)
    install(DIRECTORY ${arg_SHADERS}/ DESTINATION ${destination}/shaders/${name})
  endif()
endfunction()
