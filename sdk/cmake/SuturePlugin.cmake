# SPDX-License-Identifier: MIT
#
# suture_add_plugin(NAME SOURCES a.cpp ... [CXX_STANDARD 17] [FOLDER dir])
#
# Builds one shared object per instruction set from the same sources:
#   NAME.so         the baseline of the architecture, always
#   NAME.avx2.so    x86-64-v3 (Haswell and later), on x86-64 only
#   NAME.avx512.so  x86-64-v4 (Skylake-SP and later), on x86-64 only
# SUTURE_INSTRUCTION_SETS leaves some out: with -DSUTURE_INSTRUCTION_SETS=base a build takes a third
# of the time. It holds base, which is the file that scenes name, and any of avx2 and avx512;
# by default all. As a normal variable it applies to a folder.
# In a project that has called enable_testing(), `suture check-model` is the test NAME.check-model.
# They go into <build>/lib/suture/plugins and, on installation, into
# <libdir>/suture/plugins; with FOLDER, into that folder only (plugins of tests). The
# host loads the best one that the processor supports. The objects share no code: an
# inline function compiled for AVX-512 in one of them can never become the copy that
# an older processor executes.
#
# The purpose of each flag:
#   -fno-math-errno, -fno-trapping-math, -fno-signed-zeros  roots and selects become
#       instructions, and a sum may start from zero for free. Values, NaN and
#       infinity follow IEEE 754. -ffast-math is not used: the compiler would assume
#       that no NaN exists, and remove every check for one.
#   -ffp-contract=fast  a*b+c is rounded once where the processor supports it.
#   hidden visibility and plugin.map  suture_plugin_v1 is the only dynamic symbol.
#       No plugin can call into another by accident, and inline statics stay the
#       plugin's own; otherwise glibc would merge them across libraries (STB_GNU_UNIQUE).
#   -z defs  a missing symbol is an error now, not at the first call. Not with the
#       sanitizers of clang, whose symbols are in the program that loads the plugin.
#   --require-defined  so is a missing SUTURE_PLUGIN(...).
include_guard(GLOBAL)
include(GNUInstallDirs)

set(SUTURE_PLUGIN_MAP ${CMAKE_CURRENT_LIST_DIR}/plugin.map CACHE INTERNAL "")
set(SUTURE_PLUGIN_LINK_OPTIONS -Wl,--require-defined=suture_plugin_v1
  -Wl,--version-script=${SUTURE_PLUGIN_MAP})
if(NOT (CMAKE_CXX_FLAGS MATCHES "-fsanitize" AND CMAKE_CXX_COMPILER_ID MATCHES Clang))
  list(PREPEND SUTURE_PLUGIN_LINK_OPTIONS -Wl,-z,defs)
endif()
set(SUTURE_PLUGIN_LINK_OPTIONS ${SUTURE_PLUGIN_LINK_OPTIONS} CACHE INTERNAL "")

set(_suture_sets base)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  list(APPEND _suture_sets avx2 avx512)
endif()
set(SUTURE_KNOWN_INSTRUCTION_SETS ${_suture_sets} CACHE INTERNAL "")
set(SUTURE_INSTRUCTION_SETS ${_suture_sets} CACHE STRING "Instruction sets that plugins are built for")

function(_suture_check_instruction_sets)
  set(unknown ${SUTURE_INSTRUCTION_SETS})
  list(REMOVE_ITEM unknown ${SUTURE_KNOWN_INSTRUCTION_SETS})
  if(unknown OR NOT base IN_LIST SUTURE_INSTRUCTION_SETS)
    message(FATAL_ERROR "SUTURE_INSTRUCTION_SETS is '${SUTURE_INSTRUCTION_SETS}': expected base, or a "
      "list of base and others of ${SUTURE_KNOWN_INSTRUCTION_SETS}")
  endif()
endfunction()

function(_suture_plugin_object target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "CXX_STANDARD;FOLDER" "SOURCES;FLAGS")
  add_library(${target} MODULE ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE suture::sdk)
  target_compile_options(${target} PRIVATE
    $<$<NOT:$<CONFIG:Debug>>:-O3> -fno-math-errno -fno-trapping-math -fno-signed-zeros
    -ffp-contract=fast $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-psabi>
    -Wall -Wextra ${ARG_FLAGS})
  target_link_options(${target} PRIVATE ${SUTURE_PLUGIN_LINK_OPTIONS})
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${target} SUFFIX .so
    C_STANDARD 11 CXX_STANDARD ${ARG_CXX_STANDARD} CXX_EXTENSIONS OFF
    C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LINK_DEPENDS ${SUTURE_PLUGIN_MAP}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/suture/plugins)
  if(ARG_FOLDER)
    set_target_properties(${target} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${ARG_FOLDER})
  else()
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/suture/plugins)
  endif()
endfunction()

function(suture_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "CXX_STANDARD;FOLDER" "SOURCES")
  if(NOT ARG_SOURCES OR ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "suture_add_plugin(${name} SOURCES file... [CXX_STANDARD n] [FOLDER dir]): "
      "got no sources, or did not understand '${ARG_UNPARSED_ARGUMENTS}'")
  endif()
  _suture_check_instruction_sets()
  if(NOT ARG_CXX_STANDARD)
    set(ARG_CXX_STANDARD 17)
  endif()
  set(common CXX_STANDARD ${ARG_CXX_STANDARD} SOURCES ${ARG_SOURCES})
  set(folder ${PROJECT_BINARY_DIR}/lib/suture/plugins)
  if(ARG_FOLDER)
    set(folder ${ARG_FOLDER})
    list(PREPEND common FOLDER ${folder})
  endif()
  _suture_plugin_object(${name} ${common})
  set(avx2 -march=x86-64-v3)
  set(avx512 -march=x86-64-v4 -mprefer-vector-width=512)
  set(others ${SUTURE_KNOWN_INSTRUCTION_SETS})
  list(REMOVE_ITEM others base)
  foreach(set IN LISTS others)
    if(set IN_LIST SUTURE_INSTRUCTION_SETS)
      _suture_plugin_object(${name}.${set} ${common} FLAGS ${${set}})
    else()  # one of an earlier build would be loaded instead of NAME.so
      file(REMOVE ${folder}/${name}.${set}.so)
    endif()
  endforeach()
  if(SUTURE_PROGRAM AND NOT ARG_FOLDER)
    add_test(NAME ${name}.check-model COMMAND ${SUTURE_PROGRAM} check-model
      --output ${CMAKE_CURRENT_BINARY_DIR} $<TARGET_FILE:${name}>)
  endif()
endfunction()
