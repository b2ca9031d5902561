// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/guess_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/single_lidar.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

/// Transport delays and bursts of a driver are shorter.
constexpr double kMaxClockOffset_s = 1.0;
/// Topics begin within hours of each other.
constexpr double kMaxStartOffset_s = 86400.0;

std::string list_of(const std::vector<RecordedTopic>& topics) {
  std::string text;
  for (const RecordedTopic& topic : topics) {
    text += fmt::format("{}{} ({} in {})", text.empty() ? "" : ", ", topic.topic, topic.type,
                        topic.message_encoding);
  }
  return text.empty() ? "nothing" : text;
}

std::size_t common_prefix(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// Length of the names of namespaces that both topics begin with, e.g. 3 of /os/points, /os/imu.
std::size_t common_namespace(const std::string& a, const std::string& b) {
  const std::string common = a.substr(0, common_prefix(a, b));
  const std::size_t end = common.rfind('/');
  return end == std::string::npos ? 0 : end;
}

/// Collects the sensors of one recording.
class Guesser {
 public:
  Guesser(const fs::path& file, const RecordingInfo& info, const Survey& survey,
          const ReadOptions& options)
      : file_(file), info_(info), survey_(survey), options_(options) {
    for (const RecordedTopic& topic : info.topics) {
      if (topic.topic.starts_with(layout::kTruthPrefix) || topic.message_count == 0) continue;
      if (is_scan_type(topic)) add_once(lidars_, topic.topic);
      if (is_imu_type(topic)) add_once(imus_, topic.topic);
    }
  }

  GuessedSensors guess() {
    const std::string lidar = choose_lidar();
    if (options_.all_sensors && options_.sensor.empty()) {
      for (const std::string& topic : lidars_) take_lidar(topic);
      for (const std::string& topic : imus_) take_imu(topic, lidar);
    } else {
      take_lidar(lidar);
      tell_others(lidars_, lidar, "scans", "--sensor");
      if (const std::string imu = choose_imu(lidar); !imu.empty()) {
        take_imu(imu, lidar);
        tell_others(imus_, imu, "IMU samples", "--imu-topic");
      }
    }
    mount();
    return std::move(guessed_);
  }

 private:
  static void add_once(std::vector<std::string>& topics, const std::string& topic) {
    if (std::ranges::find(topics, topic) == topics.end()) topics.push_back(topic);
  }

  const SurveyedTopic& surveyed(const std::string& topic) const {
    static const SurveyedTopic kNothing;
    const auto found = survey_.topics.find(topic);
    return found == survey_.topics.end() ? kNothing : found->second;
  }

  std::string choose_lidar() const {
    const auto named = [&](const std::string& topic) {
      return topic == options_.sensor || id_of_topic(topic) == options_.sensor;
    };
    if (!options_.sensor.empty()) {
      const auto found = std::ranges::find_if(lidars_, named);
      if (found != lidars_.end()) return *found;
    } else if (!lidars_.empty()) {
      return *std::ranges::max_element(
          lidars_, {}, [&](const std::string& topic) { return likeness(surveyed(topic)); });
    }
    const std::string wanted = options_.sensor.empty() ? "" : " named '" + options_.sensor + "'";
    throw InputError(file_.string(), "holds no scans" + wanted + " that can be read",
                     "scans are PointCloud2, Livox CustomMsg or VelodyneScan messages; it holds " +
                         list_of(info_.topics));
  }

  /// How much a topic is a LiDAR's and not a depth camera's or a radar's.
  static int likeness(const SurveyedTopic& topic) {
    const bool timed = !topic.sweeps.empty() && !topic.sweeps.front().field.empty();
    return (topic.fault.empty() ? 4 : 0) + (timed ? 2 : 0) + (topic.has_rings ? 1 : 0);
  }

  /// Empty when there is no IMU.
  std::string choose_imu(const std::string& lidar) const {
    if (!options_.imu_topic.empty()) {
      if (std::ranges::find(imus_, options_.imu_topic) != imus_.end()) return options_.imu_topic;
      throw InputError(
          file_.string(), "has no IMU topic '" + options_.imu_topic + "'",
          imus_.empty() ? "it has no IMU" : fmt::format("it has: {}", fmt::join(imus_, ", ")));
    }
    if (imus_.empty()) return {};
    const std::string& frame = surveyed(lidar).frame_id;
    return *std::ranges::max_element(imus_, {}, [&](const std::string& topic) {
      return std::pair(common_namespace(topic, lidar),
                       common_prefix(surveyed(topic).frame_id, frame));
    });
  }

  void tell_others(const std::vector<std::string>& topics, const std::string& taken,
                   const char* what, const char* option) {
    std::vector<std::string> others = topics;
    std::erase(others, taken);
    guessed_.notes.push_back(others.empty()
                                 ? fmt::format("{} are read from {}", what, taken)
                                 : fmt::format("{} are read from {}, not from {} ({} chooses)",
                                               what, taken, fmt::join(others, ", "), option));
  }

  void take_lidar(const std::string& topic) {
    const std::string id = id_of_topic(topic);
    LidarInfo& lidar = guessed_.description.rig.lidars.emplace_back();
    lidar.id = id;
    guessed_.description.sensors.lidars[topic] = id;
    const SurveyedTopic& seen = surveyed(topic);
    if (const Time period = seen.period(); period > Time{0})
      lidar.rate_hz = 1.0 / to_seconds(period);
    if (!seen.fault.empty()) guessed_.warnings.push_back(seen.fault);
    const ros::PointTimesVerdict verdict = ros::judge_point_times(topic, seen.sweeps);
    guessed_.description.sensors.point_times[topic] = verdict.times;
    tell(verdict.note, guessed_.notes);
    tell(verdict.warning, guessed_.warnings);
  }

  void take_imu(const std::string& topic, const std::string& lidar) {
    if (const std::string fault = clock_fault(topic, lidar); !fault.empty()) {
      guessed_.imu_fault = fault;
      guessed_.warnings.push_back(fault);
      if (!options_.all_sensors) return;
    }
    const std::string id = id_of_topic(topic);
    guessed_.description.rig.imus.emplace_back().id = id;
    guessed_.description.sensors.imus[topic] = id;
    tell(late_start(topic, lidar), guessed_.warnings);
    ImuVerdict verdict = judge_imu(topic, surveyed(topic).samples);
    guessed_.description.sensors.imu_units[id] = verdict.units;
    for (std::string& note : verdict.notes) guessed_.notes.push_back(std::move(note));
    for (std::string& warning : verdict.warnings) guessed_.warnings.push_back(std::move(warning));
  }

  /// Says that two topics are on different clocks, judging by their stamps against the log times
  /// (which are one clock), and by their first stamps.
  std::string clock_fault(const std::string& imu, const std::string& lidar) const {
    const SurveyedTopic& a = surveyed(imu);
    const SurveyedTopic& b = surveyed(lidar);
    if (a.stamps.empty() || b.stamps.empty()) return {};
    const double by_log_s = a.clock_offset_s() - b.clock_offset_s();
    const double start_s = to_seconds(a.stamps.front()) - to_seconds(b.stamps.front());
    const bool differ_by_log = std::abs(by_log_s) > kMaxClockOffset_s;
    if (!differ_by_log && std::abs(start_s) <= kMaxStartOffset_s) return {};
    const double offset_s = differ_by_log ? by_log_s : start_s;
    return fmt::format(
        "{}: the clocks of {} and {} differ by {:.6g} s; the IMU cannot be used: synchronize the "
        "clocks, or stamp both topics when they arrive",
        file_.string(), imu, lidar, std::abs(offset_s));
  }

  /// Says that the IMU begins long after the LiDAR.
  std::string late_start(const std::string& imu, const std::string& lidar) const {
    const SurveyedTopic& a = surveyed(imu);
    const SurveyedTopic& b = surveyed(lidar);
    if (a.stamps.empty() || b.stamps.empty()) return {};
    const double late_s = to_seconds(a.stamps.front() - b.stamps.front());
    if (late_s <= kMaxClockOffset_s || late_s > kMaxStartOffset_s) return {};
    return fmt::format("{} begins {:.3g} s after {}: what needs the IMU begins there", imu, late_s,
                       lidar);
  }

  static void tell(const std::string& text, std::vector<std::string>& list) {
    if (!text.empty()) list.push_back(text);
  }

  void mount();

  const fs::path& file_;
  const RecordingInfo& info_;
  const Survey& survey_;
  const ReadOptions& options_;
  std::vector<std::string> lidars_;  ///< topics with messages
  std::vector<std::string> imus_;
  GuessedSensors guessed_;
};

/// Mounts all sensors on the body that carries the first LiDAR.
void Guesser::mount() {
  auto& [rig, sensors] = guessed_.description;
  const auto frame_of = [&](const std::map<std::string, std::string>& topics,
                            const std::string& id) {
    for (const auto& [topic, sensor] : topics)
      if (sensor == id) return surveyed(topic).frame_id;
    return std::string{};
  };
  const std::string first = frame_of(sensors.lidars, rig.lidars.front().id);
  if (!survey_.frames.contains(first)) {
    if (options_.body_from_lidar) return;
    guessed_.notes.push_back(
        fmt::format("the file does not state how the LiDAR is mounted (no frame '{}' in "
                    "/tf_static); its frame is taken to be that of the body and of the IMU",
                    first));
    return;
  }
  rig.body_frame = survey_.frames.body_of(first);
  std::vector<std::string> mounted;
  const auto mount_at = [&](const std::string& id, const std::string& frame, Pose& pose) {
    if (const auto found = survey_.frames.find(rig.body_frame, frame)) {
      pose = *found;
      mounted.push_back(frame);
    } else {
      guessed_.warnings.push_back(
          fmt::format("/tf_static does not connect frame '{}' of '{}' with the body '{}'; the "
                      "frames are taken to coincide",
                      frame, id, rig.body_frame));
    }
  };
  for (LidarInfo& lidar : rig.lidars)
    mount_at(lidar.id, frame_of(sensors.lidars, lidar.id), lidar.body_from_lidar);
  for (ImuInfo& imu : rig.imus) mount_at(imu.id, frame_of(sensors.imus, imu.id), imu.body_from_imu);
  guessed_.notes.push_back(fmt::format(
      "/tf_static mounts {} on the body '{}'{}", fmt::join(mounted, ", "), rig.body_frame,
      options_.body_from_lidar ? ", the given extrinsics replace it for the LiDAR" : ""));
}

}  // namespace

GuessedSensors guess_sensors(const fs::path& file, const RecordingInfo& info, const Survey& survey,
                             const ReadOptions& options) {
  return Guesser(file, info, survey, options).guess();
}

}  // namespace lidarena::dataset
