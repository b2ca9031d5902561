# SPDX-License-Identifier: BSD-3-Clause
# Finds the simulator: the newest version that is installed, or the core of Fortress in
# LIDARENA_FORTRESS_CORE. Defines lidarena_gz_sim, which plugins and tests link, and
# lidarena_gz_sim_version.
add_library(lidarena_gz_sim INTERFACE)

# use_gz(SIM COMMON PLUGIN): Harmonic or later, by the names of its packages. Not tested by us.
function(use_gz sim common plugin)
  find_package(${common} REQUIRED COMPONENTS graphics)
  find_package(${plugin} REQUIRED COMPONENTS register)
  target_link_libraries(lidarena_gz_sim INTERFACE ${sim}::${sim} ${common}::graphics
                                                  ${plugin}::register)
  target_compile_definitions(lidarena_gz_sim INTERFACE LIDARENA_GZ_SIM)
  set(lidarena_gz_sim_version "${sim} ${${sim}_VERSION}" PARENT_SCOPE)
endfunction()

function(use_fortress)
  find_package(ignition-common4 REQUIRED COMPONENTS graphics events profiler)
  find_package(ignition-plugin1 REQUIRED COMPONENTS register loader)
  find_package(ignition-transport11 REQUIRED)
  find_package(ignition-msgs8 REQUIRED)
  find_package(ignition-math6 REQUIRED)
  find_package(sdformat12 REQUIRED)
  target_link_libraries(lidarena_gz_sim INTERFACE
    ignition-common4::ignition-common4 ignition-common4::graphics ignition-common4::events
    ignition-common4::profiler ignition-plugin1::register ignition-transport11::ignition-transport11
    ignition-msgs8::ignition-msgs8 ignition-math6::ignition-math6 sdformat12::sdformat12)
endfunction()

if(LIDARENA_FORTRESS_CORE)
  use_fortress()
  target_include_directories(lidarena_gz_sim SYSTEM INTERFACE
    ${LIDARENA_FORTRESS_CORE}/source/include ${LIDARENA_FORTRESS_CORE}/build/include)
  target_link_libraries(lidarena_gz_sim INTERFACE
    ${LIDARENA_FORTRESS_CORE}/build/lib/libignition-gazebo6.so)
  set(lidarena_gz_sim_version "Fortress in ${LIDARENA_FORTRESS_CORE}")
else()
  find_package(gz-sim QUIET)
  find_package(gz-sim9 QUIET)
  find_package(gz-sim8 QUIET)
  find_package(ignition-gazebo6 QUIET)
  if(gz-sim_FOUND)  # Jetty and later
    use_gz(gz-sim gz-common gz-plugin)
  elseif(gz-sim9_FOUND)  # Ionic
    use_gz(gz-sim9 gz-common6 gz-plugin3)
  elseif(gz-sim8_FOUND)  # Harmonic
    use_gz(gz-sim8 gz-common5 gz-plugin2)
  elseif(ignition-gazebo6_FOUND)  # Fortress
    use_fortress()
    target_link_libraries(lidarena_gz_sim INTERFACE ignition-gazebo6::ignition-gazebo6)
    set(lidarena_gz_sim_version "Fortress ${ignition-gazebo6_VERSION}")
  else()
    message(FATAL_ERROR "Found neither gz-sim (Harmonic or later) nor ignition-gazebo6 (Fortress)")
  endif()
endif()
