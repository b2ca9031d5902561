# SPDX-License-Identifier: BSD-3-Clause
# Finds all external dependencies. cmake/setup.sh lists the Debian packages.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres REQUIRED)
find_package(TBB REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt REQUIRED)
find_package(assimp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tsl-robin-map REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(deflate REQUIRED IMPORTED_TARGET libdeflate)  # CRC-32 of MCAP
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(lzf REQUIRED IMPORTED_TARGET liblzf)
pkg_check_modules(md REQUIRED IMPORTED_TARGET libmd)
find_package(BZip2 QUIET)  # reads ROS 1 bags with bz2 chunks
pkg_check_modules(sqlite QUIET IMPORTED_TARGET sqlite3)  # reads bags of rosbag2 in SQLite storage

# Embree 4 if found, else Embree 3 (a single .cpp file handles the differences), else the built-in
# bounding volume hierarchy.
set(LIDARENA_EMBREE_MAJOR 0)
if(LIDARENA_WITH_EMBREE)
  foreach(major IN ITEMS 4 3)
    find_package(embree ${major} QUIET)
    if(embree_FOUND)
      set(LIDARENA_EMBREE_MAJOR ${major})
      break()
    endif()
  endforeach()
endif()

find_package(nanoflann QUIET)  # benchmarks only

set(LIDARENA_HAVE_SDF OFF)
if(LIDARENA_WITH_SDF)
  find_package(sdformat12 QUIET)
  set(LIDARENA_HAVE_SDF ${sdformat12_FOUND})
endif()

# The HTML pages' JavaScript libraries come from npm: `npm ci --prefix viewer` downloads them
# (cmake/setup.sh runs it). Configuring and building never access the network.
set(LIDARENA_HAVE_VIEWER OFF)
if(LIDARENA_WITH_VIEWER)
  find_program(LIDARENA_NODE NAMES node nodejs)
  if(LIDARENA_NODE AND EXISTS ${PROJECT_SOURCE_DIR}/viewer/node_modules/esbuild)
    set(LIDARENA_HAVE_VIEWER ON)
  endif()
endif()
# HTTP server of `lidarena view`; without it the view is written to a file.
pkg_check_modules(httplib QUIET IMPORTED_TARGET cpp-httplib)

# Live topics for ROS 2 nodes.
set(LIDARENA_HAVE_DDS OFF)
if(LIDARENA_WITH_DDS)
  find_package(CycloneDDS 0.10 QUIET)
  set(LIDARENA_HAVE_DDS ${CycloneDDS_FOUND})
endif()

if(LIDARENA_EMBREE_MAJOR)
  set(LIDARENA_RAY_CASTER "Embree ${LIDARENA_EMBREE_MAJOR}")
else()
  set(LIDARENA_RAY_CASTER "built-in, slower than Embree")
endif()

function(lidarena_print_summary)
  message(STATUS "lidarena ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, ${CMAKE_CXX_COMPILER_ID} "
                 "${CMAKE_CXX_COMPILER_VERSION}")
  message(STATUS "  ray casting    ${LIDARENA_RAY_CASTER} (LIDARENA_WITH_EMBREE; needs Embree 3 or 4)")
  message(STATUS "  SDF worlds     ${LIDARENA_HAVE_SDF} (LIDARENA_WITH_SDF; needs sdformat 12)")
  message(STATUS "  viewer         ${LIDARENA_HAVE_VIEWER} (LIDARENA_WITH_VIEWER; needs Node.js 18 and npm ci "
                 "--prefix viewer)")
  message(STATUS "  view server    ${httplib_FOUND} (needs cpp-httplib)")
  message(STATUS "  live topics    ${LIDARENA_HAVE_DDS} (LIDARENA_WITH_DDS; needs Cyclone DDS 0.10)")
  message(STATUS "  Python module  ${LIDARENA_HAVE_PYTHON} (LIDARENA_WITH_PYTHON; needs pybind11 and NumPy)")
  message(STATUS "  tests          ${LIDARENA_BUILD_TESTS} (LIDARENA_BUILD_TESTS)")
  message(STATUS "  benchmarks     ${LIDARENA_BUILD_BENCHMARKS} (LIDARENA_BUILD_BENCHMARKS)")
  message(STATUS "  sanitizers     ${LIDARENA_SANITIZE} (LIDARENA_SANITIZE)")
endfunction()
