# SPDX-License-Identifier: BSD-3-Clause
# Installs this build below WORK, moves it, and builds and runs the consumer against it. It must need
# neither the source and build trees nor the original installation folder.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK}/first ${WORK}/moved ${WORK}/consumer)
foreach(component IN ITEMS development program)
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first --component ${component} --strip)
endforeach()
file(RENAME ${WORK}/first ${WORK}/moved)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/consumer -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Debug
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/moved)
run(${CMAKE_COMMAND} --build ${WORK}/consumer)
run(${WORK}/consumer/consumer)

# the installed program must find its own configurations (run from outside the repository)
execute_process(COMMAND ${WORK}/moved/bin/lidarena info livox_mid360 WORKING_DIRECTORY /
                COMMAND_ERROR_IS_FATAL ANY)
