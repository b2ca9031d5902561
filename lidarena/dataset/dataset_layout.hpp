// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/dataset/recording_source.hpp"

/// What writer and reader of our dataset folders agree on.
namespace lidarena::layout {

inline constexpr const char* kManifest = "manifest.json";
inline constexpr const char* kManifestPart = "manifest.json.part";  ///< in the making
inline constexpr const char* kData = "data.mcap";
inline constexpr const char* kBag = "data.bag";
inline constexpr const char* kTruth = "truth.tum";
inline constexpr const char* kTruthPart = "truth.tum.part";  ///< in the making
inline constexpr const char* kWorld = "world.ply";
inline constexpr const char* kRosbagMetadata = "metadata.yaml";

inline constexpr const char* kFormat = "lidarena dataset";  ///< manifest.json: "format"
inline constexpr int kFormatVersion = 1;
inline constexpr const char* kTruthTopic = "/truth/odometry";
/// Everything below it is truth: nothing that estimates may see it.
inline constexpr const char* kTruthPrefix = "/truth/";
/// Topic of what the points of a LiDAR hit.
std::string truth_topic_of(const std::string& lidar_id);
inline constexpr const char* kDescription = "lidarena";  ///< name of the metadata record

/// Topics of a rig: /ID/points for LiDARs, /ID/imu for IMUs (an IMU may share its LiDAR's id).
/// Throws InputError when two LiDARs, or two IMUs, have one id.
RecordedSensors topics_of(const Rig& rig);

/// Topic of a Livox's own messages, in the dialect of its driver.
std::string livox_topic_of(const std::string& lidar_id);

/// {"lidars": {id: topic}, "imus": {id: topic}}, and back.
Json to_json(const RecordedSensors& sensors);
RecordedSensors sensors_from_json(const Json& json, const std::string& place);

Rig rig_from_json(const Json& json, const std::string& place);

/// The description that every data.mcap carries (metadata record "lidarena"): rig and topics.
struct Description {
  Rig rig;
  RecordedSensors sensors;
};
StringMap describe(const Description& description);
/// Empty when the file is not ours.
std::optional<Description> description_in(const RecordingInfo& info, const std::string& place);

}  // namespace lidarena::layout
