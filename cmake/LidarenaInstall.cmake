# SPDX-License-Identifier: BSD-3-Clause
# What `cmake --install` installs, in components: program (the command and its data), development
# (headers, libraries, find_package) and python; and the Debian packages that CPack builds from
# them.
include(CMakePackageConfigHelpers)

get_property(lidarena_modules GLOBAL PROPERTY LIDARENA_MODULES)
set(lidarena_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lidarena)
foreach(module IN LISTS lidarena_modules)
  install(TARGETS lidarena_${module} EXPORT lidarena_targets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
endforeach()
install(DIRECTORY lidarena DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN "*.hpp")
install(EXPORT lidarena_targets NAMESPACE lidarena:: FILE lidarena-targets.cmake
        DESTINATION ${lidarena_cmake_folder} COMPONENT development)
configure_package_config_file(cmake/lidarena-config.cmake.in lidarena-config.cmake
                              INSTALL_DESTINATION ${lidarena_cmake_folder})
write_basic_package_version_file(lidarena-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lidarena-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/lidarena-config-version.cmake
        DESTINATION ${lidarena_cmake_folder} COMPONENT development)

install(TARGETS lidarena RUNTIME COMPONENT program)
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/lidarena COMPONENT program)
set(about ${CMAKE_BINARY_DIR}/apps/lidarena/about)
install(DIRECTORY ${about}/schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/lidarena COMPONENT program)
install(FILES ${about}/lidarena.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${about}/lidarena DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT program)
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Lidarena authors <lidarena@localhost>")
set(CPACK_PACKAGE_VENDOR "The Lidarena authors")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lidarena)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Simulates LiDARs on a flying quadcopter in mesh worlds, runs LiDAR(-inertial)
SLAM on what they see, and scores odometry and map against the very mesh that
was scanned.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblidarena-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The C++ library: headers, static libraries and the files of find_package(lidarena).")
# dependencies of the exported targets; optional libraries that this build does not use are left out
set(needed libeigen3-dev libtbb-dev libassimp-dev libyaml-cpp-dev nlohmann-json3-dev libfmt-dev
           robin-map-dev libzstd-dev libdeflate-dev liblz4-dev liblzf-dev libmd-dev libceres-dev pkg-config)
if(LIDARENA_EMBREE_MAJOR)
  list(APPEND needed libembree-dev)
endif()
if(LIDARENA_HAVE_SDF)
  list(APPEND needed libsdformat-dev)
endif()
if(sqlite_FOUND)
  list(APPEND needed libsqlite3-dev)
endif()
if(BZIP2_FOUND)
  list(APPEND needed libbz2-dev)
endif()
list(JOIN needed ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
if(TARGET lidarena_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" this_python ${LIDARENA_HAVE_PYTHON})
  math(EXPR next_minor "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lidarena)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${this_python}), python3 (<< ${CMAKE_MATCH_1}.${next_minor}), python3-numpy, lidarena (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python module: worlds, flights, scans, odometries and scores as Python objects and NumPy views.")
endif()
include(CPack)
