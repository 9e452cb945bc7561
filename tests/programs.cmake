# Programs of tests, and what CTest knows of them.
include(GoogleTest)

# Headers that most files of tests include, parsed once for all programs, with the options of
# suture_register_test.
if(SUTURE_PRECOMPILES)
  file(CONFIGURE OUTPUT test_headers.cpp CONTENT "int main() {}\n")
  add_executable(test_headers ${CMAKE_CURRENT_BINARY_DIR}/test_headers.cpp)
  target_link_libraries(test_headers PRIVATE suture::sdk GTest::gtest GTest::gmock)
  target_include_directories(test_headers PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(test_headers PRIVATE $<IF:$<BOOL:${SUTURE_SANITIZER}>,-O0,-O1>)
  target_precompile_headers(test_headers PRIVATE <gmock/gmock.h> <gtest/gtest.h> <algorithm> <cmath>
    <cstdlib> <cstring> <filesystem> <fstream> <limits> <map> <random> <set> <sstream> <string> <vector>
    ${PROJECT_SOURCE_DIR}/kernel/run/simulation.hpp)
endif()

# suture_add_test(NAME [TOGETHER] SOURCES ... LIBRARIES ...): one program, one CTest entry
# per GoogleTest case. TOGETHER: no two files define the same name, so that presets that compile
# several files at once may do so.
function(suture_add_test name)
  cmake_parse_arguments(ARG "TOGETHER" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE suture::kernel GTest::gtest_main GTest::gmock ${ARG_LIBRARIES})
  if(NOT ARG_TOGETHER)
    set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  endif()
  if(SUTURE_PRECOMPILES AND NOT "CGAL::CGAL" IN_LIST ARG_LIBRARIES)  # which adds options
    target_precompile_headers(${name} REUSE_FROM test_headers)
    # g++ warns of what std::string does where it is precompiled.
    target_compile_options(${name} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow>)
  endif()
  # What a test loads at run time is there when it runs.
  add_dependencies(${name} suture_run_modules suture_plugins)
  suture_register_test(${name})
endfunction()

# suture_add_plugin_test(NAME FOLDER FILE...): the same without the kernel: a test loads plugins of
# FOLDER itself.
function(suture_add_plugin_test name folder)
  add_executable(${name} ${ARGN})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE suture::sdk GTest::gtest_main GTest::gmock ${CMAKE_DL_LIBS})
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
  target_compile_definitions(${name} PRIVATE SUTURE_PLUGIN_FOLDER="${folder}"
    "INSTRUCTION_SETS=\"$<JOIN:${SUTURE_INSTRUCTION_SETS},+>\"")
  suture_register_test(${name})
endfunction()

function(suture_register_test name)
  # The kernel is what runs long and what sanitizers watch: optimised tests would take twice the
  # time to build.
  target_compile_options(${name} PRIVATE $<IF:$<BOOL:${SUTURE_SANITIZER}>,-O0,-O1>)
  # Where files are compiled together, a name of one is no mistake in another. The preset `dev` looks
  # at each by itself.
  target_compile_options(${name} PRIVATE $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-shadow>)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  # A sanitized program takes longer to start than most cases to run: four processes share its cases.
  if(SUTURE_SANITIZER)
    foreach(part RANGE 3)
      add_test(NAME ${name}.${part} COMMAND ${PROJECT_SOURCE_DIR}/tests/sample.sh $<TARGET_FILE:${name}> ${part} 4)
      set_tests_properties(${name}.${part} PROPERTIES TIMEOUT 7200)  # s, for --full
    endforeach()
    return()
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60)
endfunction()
