# kr3_target(<target>): the language level and the warnings every KR3 target gets.
function(kr3_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wold-style-cast
    -fmacro-prefix-map=${CMAKE_SOURCE_DIR}/=)           # short paths in errors and logs
  target_link_options(${target} PRIVATE -Wl,--no-undefined) # a core that calls ROS fails to link
  if(KR3_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# kr3_node(<name> SOURCES ... LIBRARIES ...): an executable found by `rosrun <package> <name>`. The target kr3_nodes builds
# the nodes of all packages and what they need, and no tools.
function(kr3_node name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target ${PROJECT_NAME}_${name}) # catkin_make shares one target namespace
  add_executable(${target} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  kr3_target(${target})
  target_include_directories(${target} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} ${catkin_LIBRARIES})
  add_dependencies(${target} ${catkin_EXPORTED_TARGETS})
  if(NOT TARGET kr3_nodes)
    add_custom_target(kr3_nodes)
  endif()
  add_dependencies(kr3_nodes ${target})
  install(TARGETS ${target} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endfunction()

# kr3_tool(<name> SOURCES ... LIBRARIES ...): a command-line program that needs no ROS, found by rosrun too.
function(kr3_tool name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target ${PROJECT_NAME}_${name})
  add_executable(${target} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  kr3_target(${target})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES})
  install(TARGETS ${target} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endfunction()

# kr3_gtest(<name> SOURCES ... LIBRARIES ...): a unit test without a ROS master. It finds the repository's
# domains/ in the macro KR3_DOMAINS_DIR, and its package's test/ in KR3_TEST_DIR.
function(kr3_gtest name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target ${PROJECT_NAME}_${name})
  catkin_add_gtest(${target} ${ARG_SOURCES})
  kr3_target(${target})
  target_link_libraries(${target} ${ARG_LIBRARIES} gtest_main)
  get_filename_component(package_dir ${CMAKE_CURRENT_SOURCE_DIR} REALPATH)
  get_filename_component(repository_dir ${package_dir}/../.. ABSOLUTE)
  target_compile_definitions(${target} PRIVATE
    KR3_DOMAINS_DIR="${repository_dir}/domains" KR3_TEST_DIR="${package_dir}/test")
endfunction()

# kr3_python_module(<name> SOURCES ... LIBRARIES ...): what `import <name>` finds, without a master, with the types
# of python/<name>-stubs for editors and type checkers. The package finds pybind11 itself.
function(kr3_python_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target ${PROJECT_NAME}_python)
  pybind11_add_module(${target} MODULE NO_EXTRAS ${ARG_SOURCES})
  kr3_target(${target})
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES})
  target_link_options(${target} PRIVATE -Wl,-z,undefs) # the interpreter brings its own symbols
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_PYTHON_DESTINATION})
  install(TARGETS ${target} LIBRARY DESTINATION ${CATKIN_GLOBAL_PYTHON_DESTINATION})
  foreach(file __init__.pyi py.typed)
    configure_file(python/${name}-stubs/${file}
      ${CATKIN_DEVEL_PREFIX}/${CATKIN_GLOBAL_PYTHON_DESTINATION}/${name}-stubs/${file} COPYONLY)
  endforeach()
  install(DIRECTORY python/${name}-stubs DESTINATION ${CATKIN_GLOBAL_PYTHON_DESTINATION})
endfunction()
