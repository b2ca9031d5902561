// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/guess_sensors.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/packets/packet_capture.hpp"
#include "lidarena/dataset/points/sweep_dataset.hpp"
#include "lidarena/dataset/points/sweeps.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/recording_parts.hpp"
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
  if (options.imu_topic.empty()) return;
  const auto chosen = dataset.sensors.imus.find(options.imu_topic);
  if (chosen == dataset.sensors.imus.end())
    throw InputError(place, "has no IMU topic '" + options.imu_topic + "'");
  const std::string id = chosen->second;
  std::erase_if(dataset.sensors.imus, [&](const auto& entry) { return entry.second != id; });
  std::erase_if(dataset.rig.imus, [&](const ImuInfo& imu) { return imu.id != id; });
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
  dataset.events = open_recorded_events(file, description.sensors, info, dataset.report);
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

std::vector<TopicSummary> topics_of(const RecordingInfo& info, const RecordedSensors& sensors,
                                    const Survey& survey) {
  std::vector<TopicSummary> topics;
  for (const RecordedTopic& topic : info.topics) {
    TopicSummary& summary = topics.emplace_back();
    summary = {topic.topic, topic.type, {}, topic.message_count};
    summary.is_read = sensors.lidars.contains(topic.topic) || sensors.imus.contains(topic.topic);
    const double seconds = to_seconds(info.end - info.start);
    if (topic.message_count > 1 && seconds > 0.0)
      summary.rate_hz = static_cast<double>(topic.message_count - 1) / seconds;
    const auto seen = survey.topics.find(topic.topic);
    if (seen == survey.topics.end()) continue;
    summary.frame_id = seen->second.frame_id;
    if (const Time period = seen->second.period(); period > Time{0})
      summary.rate_hz = 1.0 / to_seconds(period);
  }
  return topics;
}

Dataset open_recording_files(const fs::path& path, const ReadOptions& options) {
  const auto unpacked = std::make_shared<UnpackedRecording>(path);
  const fs::path& file = unpacked->path();
  const RecordingInfo info = read_recording_info(file);
  if (auto ours = layout::description_in(info, file.string())) {
    auto topics = topics_of(info, ours->sensors, {});
    Dataset dataset = from_recording(path, file, info, *std::move(ours), options);
    dataset.topics = std::move(topics);
    dataset.unpacked = unpacked;
    return dataset;
  }
  const Survey survey = survey_recording(file, info);
  GuessedSensors guessed = guess_sensors(path, info, survey, options);
  auto topics = topics_of(info, guessed.description.sensors, survey);
  ReadOptions mounting = options;
  mounting.sensor.clear();  // already chosen, possibly by its topic
  Dataset dataset = from_recording(path, file, info, std::move(guessed.description), mounting);
  dataset.unpacked = unpacked;
  dataset.topics = std::move(topics);
  for (std::string& note : guessed.notes) dataset.notes.push_back(std::move(note));
  dataset.warnings = std::move(guessed.warnings);
  dataset.imu_fault = std::move(guessed.imu_fault);
  return dataset;
}

bool is_unfinished(const fs::path& folder) {
  const auto is_there = [&](const std::string& name) { return fs::exists(folder / name); };
  return is_there(layout::kManifestPart) || data_file(folder) ||
         is_there(std::string(layout::kData) + ".part") ||
         is_there(std::string(layout::kBag) + ".part");
}

/// The poses before the damage of a damaged file.
std::optional<Trajectory> truth_in_recording(const fs::path& file) {
  const auto reader = open_recording(file);
  std::vector<StampedPose> poses;
  try {
    while (const auto message = reader->next()) {
      if (message->topic != layout::kTruthTopic) continue;
      poses.push_back(
          ros::decode_odometry(message->data, file.string() + ": truth", message->encoding));
    }
  } catch (const DamagedFile&) {
    // The events end there too, and say so.
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
    if (is_recording(path)) return open_recording_files(path, options);
    if (fs::exists(path / layout::kRosbagMetadata)) {
      throw InputError(path.string(), "is a bag of rosbag2 without its data",
                       "copy its .mcap or .db3 file into the folder");
    }
    return open_sweep_folder(path, options);
  }
  if (is_packet_capture(path)) return open_packet_capture(path, options);
  return is_recording(path) ? open_recording_files(path, options)
                            : open_sweep_files({path}, options);
}

std::optional<Trajectory> load_truth(const fs::path& dataset) {
  if (!fs::is_directory(dataset)) {
    return recording_format_of(dataset) ? truth_in_recording(dataset) : std::nullopt;
  }
  if (fs::exists(dataset / layout::kTruth)) return read_tum(dataset / layout::kTruth);
  return std::nullopt;
}

bool is_recording(const fs::path& path) {
  return fs::is_directory(path) ? !recordings_in(path).empty() : is_recording_name(path);
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
