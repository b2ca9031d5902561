// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/dataset/recording_source.hpp"

/// Names and keys shared by the writer and the reader of Lidarena dataset folders.
namespace lidarena::dataset::layout {

inline constexpr const char* kManifest = "manifest.json";
inline constexpr const char* kManifestPart = "manifest.json.part";  ///< while it is being written
inline constexpr const char* kData = "data.mcap";
inline constexpr const char* kBag = "data.bag";
inline constexpr const char* kTruth = "truth.tum";
inline constexpr const char* kTruthPart = "truth.tum.part";  ///< while it is being written
inline constexpr const char* kWorld = "world.ply";
inline constexpr const char* kRosbagMetadata = "metadata.yaml";

inline constexpr const char* kFormat = "lidarena dataset";  ///< manifest.json: "format"
inline constexpr int kFormatVersion = 1;
inline constexpr const char* kTruthTopic = "/truth/odometry";
/// Topics with this prefix are ground truth: estimators must not see them.
inline constexpr const char* kTruthPrefix = "/truth/";
/// Topic of the ground truth of a LiDAR's points.
std::string truth_topic_of(const std::string& lidar_id);
inline constexpr const char* kDescription = "lidarena";  ///< name of the metadata record

/// Topics of a rig: /ID/points for LiDARs, /ID/imu for IMUs (an IMU may share its LiDAR's id).
/// Throws InputError when two LiDARs, or two IMUs, have the same id.
RecordedSensors topics_of(const Rig& rig);

/// Topic of Livox CustomMsg messages, used with Dialect::kDriver.
std::string livox_topic_of(const std::string& lidar_id);

/// {"lidars": {id: topic}, "imus": {id: topic}}, and back.
Json to_json(const RecordedSensors& sensors);
RecordedSensors sensors_from_json(const Json& json, const std::string& place);

Rig rig_from_json(const Json& json, const std::string& place);

/// Rig and topics, stored in every recording (in MCAP as the metadata record "lidarena").
struct Description {
  Rig rig;
  RecordedSensors sensors;
};
StringMap describe(const Description& description);
/// Empty when the file was not written by Lidarena.
std::optional<Description> description_in(const RecordingInfo& info, const std::string& place);

}  // namespace lidarena::dataset::layout
