# Lists the tests of a GoogleTest executable for ctest, after it is built. Each test of ctest runs one suite, with all
# its cases and parameters, in one process: a separate process for each of 2500 cases would take longer than the cases.
#   cmake -D EXECUTABLE=… -D OUTPUT=… -D PREFIX=… -D LABEL=… -D ALL=… -D TIMEOUT=… -P discover.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${EXECUTABLE} --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," listing "${listing}")
string(REPLACE "\n" ";" lines "${listing}")
set(suites "")
foreach(line ${lines})
  string(REGEX REPLACE " *#.*" "" line "${line}")
  if(line MATCHES "^([A-Za-z0-9_/]+)\\.$")
    set(listed ${CMAKE_MATCH_1})
    string(REGEX REPLACE "/[0-9]+$" "" suite ${listed})  # Suite/0 is one type of a typed suite
    string(REGEX REPLACE "^.*/" "" suite ${suite})  # Instance/Suite is one instance of a parametrised suite
    list(APPEND suites ${suite})
    list(APPEND filter_${suite} "${listed}.*")
  endif()
endforeach()
list(REMOVE_DUPLICATES suites)
set(script "")
foreach(suite ${suites})
  list(JOIN filter_${suite} ":" filter)
  set(label ${LABEL})
  if(suite IN_LIST ALL)
    set(label all)
  endif()
  string(APPEND script "add_test(\"${PREFIX}${suite}\" \"${EXECUTABLE}\" \"--gtest_filter=${filter}\")\n"
    "set_tests_properties(\"${PREFIX}${suite}\" PROPERTIES LABELS ${label} TIMEOUT ${TIMEOUT})\n")
endforeach()
file(WRITE ${OUTPUT} "${script}")
