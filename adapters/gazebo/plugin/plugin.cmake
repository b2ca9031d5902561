# SPDX-License-Identifier: BSD-3-Clause
# What the plugins of all simulators have in common: their configuration, the sensor from step to
# step, its outputs, and reading and writing files. Knows no simulator. transport_output.cpp is
# compiled by the plugins: it needs their simulator's transport. Included, not a subdirectory, so that
# the project that includes it sees the libraries that were found.
add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/../core gazebo_core)
find_package(yaml-cpp REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
find_package(Threads REQUIRED)
find_library(DEFLATE_LIBRARY deflate REQUIRED)
find_library(MD_LIBRARY md REQUIRED)
find_library(LZF_LIBRARY lzf REQUIRED)
find_path(LZF_INCLUDE_DIR lzf.h PATH_SUFFIXES liblzf REQUIRED)

# Sources that read configuration files and write recordings.
set(root ${CMAKE_CURRENT_LIST_DIR}/../../..)
set(sources
  base/config.cpp base/ply_reader.cpp base/rig.cpp base/scalar_type.cpp flight/recording.cpp flight/replay_flight.cpp flight/rotation_rates.cpp
  sensor/sensor_config.cpp
  dataset/ros1/bag_reader.cpp dataset/ros1/bag_records.cpp dataset/ros1/bag_writer.cpp dataset/points/cloud.cpp
  dataset/compression.cpp dataset/dataset_layout.cpp dataset/dataset_writer.cpp dataset/firing_order.cpp
  dataset/messages/driver_layouts.cpp dataset/imu_text.cpp dataset/json_file.cpp dataset/trajectories/kitti.cpp
  dataset/messages/livox_message.cpp dataset/points/lzf.cpp dataset/mcap/mcap_info.cpp dataset/mcap/mcap_reader.cpp
  dataset/mcap/mcap_records.cpp dataset/mcap/mcap_writer.cpp dataset/md5.cpp dataset/messages/message_stream.cpp
  dataset/part_file.cpp dataset/points/pcd.cpp dataset/points/ply.cpp dataset/messages/point_cloud2.cpp
  dataset/messages/point_times.cpp dataset/read_report.cpp dataset/recording_parts.cpp dataset/sqlite/db3_reader.cpp
  dataset/points/point_file_text.cpp dataset/points/point_table.cpp dataset/recording.cpp
  dataset/recording_source.cpp dataset/recording_store.cpp dataset/messages/ros_definitions.cpp
  dataset/messages/ros_messages.cpp dataset/mcap/rosbag2_metadata.cpp dataset/stream_merge.cpp
  dataset/points/sweep_dataset.cpp dataset/points/sweep_file.cpp
  dataset/points/sweep_store.cpp dataset/points/sweeps.cpp dataset/single_lidar.cpp dataset/text_file.cpp dataset/trajectories/trajectory_rows.cpp dataset/trajectories/tum.cpp)
list(TRANSFORM sources PREPEND ${root}/lidarena/)
set(plugin_sources mesh_shapes.cpp plugin_config.cpp recorder.cpp sensor_run.cpp topic_output.cpp)
list(TRANSFORM plugin_sources PREPEND ${CMAKE_CURRENT_LIST_DIR}/)
add_library(lidarena_gazebo_plugin STATIC
  ${plugin_sources} ${sources})
target_link_libraries(lidarena_gazebo_plugin
  PUBLIC lidarena_gazebo_core fmt::fmt nlohmann_json::nlohmann_json Threads::Threads
  PRIVATE yaml-cpp PkgConfig::zstd PkgConfig::lz4 ${DEFLATE_LIBRARY} ${MD_LIBRARY} ${LZF_LIBRARY})
target_include_directories(lidarena_gazebo_plugin PRIVATE ${LZF_INCLUDE_DIR})
set_source_files_properties(${plugin_sources} PROPERTIES COMPILE_OPTIONS "-Wall;-Wextra")
set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/plugin_config.cpp PROPERTIES
  COMPILE_DEFINITIONS LIDARENA_SENSOR_FOLDER="${root}/configs/sensors")
