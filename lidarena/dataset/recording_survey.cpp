// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording_survey.hpp"

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/imu_units.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/packets/velodyne_packets.hpp"
#include "lidarena/dataset/recording_source.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::size_t kSweeps = 12;     // a second: periods and spans have a median
constexpr std::size_t kSamples = 1000;  // 5 s at 200 Hz: motion, not only the rest before it
constexpr std::size_t kFrames = 10;     // messages of /tf_static, which come first

template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return T{0};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_static_frames(const RecordedTopic& topic) {
  return encoding_of(topic) && topic.type == ros::kTfMessage && topic.topic.ends_with("tf_static");
}

class Surveyor {
 public:
  explicit Surveyor(const RecordingInfo& info) {
    for (const RecordedTopic& topic : info.topics) {
      if (topic.message_count == 0 || topic.topic.starts_with(layout::kTruthPrefix)) continue;
      const std::size_t most = is_scan_type(topic)       ? kSweeps
                               : is_imu_type(topic)      ? kSamples
                               : is_static_frames(topic) ? kFrames
                                                         : 0;
      if (most == 0) continue;
      left_[topic.topic] += std::min<std::uint64_t>(most, topic.message_count);
    }
  }

  bool is_done() const {
    return std::ranges::all_of(left_, [](const auto& entry) { return entry.second == 0; });
  }

  void take(const RecordedMessage& message) {
    const std::string topic(message.topic);
    const auto left = left_.find(topic);
    if (left == left_.end() || left->second == 0) return;
    try {
      if (message.type == ros::kTfMessage) {
        for (const auto& t : ros::decode_transforms(message.data, topic, message.encoding))
          survey_.frames.add(t);
      } else {
        if (look_at(message, topic, survey_.topics[topic])) return;
      }
    } catch (const InputError& error) {
      survey_.topics[topic].fault = error.what();
    }
    --left->second;
  }

  Survey take_survey() { return std::move(survey_); }

 private:
  /// True for a message that does not count: samples before an IMU has started are zero.
  static bool look_at(const RecordedMessage& message, const std::string& place,
                      SurveyedTopic& topic) {
    MessageReader in(message.data, place, message.encoding);
    ros::MessageHeader header = ros::get_header(in);
    topic.frame_id = std::move(header.frame_id);
    topic.stamps.push_back(header.stamp);
    topic.log_times.push_back(message.log_time);
    if (message.type == ros::kImu) {
      topic.samples.push_back(ros::decode_imu(message.data, place, message.encoding));
      return topic.samples.back().accel.isZero(0.0);
    }
    if (is_livox_type(message.type)) {
      look_at(decode_livox(message.data, place, message.encoding), "offset_time", topic);
    } else if (is_velodyne_type(message.type)) {
      look_at(decode_velodyne(message.data, place, message.encoding), "packets", topic);
    } else {
      const ros::PointCloud2 cloud = ros::get_cloud(in, place);
      topic.sweeps.push_back(ros::times_in(header.stamp, cloud, place));
      topic.points += std::size_t{cloud.width} * cloud.height;
      topic.has_rings = ros::has_rings(cloud);
    }
    return false;
  }

  static void look_at(const Scan& scan, const char* times, SurveyedTopic& topic) {
    const auto last = static_cast<double>((end_of(scan) - scan.stamp).count());
    topic.sweeps.push_back({times, false, scan.stamp, 0.0, last});
    topic.points += scan.points.size();
    topic.has_rings = true;
  }

  std::map<std::string, std::uint64_t> left_;  ///< messages to look at
  Survey survey_;
};

}  // namespace

double SurveyedTopic::clock_offset_s() const {
  std::vector<double> offsets;
  for (std::size_t i = 0; i < stamps.size(); ++i)
    offsets.push_back(to_seconds(stamps[i]) - to_seconds(log_times[i]));
  return median(std::move(offsets));
}

Time SurveyedTopic::period() const {
  std::vector<Time> periods;
  for (std::size_t i = 1; i < stamps.size(); ++i) periods.push_back(stamps[i] - stamps[i - 1]);
  return median(std::move(periods));
}

Survey survey_recording(const std::filesystem::path& file, const RecordingInfo& info) {
  Surveyor surveyor(info);
  const auto reader = open_recording(file);
  try {
    while (!surveyor.is_done()) {
      const auto message = reader->next();
      if (!message) break;
      surveyor.take(*message);
    }
  } catch (const DamagedFile&) {
    // What comes before the damage is judged.
  }
  return surveyor.take_survey();
}

}  // namespace lidarena::dataset
