# SPDX-License-Identifier: BSD-3-Clause
# Everything outside the project, found once. Debian's packages are named in cmake/setup.sh.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt REQUIRED)
find_package(assimp REQUIRED)
find_package(PNG REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tsl-robin-map REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)

# Embree 4 where there is one, else 3: one .cpp of ours knows the difference.
find_package(embree 4 QUIET)
if(embree_FOUND)
  set(LIDARENA_EMBREE_MAJOR 4)
else()
  find_package(embree 3 REQUIRED)
  set(LIDARENA_EMBREE_MAJOR 3)
endif()

set(LIDARENA_HAVE_SDF OFF)
if(LIDARENA_WITH_SDF)
  find_package(sdformat12 QUIET)
  set(LIDARENA_HAVE_SDF ${sdformat12_FOUND})
endif()

function(lidarena_print_summary)
  message(STATUS "lidarena ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, ${CMAKE_CXX_COMPILER_ID} "
                 "${CMAKE_CXX_COMPILER_VERSION}")
  message(STATUS "  ray casting    Embree ${LIDARENA_EMBREE_MAJOR}")
  message(STATUS "  SDF worlds     ${LIDARENA_HAVE_SDF} (LIDARENA_WITH_SDF; needs sdformat 12)")
  message(STATUS "  tests          ${LIDARENA_BUILD_TESTS} (LIDARENA_BUILD_TESTS)")
  message(STATUS "  benchmarks     ${LIDARENA_BUILD_BENCHMARKS} (LIDARENA_BUILD_BENCHMARKS)")
  message(STATUS "  sanitizers     ${LIDARENA_SANITIZE} (LIDARENA_SANITIZE)")
endfunction()
