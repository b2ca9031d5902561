# SPDX-License-Identifier: BSD-3-Clause
# Writes a source file with hashes of the code that decides the results of the simulator, of each
# method and of the scorer, and with the commit of this code:
# cmake -DSOURCES=FOLDER -DCOMPILER=TEXT -DOUT=FILE.cpp -P HashCode.cmake
# A hash covers the text of the part's sources and headers, without lines of comments, and COMPILER,
# which says what else decides the code made of them.
cmake_policy(SET CMP0057 NEW)

# What each part consists of: modules, or files with their headers.
set(simulator base world scenes flight sensor dataset stages/simulate_dataset stages/example_scan)
set(method base dataset map estimation loop odometry evaluation/map/reproject
    stages/simulate_dataset stages/run_algorithm stages/run_external
    stages/foreign_program stages/recorder stages/event_record stages/motion_record)
set(scorer base dataset world estimation map evaluation stages/score_run results/run_metrics
    results/trajectory_metrics results/map_metrics results/resource_metrics results/summary
    results/figures results/known_row)

# The names under which a file of a module belongs to a part. A file in a folder of odometry/ is of
# that method alone.
function(names_of file out)
  string(REGEX MATCH "^[a-z]+" module ${file})
  string(REGEX REPLACE "\\.[ch]pp$" "" stem ${file})
  set(names ${module} ${stem})
  if(file MATCHES "^odometry/([a-z0-9_]+)/")
    set(names method/${CMAKE_MATCH_1})
  endif()
  set(${out} ${names} PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE ${SOURCES} ${SOURCES}/*.cpp ${SOURCES}/*.hpp)
list(SORT files)
foreach(file IN LISTS files)
  file(READ ${SOURCES}/${file} text)
  string(REGEX REPLACE "\n *//[^\n]*" "" text "${text}")
  string(SHA256 hash "${text}")
  names_of(${file} names)
  foreach(part IN ITEMS simulator method scorer)
    foreach(name IN LISTS names)
      if(name IN_LIST ${part})
        string(APPEND text_${part} "${hash} ${file}\n")
      endif()
    endforeach()
  endforeach()
  if(names MATCHES "^method/(.*)$")
    list(APPEND methods ${CMAKE_MATCH_1})
    string(APPEND text_of_${CMAKE_MATCH_1} "${hash} ${file}\n")
  endif()
endforeach()

list(REMOVE_DUPLICATES methods)
string(SHA256 simulator_hash "${COMPILER}\n${text_simulator}")
string(SHA256 scorer_hash "${COMPILER}\n${text_scorer}")
string(SHA256 external_hash "${COMPILER}\n${text_method}")
set(json "\"external\": \"${external_hash}\"")
foreach(method IN LISTS methods)
  string(SHA256 hash "${COMPILER}\n${text_method}${text_of_${method}}")
  string(APPEND json ",\n  \"${method}\": \"${hash}\"")
endforeach()

# The commit, unless SOURCES is not the folder of that name in a clone of this project.
set(git git -C ${SOURCES})
execute_process(COMMAND ${git} rev-parse --show-prefix OUTPUT_VARIABLE place OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND ${git} log -1 --format=%h --abbrev=10 OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE
                ERROR_QUIET)
execute_process(COMMAND ${git} diff --quiet HEAD -- . RESULT_VARIABLE changed ERROR_QUIET)
if(NOT place STREQUAL "lidarena/" OR NOT commit)
  set(commit unknown)
elseif(changed)
  string(APPEND commit " with changes")
endif()

file(WRITE ${OUT} "// Written by HashCode.cmake.
#include \"apps/lidarena/code_hashes.hpp\"
namespace lidarena {
const char* const kCodeHashes = R\"({\"simulator\": \"${simulator_hash}\",
 \"scorer\": \"${scorer_hash}\",
 \"methods\": {${json}}})\";
const char* const kCommit = \"${commit}\";
}  // namespace lidarena
")
