# SPDX-License-Identifier: BSD-3-Clause
# Functions that declare a module and a test. Compiler flags for our own build only (warnings,
# sanitizers) are PRIVATE.
add_library(lidarena_flags INTERFACE)
# -ffp-contract=off: every operation is rounded. GCC fuses multiplications with additions where the processor can (arm64),
# in one loop and not in another, so that equal sums would differ.
target_compile_options(lidarena_flags INTERFACE -Wall -Wextra -Wconversion -Wshadow -Wno-psabi -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # GCC's -Wconversion leaves out signs in C++
  target_compile_options(lidarena_flags INTERFACE -Wno-sign-conversion)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  # GCC 13 and 14 warn of references that a function with a temporary argument returns, whatever they refer to
  target_compile_options(lidarena_flags INTERFACE -Wno-dangling-reference)
endif()
if(LIDARENA_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 falsely warns of std::string's own header (GCC bug 105651), with precompiled headers even
  # though it is a system header
  target_compile_options(lidarena_flags INTERFACE -Wno-array-bounds -Wno-restrict
                                                  -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(CMAKE_UNITY_BUILD)
  # Of files that are compiled together a compiler warns as if they were one: names of one hide those of
  # another, and the anonymous namespace of an included file may differ elsewhere.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(lidarena_flags INTERFACE -Wno-subobject-linkage -Wno-shadow -Wshadow=local)
  else()
    target_compile_options(lidarena_flags INTERFACE -Wno-shadow)
  endif()
endif()
if(LIDARENA_WARNINGS_AS_ERRORS)
  target_compile_options(lidarena_flags INTERFACE -Werror)
endif()
if(LIDARENA_SANITIZE)
  target_compile_options(lidarena_flags INTERFACE -fsanitize=${LIDARENA_SANITIZE}
                                                  -fno-omit-frame-pointer)
  target_link_options(lidarena_flags INTERFACE -fsanitize=${LIDARENA_SANITIZE})
endif()

# Targets whose precompiled headers the modules and the tests use, as the flags of both differ.
if(LIDARENA_PRECOMPILED_HEADERS)
  set(precompiled ${PROJECT_SOURCE_DIR}/cmake/precompiled)
  add_library(lidarena_library_headers OBJECT ${precompiled}/library.cpp)
  target_link_libraries(lidarena_library_headers PRIVATE Eigen3::Eigen fmt::fmt lidarena_flags)
  target_precompile_headers(lidarena_library_headers PRIVATE ${precompiled}/library.hpp)
  if(LIDARENA_BUILD_TESTS)
    find_package(GTest REQUIRED)
    add_executable(lidarena_test_headers ${precompiled}/test.cpp)
    target_link_libraries(lidarena_test_headers PRIVATE Eigen3::Eigen fmt::fmt GTest::gmock lidarena_flags)
    target_precompile_headers(lidarena_test_headers PRIVATE ${precompiled}/test.hpp)
  endif()
endif()

# lidarena_module(NAME SOURCES a.cpp ... [MODULES base ...] [PUBLIC lib ...] [PRIVATE lib ...]
#                 [NO_NUMERICS])
# A module with NO_NUMERICS has no loop that matters; it is optimized less and compiles faster.
function(lidarena_module name)
  cmake_parse_arguments(arg "NO_NUMERICS" "" "SOURCES;MODULES;PUBLIC;PRIVATE" ${ARGN})
  add_library(lidarena_${name} STATIC ${arg_SOURCES})
  add_library(lidarena::${name} ALIAS lidarena_${name})
  set_target_properties(lidarena_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY LIDARENA_MODULES ${name})
  target_include_directories(lidarena_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(lidarena_${name} PUBLIC cxx_std_20)
  list(TRANSFORM arg_MODULES PREPEND lidarena::)
  target_link_libraries(lidarena_${name} PUBLIC Eigen3::Eigen ${arg_MODULES} ${arg_PUBLIC}
                                         PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:lidarena_flags>)
  if(arg_NO_NUMERICS)
    target_compile_options(lidarena_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  # GCC 13 and later refuse precompiled headers that were made with another -O.
  if(LIDARENA_PRECOMPILED_HEADERS AND NOT (arg_NO_NUMERICS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU"
                                           AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13))
    target_precompile_headers(lidarena_${name} REUSE_FROM lidarena_library_headers)
  endif()
endfunction()

# lidarena_test(NAME SOURCES a_test.cpp ... [MODULES world ...] [LIBRARIES lib ...])
# One executable test_NAME; each TEST() becomes one ctest case named NAME.Suite.Case.
function(lidarena_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;MODULES;LIBRARIES" ${ARGN})
  add_executable(test_${name} ${arg_SOURCES})
  list(TRANSFORM arg_MODULES PREPEND lidarena::)
  target_link_libraries(test_${name} PRIVATE ${arg_MODULES} ${arg_LIBRARIES} GTest::gmock
                                             GTest::gtest_main lidarena_flags)
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(test_${name} PRIVATE
    LIDARENA_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    LIDARENA_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  if(LIDARENA_PRECOMPILED_HEADERS AND arg_MODULES)  # the headers need the libraries of the modules
    target_precompile_headers(test_${name} REUSE_FROM lidarena_test_headers)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT 300)
endfunction()
