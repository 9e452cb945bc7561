# Installs this build into PREFIX, builds the project in outside/ against it and
# lets the installed program find the plugin.
# usage: cmake -D BUILD=... -D PREFIX=... -D FLAGS=... -P outside.cmake
cmake_minimum_required(VERSION 3.25)

function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}\nended with ${code}:\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${PREFIX})
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX}/usr)
# Out of sight of the source and build trees: the installed files must do.
file(COPY ${CMAKE_CURRENT_LIST_DIR}/outside DESTINATION ${PREFIX})
must(${CMAKE_COMMAND} -G Ninja -S ${PREFIX}/outside -B ${PREFIX}/outside/build
  -DCMAKE_PREFIX_PATH=${PREFIX}/usr -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=${FLAGS}")
must(${CMAKE_COMMAND} --build ${PREFIX}/outside/build)
# suture_add_plugin() has made the checks of the model a test.
must(${CMAKE_CTEST_COMMAND} --test-dir ${PREFIX}/outside/build --no-tests=error)
# So are those of the models that `suture new-model` writes, and runs of their scenes: all with SUTURE_FULL,
# otherwise three by turns from day to day. The law is outside/ itself, and an example that other tests build.
set(levels springs nodes faces field constraint lips batches c)
set(pages docs/first-scene.md docs/write_a_model.md)
if(NOT "$ENV{SUTURE_FULL}")
  string(TIMESTAMP day "%s")
  math(EXPR day "${day} / 86400")
  if(DEFINED ENV{SUTURE_DAY})  # of ./dev test
    set(day $ENV{SUTURE_DAY})
  endif()
  math(EXPR first "${day} * 3 % 8")
  list(APPEND levels ${levels})
  list(SUBLIST levels ${first} 3 levels)
  if(NOT c IN_LIST levels)  # below
    list(APPEND levels c)
  endif()
  math(EXPR page "${day} % 2")
  list(GET pages ${page} pages)
endif()
foreach(level IN LISTS levels)
  must(${PREFIX}/usr/bin/suture new-model my-${level} --kind ${level} -o ${PREFIX})
  if(NOT out MATCHES "-DCMAKE_PREFIX_PATH=${PREFIX}/usr")
    message(FATAL_ERROR "suture new-model does not say where Suture is:\n${out}")
  endif()
  set(mine ${PREFIX}/my-${level})
  must(${CMAKE_COMMAND} -G Ninja -S ${mine} -B ${mine}/build -DCMAKE_PREFIX_PATH=${PREFIX}/usr
    -DSUTURE_INSTRUCTION_SETS=base "-DCMAKE_CXX_FLAGS=${FLAGS}")
  must(${CMAKE_COMMAND} --build ${mine}/build)
  must(${CMAKE_CTEST_COMMAND} --test-dir ${mine}/build --no-tests=error --output-on-failure)
endforeach()
file(GLOB_RECURSE others ${PREFIX}/my-*/build/*.avx*)
if(others)
  message(FATAL_ERROR "SUTURE_INSTRUCTION_SETS=base has built ${others}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} ${PREFIX}/my-c/build -DSUTURE_INSTRUCTION_SETS=base\\;avx3
  RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE out)
if(code EQUAL 0 OR NOT out MATCHES "SUTURE_INSTRUCTION_SETS is 'base;avx3'")
  message(FATAL_ERROR "an unknown instruction set is not refused:\n${out}")
endif()
# Pages for beginners are followed literally: both with SUTURE_FULL, otherwise by turns.
foreach(page README.md ${pages})
  must(${CMAKE_CURRENT_LIST_DIR}/follow.sh ${CMAKE_CURRENT_LIST_DIR}/../../${page} ${PREFIX}/page
    ${PREFIX}/usr)
endforeach()
must(${CMAKE_COMMAND} --install ${PREFIX}/outside/build --prefix ${PREFIX}/mine)

# The installed program sees its own plugins and, when told where, the outsider.
must(${PREFIX}/usr/bin/suture models)
foreach(model mss-baudet tm-faure)
  if(NOT out MATCHES "${model}")
    message(FATAL_ERROR "the installed suture does not list ${model}:\n${out}")
  endif()
endforeach()
file(GLOB_RECURSE plugin ${PREFIX}/mine/outside-drag.so)
cmake_path(GET plugin PARENT_PATH folder)
set(ENV{SUTURE_PLUGIN_PATH} ${folder})
must(${PREFIX}/usr/bin/suture describe outside-drag)
if(NOT out MATCHES "N s/m")
  message(FATAL_ERROR "suture describe outside-drag does not name the unit of c:\n${out}")
endif()
must(${PREFIX}/usr/bin/suture models)
if(NOT out MATCHES "outside-drag")
  message(FATAL_ERROR "suture models does not list outside-drag:\n${out}")
endif()

# The manual page and the completions are there, and nothing is left in the end.
foreach(file man/man1/suture.1 bash-completion/completions/suture zsh/site-functions/_suture)
  file(SIZE ${PREFIX}/usr/share/${file} size)
  if(size LESS 2000)
    message(FATAL_ERROR "${file} has ${size} bytes only")
  endif()
endforeach()
must(${CMAKE_COMMAND} -D BUILD=${BUILD} -P ${CMAKE_CURRENT_LIST_DIR}/../../apps/uninstall.cmake)
file(GLOB_RECURSE left LIST_DIRECTORIES true ${PREFIX}/usr/*)
if(left)
  message(FATAL_ERROR "uninstall leaves ${left}")
endif()
