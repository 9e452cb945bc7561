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

# Rooms whose loops take little beside what they call are compiled with less optimisation: at -O1 in three
# quarters of the time. With sanitizers, more of them have none, as have the libraries that stand apart: in a
# third of the time, and tests run as long.
set(rooms plugin_host|gradients|scene|build|operations|output|results|steps|run|live)
set(level $<$<CONFIG:Release>:-O1>)
if(SUTURE_SANITIZER)
  string(APPEND rooms "|mesh|images|implicit")
  set(level -O0)
  foreach(target suture_geometry suture_live suture_model_check)
    target_compile_options(${target} PRIVATE -O0)
  endforeach()
endif()
set(unhurried ${sources})
list(FILTER unhurried INCLUDE REGEX "/kernel/(${rooms})/")
list(REMOVE_ITEM sources ${unhurried})
set_target_properties(suture_kernel PROPERTIES SOURCES "${sources}")
add_library(suture_unhurried OBJECT ${unhurried})
set_target_properties(suture_unhurried PROPERTIES UNITY_BUILD_MODE GROUP)
get_target_property(libraries suture_kernel LINK_LIBRARIES)
target_link_libraries(suture_unhurried PRIVATE ${libraries})
target_include_directories(suture_unhurried PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(suture_unhurried PRIVATE ${definitions})
target_compile_options(suture_unhurried PRIVATE ${level})
target_sources(suture_kernel PRIVATE $<TARGET_OBJECTS:suture_unhurried>)

# Headers that most groups include. g++ would warn of what stands in precompiled headers of the system.
if(SUTURE_PRECOMPILES AND SUTURE_SANITIZER)
  foreach(target suture_kernel suture_unhurried)
    target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <functional> <limits> <map> <memory>
      <optional> <span> <sstream> <string> <variant> <vector> ${PROJECT_SOURCE_DIR}/kernel/dynamics/dynamics.hpp)
  endforeach()
  target_precompile_headers(suture_model_check REUSE_FROM suture_unhurried)  # -O0, too
endif()
