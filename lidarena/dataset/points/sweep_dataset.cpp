// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/sweep_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/imu_text.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/points/pcd.hpp"
#include "lidarena/dataset/points/sweep_file.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/stream_merge.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"

namespace lidarena::dataset {

namespace fs = std::filesystem;

namespace layout {

fs::path sweep_path(const fs::path& folder, const std::string& lidar_id, DatasetFormat format,
                    std::size_t index) {
  const std::string number = fmt::format("{:06}", index);
  const fs::path sensor_folder = folder / lidar_id;
  if (format == DatasetFormat::kKitti) return sensor_folder / "velodyne" / (number + ".bin");
  return sensor_folder / (number + (format == DatasetFormat::kPly ? ".ply" : ".pcd"));
}

fs::path hits_path(const fs::path& folder, const std::string& lidar_id, std::size_t index) {
  return folder / lidar_id / kHits / fmt::format("{:06}.pcd", index);
}

fs::path labels_path(const fs::path& folder, const std::string& lidar_id, std::size_t index) {
  return folder / lidar_id / kLabels / fmt::format("{:06}.label", index);
}

}  // namespace layout

namespace {

constexpr const char* kStorage = "storage";  ///< key of the manifest

DatasetFormat format_of(const Json& manifest) {
  const auto name = manifest.at(kStorage).get<std::string>();
  for (const auto& [known, format] : enum_names(DatasetFormat{})) {
    if (name == known) return format;
  }
  return DatasetFormat::kMcap;
}

/// The count `key` of a sensor in the manifest; 0 if the manifest has none.
std::size_t count_in(const Json& manifest, const char* key, const std::string& id,
                     const std::string& place) {
  const auto counts = manifest.find(key);
  if (counts == manifest.end() || !counts->is_object() || !counts->contains(id)) return 0;
  const Json& count = (*counts)[id];
  if (!count.is_number_unsigned()) {
    throw InputError(place, fmt::format("{} of '{}' is not a count", key, id));
  }
  return count.get<std::size_t>();
}

/// Sweeps of one LiDAR; reads one sweep ahead.
class Sweeps {
 public:
  Sweeps(fs::path folder, std::string id, DatasetFormat format, std::size_t count)
      : folder_(std::move(folder)), id_(std::move(id)), format_(format) {
    const fs::path file = folder_ / id_ / layout::kTimes;
    stamps_ = read_times(file);
    if (stamps_.size() != count) {
      throw InputError(
          file.string(),
          fmt::format("holds {} times, but the manifest counts {} scans", stamps_.size(), count),
          "the folder is incomplete or mixed with another; write it again");
    }
  }

  const std::string& id() const { return id_; }
  std::size_t count() const { return stamps_.size(); }

  /// End time of the next sweep; empty if there is none.
  std::optional<Time> end() {
    if (!scan_ && next_ < stamps_.size()) {
      scan_ = read_sweep(layout::sweep_path(folder_, id_, format_, next_), stamps_[next_],
                         format_ == DatasetFormat::kKitti ? "xyzi" : "");
      ++next_;
    }
    return scan_ ? std::optional(end_of(*scan_)) : std::nullopt;
  }

  Event take() {
    Event event{id_, std::move(*scan_)};
    scan_.reset();
    return event;
  }

 private:
  fs::path folder_;
  std::string id_;
  DatasetFormat format_;
  std::vector<Time> stamps_;
  std::size_t next_ = 0;
  std::optional<Scan> scan_;
};

struct ImuRows {
  std::string id;
  std::vector<ImuSample> samples;
  std::size_t next = 0;

  bool empty() const { return next == samples.size(); }
  Time stamp() const { return samples[next].stamp; }
};

class SweepDatasetSource final : public EventSource {
 public:
  SweepDatasetSource(const fs::path& folder, std::vector<Sweeps> lidars, std::vector<ImuRows> imus)
      : lidars_(std::move(lidars)),
        imus_(std::move(imus)),
        merge_(folder.string(), ids_with_samples(imus_)) {}

  std::optional<Event> next() override {
    while (true) {
      if (auto event = merge_.pop()) return event;
      if (finished_) return std::nullopt;
      read_next();
    }
  }

 private:
  static std::vector<std::string> ids_with_samples(const std::vector<ImuRows>& imus) {
    std::vector<std::string> ids;
    for (const ImuRows& imu : imus) {
      if (!imu.empty()) ids.push_back(imu.id);
    }
    return ids;
  }

  /// Pushes the next IMU sample, or the next scan if it ends before that sample.
  void read_next() {
    ImuRows* imu = nullptr;
    for (ImuRows& candidate : imus_) {
      if (candidate.empty()) continue;
      if (imu == nullptr || candidate.stamp() < imu->stamp()) imu = &candidate;
    }
    Sweeps* lidar = nullptr;
    for (Sweeps& candidate : lidars_) {
      if (!candidate.end()) continue;
      if (lidar == nullptr || *candidate.end() < *lidar->end()) lidar = &candidate;
    }
    if (imu != nullptr && (lidar == nullptr || imu->stamp() <= *lidar->end())) {
      merge_.push({imu->id, imu->samples[imu->next++]});
    } else if (lidar != nullptr) {
      merge_.push(lidar->take());
    } else {
      merge_.finish();
      finished_ = true;
    }
  }

  std::vector<Sweeps> lidars_;
  std::vector<ImuRows> imus_;
  StreamMerge merge_;
  bool finished_ = false;
};

class SweepTruth final : public ScanTruthSource {
 public:
  SweepTruth(fs::path folder, std::string id, std::size_t count)
      : folder_(std::move(folder)),
        id_(std::move(id)),
        stamps_(read_times(folder_ / id_ / layout::kTimes)),
        count_(std::min(count, stamps_.size())) {}

  std::optional<ScanTruth> next() override {
    if (next_ == count_) return std::nullopt;
    const std::size_t index = next_++;
    return ScanTruth{id_, stamps_[index], read_hits(layout::hits_path(folder_, id_, index))};
  }

 private:
  fs::path folder_;
  std::string id_;
  std::vector<Time> stamps_;
  std::size_t count_;
  std::size_t next_ = 0;
};

constexpr std::array<const char*, 7> kHitFields{"x",        "y",        "z",       "range",
                                                "normal_x", "normal_y", "normal_z"};

}  // namespace

void write_labels(const fs::path& file, const std::vector<PointTruth>& points,
                  const std::vector<std::uint32_t>& labels) {
  std::string bytes;
  bytes.reserve(4 * points.size());
  for (const PointTruth& point : points) {
    const bool is_stray = point.triangle == kAir || point.triangle == kGhost;
    const std::uint32_t label = point.triangle < labels.size() ? labels[point.triangle]
                                : is_stray                     ? kOutlier
                                                               : kUnlabeled;
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(label >> shift & 0xFFU);
  }
  write_text_file(file, bytes);
}

void write_hits(const fs::path& file, const std::vector<PointTruth>& points) {
  std::string text = fmt::format(
      "VERSION 0.7\nFIELDS {} triangle\nSIZE 4 4 4 4 4 4 4 4\nTYPE F F F F F F F U\n"
      "COUNT 1 1 1 1 1 1 1 1\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\n"
      "DATA binary\n",
      fmt::join(kHitFields, " "), points.size(), points.size());
  // the memory layout of PointTruth
  text.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(PointTruth));
  write_text_file(file, text);
}

std::vector<PointTruth> read_hits(const fs::path& file) {
  const PointTable table = read_pcd_table(file);
  const Column& triangle = table.require("triangle");
  std::vector<PointTruth> points(table.size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<float, kHitFields.size()> values{};
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = static_cast<float>(table.number(table.require(kHitFields[k]), i));
    }
    points[i] = {{values[0], values[1], values[2]},
                 values[3],
                 {values[4], values[5], values[6]},
                 static_cast<std::uint32_t>(table.integer(triangle, i))};
  }
  return points;
}

bool is_sweep_dataset(const Json& manifest) {
  if (!manifest.is_object() || !manifest.contains(kStorage)) return false;
  if (!manifest[kStorage].is_string()) return false;
  const DatasetFormat format = format_of(manifest);
  return format != DatasetFormat::kMcap && format != DatasetFormat::kBag;
}

Dataset open_sweep_dataset(const fs::path& folder, Rig rig, Json manifest,
                           const ReadOptions& options) {
  const std::string place = (folder / layout::kManifest).string();
  choose_lidar(options, place, rig);
  const DatasetFormat format = format_of(manifest);
  std::vector<Sweeps> lidars;
  for (const LidarInfo& lidar : rig.lidars) {
    lidars.emplace_back(folder, lidar.id, format,
                        count_in(manifest, "scan_counts", lidar.id, place));
  }
  std::vector<ImuRows> imus;
  for (const ImuInfo& imu : rig.imus) {
    const fs::path file = folder / imu.id / layout::kImu;
    imus.push_back({imu.id, read_imu_text(file)});
    if (imus.back().samples.size() != count_in(manifest, "imu_counts", imu.id, place)) {
      throw InputError(file.string(), "holds another number of samples than the manifest counts",
                       "the folder is incomplete or mixed with another; write it again");
    }
  }
  Dataset dataset;
  dataset.path = folder;
  if (lidars.size() == 1) dataset.scan_count = lidars.front().count();
  dataset.rig = std::move(rig);
  dataset.manifest = std::move(manifest);
  dataset.events = std::make_unique<SweepDatasetSource>(folder, std::move(lidars), std::move(imus));
  return dataset;
}

std::unique_ptr<ScanTruthSource> open_sweep_truth(const fs::path& folder, const Json& manifest,
                                                  const std::string& sensor) {
  const std::string place = (folder / layout::kManifest).string();
  if (!manifest.contains("rig")) throw InputError(place, "lacks \"rig\"");
  const Rig rig = layout::rig_from_json(manifest["rig"], place);
  const LidarInfo* lidar = rig.find_lidar(sensor);
  if (lidar == nullptr) {
    throw InputError(place, "has no LiDAR '" + sensor + "', or has several", "name the sensor");
  }
  const std::size_t count = count_in(manifest, "hit_counts", lidar->id, place);
  return count == 0 ? nullptr : std::make_unique<SweepTruth>(folder, lidar->id, count);
}

}  // namespace lidarena::dataset
