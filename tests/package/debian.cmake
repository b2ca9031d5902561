# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages and unpacks them: the program's package must list the libraries that it
# needs, and the program must run from the unpacked tree.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE out
                  WORKING_DIRECTORY /)  # outside the repository, whose configs/ would be found
  set(out "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK}/packages ${WORK}/unpacked)
run(${CPACK} --config ${BUILD}/CPackConfig.cmake -G DEB -B ${WORK}/packages)
file(GLOB program ${WORK}/packages/lidarena_*.deb)
file(GLOB development ${WORK}/packages/liblidarena-dev_*.deb)
run(dpkg-deb --field ${program} Depends)
foreach(library IN ITEMS libc6 libyaml-cpp libtbb)
  if(NOT out MATCHES ${library})
    message(FATAL_ERROR "the package does not list its dependency ${library}: ${out}")
  endif()
endforeach()
foreach(package IN ITEMS ${program} ${development})
  run(dpkg-deb --extract ${package} ${WORK}/unpacked)
endforeach()
run(${WORK}/unpacked/usr/bin/lidarena info house)
run(${WORK}/unpacked/usr/bin/lidarena --version)
if(NOT out MATCHES "from the installation in ${WORK}/unpacked/usr, commit ")
  message(FATAL_ERROR "the program does not know where it is: ${out}")
endif()
foreach(file IN ITEMS share/doc/lidarena/copyright include/lidarena/world/world.hpp
                      share/man/man1/lidarena.1 share/lidarena/schemas/sensor.schema.json
                      share/bash-completion/completions/lidarena)
  if(NOT EXISTS ${WORK}/unpacked/usr/${file})
    message(FATAL_ERROR "the packages do not contain ${file}")
  endif()
endforeach()

# if the Python module was built, it must find the configurations of the program's package
file(GLOB python ${WORK}/packages/python3-lidarena_*.deb)
if(python)
  run(dpkg-deb --extract ${python} ${WORK}/unpacked)
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${WORK}/unpacked/usr/lib/python3/dist-packages
      ${PYTHON} -B -c "import lidarena; print(lidarena.load_sensor('livox_mid360').name)")
endif()
