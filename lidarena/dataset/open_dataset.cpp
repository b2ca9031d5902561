// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/points/sweep_dataset.hpp"
#include "lidarena/dataset/points/sweeps.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/recording_source.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

std::string ids_of(const Rig& rig) {
  std::string ids;
  for (const LidarInfo& lidar : rig.lidars) ids += (ids.empty() ? "" : ", ") + lidar.id;
  return ids;
}

/// Keeps only the chosen LiDAR in rig and topics, and applies options.body_from_lidar.
void apply(const ReadOptions& options, const std::string& place, layout::Description& dataset) {
  choose_lidar(options, place, dataset.rig);
  std::erase_if(dataset.sensors.lidars,
                [&](const auto& entry) { return dataset.rig.find_lidar(entry.second) == nullptr; });
}

Dataset from_recording(const fs::path& path, const fs::path& file, const RecordingInfo& info,
                       layout::Description description, const ReadOptions& options) {
  apply(options, file.string(), description);
  Dataset dataset;
  dataset.path = path;
  const auto& lidars = description.sensors.lidars;
  if (lidars.size() == 1 && info.damage.empty()) {
    dataset.scan_count = info.count_of(lidars.begin()->first);
  }
  if (!info.damage.empty()) dataset.notes.push_back(info.damage);
  dataset.events = open_recorded_events(file, description.sensors, info);
  dataset.rig = std::move(description.rig);
  return dataset;
}

/// data.mcap or data.bag.
std::optional<fs::path> data_file(const fs::path& folder) {
  for (const char* name : {layout::kData, layout::kBag}) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return std::nullopt;
}

Dataset open_folder(const fs::path& folder, const ReadOptions& options) {
  const fs::path manifest_file = folder / layout::kManifest;
  Json manifest = read_json(manifest_file);
  const std::string place = manifest_file.string();
  if (!manifest.is_object() || !manifest.contains("format") ||
      manifest["format"] != layout::kFormat) {
    throw InputError(place, "does not describe a dataset", "give the folder of a dataset");
  }
  if (!manifest.contains("format_version") ||
      manifest["format_version"] != layout::kFormatVersion) {
    throw InputError(place, "is not of format version " + std::to_string(layout::kFormatVersion),
                     "read it with the version of the program that wrote it");
  }
  if (!manifest.contains("rig")) {
    throw InputError(place, "lacks \"rig\"", "write the dataset again");
  }
  if (is_sweep_dataset(manifest)) {
    Rig rig = layout::rig_from_json(manifest["rig"], place);
    return open_sweep_dataset(folder, std::move(rig), std::move(manifest), options);
  }
  const auto file = data_file(folder);
  if (!file) {
    throw InputError(folder.string(),
                     "has a manifest but no measurements (as written with --no-data)",
                     "simulate the measurements from its manifest");
  }
  if (!manifest.contains("topics")) {
    throw InputError(place, "lacks \"topics\"", "write the dataset again");
  }
  layout::Description description{layout::rig_from_json(manifest["rig"], place),
                                  layout::sensors_from_json(manifest["topics"], place)};
  Dataset dataset =
      from_recording(folder, *file, read_recording_info(*file), std::move(description), options);
  dataset.manifest = std::move(manifest);
  return dataset;
}

/// "/os/points" becomes "os", "/livox/lidar" becomes "livox_lidar".
std::string id_of_topic(std::string topic) {
  constexpr std::string_view kPoints = "/points";
  if (topic.starts_with('/')) topic.erase(0, 1);
  if (topic.ends_with(kPoints)) topic.erase(topic.size() - kPoints.size());
  std::ranges::replace(topic, '/', '_');
  return topic;
}

std::string list_of(const std::vector<RecordedTopic>& topics) {
  std::string text;
  for (const RecordedTopic& topic : topics) {
    text += (text.empty() ? "" : ", ") + topic.topic + " (" + topic.type + " in " +
            topic.message_encoding + ")";
  }
  return text.empty() ? "nothing" : text;
}

/// Guesses the sensors of a third-party recording: the first topic with scans, or the one named by
/// topic or id, and the first IMU topic. The mounting is unknown: body, LiDAR and IMU frames are
/// assumed to coincide.
layout::Description guess(const fs::path& file, const RecordingInfo& info,
                          const ReadOptions& options, std::vector<std::string>& notes) {
  layout::Description guessed;
  for (const RecordedTopic& topic : info.topics) {
    const std::string id = id_of_topic(topic.topic);
    if (topic.topic.starts_with(layout::kTruthPrefix)) continue;
    const bool is_wanted = options.sensor.empty()
                               ? guessed.rig.lidars.empty()
                               : topic.topic == options.sensor || id == options.sensor;
    if (is_scan_type(topic) && is_wanted && topic.message_count > 0) {
      guessed.sensors.lidars[topic.topic] = id;
      guessed.rig.lidars.emplace_back().id = id;
      notes.push_back("scans are read from " + topic.topic);
    } else if (is_imu_type(topic) && guessed.rig.imus.empty() && topic.message_count > 0) {
      guessed.sensors.imus[topic.topic] = id;
      guessed.rig.imus.emplace_back().id = id;
      notes.push_back("IMU samples are read from " + topic.topic);
      if (is_in_g(file, topic.topic)) {
        guessed.sensors.imus_in_g.insert(id);
        notes.push_back(
            "accelerations of the IMU are taken to be in g, judging by their magnitude");
      }
    }
  }
  if (guessed.rig.lidars.empty()) {
    const std::string wanted = options.sensor.empty() ? "" : " named '" + options.sensor + "'";
    throw InputError(
        file.string(), "holds no scans" + wanted + " that can be read",
        "scans are PointCloud2 or Livox CustomMsg messages; it holds " + list_of(info.topics));
  }
  if (!options.body_from_lidar) {
    notes.push_back(
        "the file does not state how the LiDAR is mounted; its frame is taken to be the body "
        "frame");
  }
  return guessed;
}

Dataset open_recording_file(const fs::path& file, const ReadOptions& options) {
  const RecordingInfo info = read_recording_info(file);
  if (auto ours = layout::description_in(info, file.string())) {
    return from_recording(file, file, info, *std::move(ours), options);
  }
  std::vector<std::string> notes;
  layout::Description guessed = guess(file, info, options, notes);
  ReadOptions mounting = options;
  mounting.sensor.clear();  // already chosen, possibly by its topic
  Dataset dataset = from_recording(file, file, info, std::move(guessed), mounting);
  dataset.notes.insert(dataset.notes.end(), notes.begin(), notes.end());
  return dataset;
}

bool is_unfinished(const fs::path& folder) {
  const auto is_there = [&](const std::string& name) { return fs::exists(folder / name); };
  return is_there(layout::kManifestPart) || data_file(folder) ||
         is_there(std::string(layout::kData) + ".part") ||
         is_there(std::string(layout::kBag) + ".part");
}

/// The data file of a rosbag2 folder; empty for any other folder.
std::optional<fs::path> rosbag_file(const fs::path& folder) {
  if (!fs::exists(folder / layout::kRosbagMetadata)) return std::nullopt;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") files.push_back(entry.path());
  }
  if (files.empty()) {
    throw InputError(folder.string(), "is a bag without an MCAP file",
                     "convert it with 'ros2 bag convert' to the storage mcap");
  }
  if (files.size() > 1) {
    throw InputError(folder.string(), "is a bag split into several files",
                     "join them with 'ros2 bag convert', or give one of them");
  }
  return files.front();
}

std::optional<Trajectory> truth_in_recording(const fs::path& file) {
  const auto reader = open_recording(file);
  std::vector<StampedPose> poses;
  while (const auto message = reader->next()) {
    if (message->topic != layout::kTruthTopic) continue;
    poses.push_back(
        ros::decode_odometry(message->data, file.string() + ": truth", message->encoding));
  }
  if (poses.empty()) return std::nullopt;
  return Trajectory(std::move(poses), file.string() + ": " + layout::kTruthTopic);
}

/// Topic with the ground truth of the points of `sensor` in a file; empty when there is none.
std::optional<std::string> find_truth_topic(const fs::path& file, const std::string& sensor) {
  const RecordingInfo info = read_recording_info(file);
  const auto ours = layout::description_in(info, file.string());
  if (!ours) return std::nullopt;
  const LidarInfo* lidar = ours->rig.find_lidar(sensor);
  if (lidar == nullptr) {
    throw InputError(
        file.string(),
        sensor.empty() ? std::string("has several LiDARs") : "has no LiDAR '" + sensor + "'",
        "name the sensor: one of " + ids_of(ours->rig));
  }
  std::string topic = layout::truth_topic_of(lidar->id);
  return info.count_of(topic) > 0 ? std::optional(std::move(topic)) : std::nullopt;
}

class RecordedTruth final : public ScanTruthSource {
 public:
  RecordedTruth(const fs::path& file, std::string sensor, std::string topic)
      : reader_(open_recording(file)),
        sensor_(std::move(sensor)),
        topic_(std::move(topic)),
        place_(file.string() + ": " + topic_) {}

  std::optional<ScanTruth> next() override {
    while (const auto message = reader_->next()) {
      if (message->topic != topic_) continue;
      ScanTruth truth = ros::decode_scan_truth(message->data, place_, message->encoding);
      truth.sensor_id = sensor_;
      return truth;
    }
    return std::nullopt;
  }

 private:
  std::unique_ptr<RecordingReader> reader_;
  std::string sensor_;
  std::string topic_;
  std::string place_;
};

}  // namespace

Dataset open_dataset(const fs::path& path, const ReadOptions& options) {
  if (!fs::exists(path)) throw InputError(path.string(), "does not exist", "check the path");
  if (fs::is_directory(path)) {
    if (fs::exists(path / layout::kManifest)) return open_folder(path, options);
    if (is_unfinished(path)) {
      throw InputError(path.string(), "is an unfinished dataset: it has no manifest.json",
                       "write it again, or give its data file alone");
    }
    if (const auto bag = rosbag_file(path)) return open_recording_file(*bag, options);
    return open_sweep_folder(path, options);
  }
  if (path.extension() == ".db3") {
    throw InputError(path.string(), "is a bag in SQLite format, which is not supported",
                     "convert it with 'ros2 bag convert' to the storage mcap");
  }
  return recording_format_of(path) ? open_recording_file(path, options)
                                   : open_sweep_files({path}, options);
}

std::optional<Trajectory> load_truth(const fs::path& dataset) {
  if (!fs::is_directory(dataset)) {
    return recording_format_of(dataset) ? truth_in_recording(dataset) : std::nullopt;
  }
  if (fs::exists(dataset / layout::kTruth)) return read_tum(dataset / layout::kTruth);
  return std::nullopt;
}

bool has_measurements(const fs::path& folder) {
  if (data_file(folder)) return true;
  const fs::path manifest = folder / layout::kManifest;
  return fs::exists(manifest) && is_sweep_dataset(read_json(manifest));
}

std::unique_ptr<ScanTruthSource> open_scan_truth(const fs::path& dataset,
                                                 const std::string& sensor) {
  if (fs::exists(dataset / layout::kManifest)) {
    const Json manifest = read_json(dataset / layout::kManifest);
    if (is_sweep_dataset(manifest)) return open_sweep_truth(dataset, manifest, sensor);
  }
  const auto file = fs::is_directory(dataset) ? data_file(dataset) : std::optional(dataset);
  if (!file || !recording_format_of(*file) || !fs::exists(*file)) return nullptr;
  const auto topic = find_truth_topic(*file, sensor);
  if (!topic) return nullptr;
  const std::string id = topic->substr(std::string(layout::kTruthPrefix).size());
  return std::make_unique<RecordedTruth>(*file, id.substr(0, id.find('/')), *topic);
}

std::optional<fs::path> find_world_mesh(const fs::path& dataset) {
  const fs::path mesh = dataset / layout::kWorld;
  return fs::exists(mesh) ? std::optional(mesh) : std::nullopt;
}

}  // namespace lidarena::dataset
