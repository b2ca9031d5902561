# SPDX-License-Identifier: BSD-3-Clause
# Writes a source file with hashes of the code that decides the results of the simulator, of each
# method and of the scorer: cmake -DOBJECTS=FILE -DSOURCES=FOLDER -DOUT=FILE.cpp -P HashCode.cmake
# OBJECTS lists the object files of all modules, one a line. An object file has the same bytes
# whenever the same source is built by the same compiler.
cmake_policy(SET CMP0057 NEW)

# What each part consists of: modules, folders of a module, or files.
set(simulator base world scenes flight sensor dataset study/simulate_dataset.cpp study/example_scan.cpp)
set(method base dataset map estimation loop odometry evaluation/map/reproject.cpp
    study/simulate_dataset.cpp study/run_algorithm.cpp study/run_external.cpp)
set(scorer base dataset world estimation map results evaluation study/simulate_dataset.cpp
    study/run_algorithm.cpp)

# The names under which a file of a module belongs to a part. A file in a folder of odometry/ is of
# that method alone.
function(names_of file out)
  string(REGEX MATCH "^[a-z]+" module ${file})
  set(names ${module} ${file})
  if(file MATCHES "^odometry/([a-z0-9_]+)/")
    set(names method/${CMAKE_MATCH_1})
  endif()
  set(${out} ${names} PARENT_SCOPE)
endfunction()

file(STRINGS ${OBJECTS} objects)
foreach(object IN LISTS objects)
  string(REGEX MATCH "lidarena_([a-z]+)\\.dir/(\\./)?(.*)\\.o(bj)?$" found ${object})
  set(file ${CMAKE_MATCH_1}/${CMAKE_MATCH_3})
  if(file STREQUAL "odometry/factory.cpp")
    # The headers of all methods are compiled into it, but only its text counts for each of them.
    set(object ${SOURCES}/${file})
  endif()
  file(SHA256 ${object} hash)
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
string(SHA256 simulator_hash "${text_simulator}")
string(SHA256 scorer_hash "${text_scorer}")
string(SHA256 external_hash "${text_method}")
set(json "\"external\": \"${external_hash}\"")
foreach(method IN LISTS methods)
  string(SHA256 hash "${text_method}${text_of_${method}}")
  string(APPEND json ",\n  \"${method}\": \"${hash}\"")
endforeach()
file(WRITE ${OUT} "// Written by HashCode.cmake.
#include \"apps/lidarena/code_hashes.hpp\"
namespace lidarena {
const char* const kCodeHashes = R\"({\"simulator\": \"${simulator_hash}\",
 \"scorer\": \"${scorer_hash}\",
 \"methods\": {${json}}})\";
}  // namespace lidarena
")
