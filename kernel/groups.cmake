# Where files are compiled together, whole stages are: parsing the headers takes longer than the code
# of a file. A stage of 16 files makes a group; smaller ones are joined to the next.
get_target_property(sources suture_kernel SOURCES)
set(group 0)
set(files)
foreach(stage IN LISTS SUTURE_STAGES)
  set(own ${sources})
  list(FILTER own INCLUDE REGEX "/kernel/${stage}/")
  list(APPEND files ${own})
  set_source_files_properties(${own} PROPERTIES UNITY_GROUP ${group})
  list(LENGTH files count)
  if(count GREATER_EQUAL 16)
    math(EXPR group "${group} + 1")
    set(files)
  endif()
endforeach()

# With sanitizers, rooms without a loop over a body are compiled without optimisation: in a third of the
# time, and tests run as long.
if(NOT SUTURE_SANITIZER)
  return()
endif()
set(unhurried ${sources})
list(FILTER unhurried INCLUDE REGEX
  "/kernel/(plugin_host|mesh|images|scene|build|operations|output|results|steps|run|live)/")
list(REMOVE_ITEM sources ${unhurried})
set_target_properties(suture_kernel PROPERTIES SOURCES "${sources}")
add_library(suture_unhurried OBJECT ${unhurried})
set_target_properties(suture_unhurried PROPERTIES UNITY_BUILD_MODE GROUP)
get_target_property(libraries suture_kernel LINK_LIBRARIES)
target_link_libraries(suture_unhurried PRIVATE ${libraries})
target_include_directories(suture_unhurried PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_options(suture_unhurried PRIVATE -O0)
target_sources(suture_kernel PRIVATE $<TARGET_OBJECTS:suture_unhurried>)
