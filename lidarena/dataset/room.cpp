// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/room.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/imu_text.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/sweep_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectory_rows.hpp"
#include "lidarena/dataset/tum.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct Meta {
  std::vector<std::string> columns;
  Pose body_from_lidar = Pose::Identity();
  std::string truth;  ///< frame of gt.tum
};

/// One row of scans.txt.
struct ScanRow {
  std::size_t index = 0;
  Time begin{0};
};

Pose parse_extrinsics(const Json& json, const std::string& place) {
  const auto v = json.at("body_from_lidar").get<std::vector<double>>();
  if (v.size() != 7) {
    throw InputError(place, fmt::format("body_from_lidar holds {} numbers, not 7", v.size()),
                     "write [x, y, z, qx, qy, qz, qw]");
  }
  return pose_from_row({v[0], v[1], v[2]}, Eigen::Quaterniond(v[6], v[3], v[4], v[5]),
                       place + ": body_from_lidar");
}

Meta read_meta(const fs::path& folder) {
  const fs::path file = folder / "meta.json";
  const Json json = read_json(file);
  try {
    Meta meta{json.at("columns").get<std::vector<std::string>>(),
              parse_extrinsics(json, file.string()), json.value("truth", std::string("imu frame"))};
    if (json.value("time", std::string("absolute seconds")) != "absolute seconds") {
      throw InputError(file.string(), "the time of points is not 'absolute seconds'");
    }
    if (meta.columns.empty()) throw InputError(file.string(), "columns is empty");
    return meta;
  } catch (const Json::exception& error) {
    throw InputError(file.string(), error.what(),
                     "it needs columns (names) and body_from_lidar (7 numbers)");
  }
}

std::vector<ScanRow> read_scan_rows(const fs::path& file) {
  TextRows rows(file);
  std::vector<ScanRow> scans;
  while (const auto row = rows.next()) {
    const auto words = split_words(*row);
    const std::string place = rows.place();
    if (words.size() != 3) {
      throw InputError(place, fmt::format("holds {} columns, not 3", words.size()),
                       "rows are index t_begin t_end");
    }
    const double index = finite_number(words[0], place);
    if (!(index >= 0.0 && index < 1e9 && index == static_cast<double>(static_cast<long>(index)))) {
      throw InputError(place, fmt::format("'{}' is no index of a scan", words[0]));
    }
    scans.push_back({static_cast<std::size_t>(index), seconds_at(words[1], place)});
    if (scans.size() > 1 && scans.back().begin <= scans[scans.size() - 2].begin) {
      throw InputError(place, "the scan does not begin later than the one before",
                       "sort the rows by time");
    }
  }
  if (scans.empty()) throw InputError(file.string(), "names no scan");
  return scans;
}

Scan read_scan(const fs::path& file, const std::vector<std::string>& columns, Time begin) {
  PointTable table{file.string(), read_bytes(file), 0, {}};
  const std::size_t stride = columns.size() * sizeof(double);
  if (table.bytes.size() % stride != 0) {
    throw InputError(table.file,
                     fmt::format("its {} bytes are no whole number of points of {} bytes",
                                 table.bytes.size(), stride),
                     "the file is cut short, or meta.json names other columns");
  }
  table.size = table.bytes.size() / stride;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    table.columns.push_back({columns[i], ScalarType::kFloat64, i * sizeof(double), stride});
  }
  Scan scan = scan_from(table, begin);
  if (!scan.timed || scan.points.empty()) return scan;
  return starting_at(std::move(scan), begin, table.file);
}

class RoomSource : public EventSource {
 public:
  RoomSource(fs::path folder, Meta meta, std::vector<ScanRow> scans, std::vector<ImuSample> imu)
      : folder_(std::move(folder)),
        meta_(std::move(meta)),
        scans_(std::move(scans)),
        imu_(std::move(imu)) {}

  std::optional<Event> next() override {
    if (!scan_ && next_scan_ < scans_.size()) load_scan();
    const bool imu_first =
        next_imu_ < imu_.size() && (!scan_ || imu_[next_imu_].stamp <= end_of(*scan_));
    if (imu_first) return Event{"imu", imu_[next_imu_++]};
    if (!scan_) return std::nullopt;
    Event event{"lidar", std::move(*scan_)};
    scan_.reset();
    return event;
  }

 private:
  void load_scan() {
    const ScanRow& row = scans_[next_scan_++];
    scan_ = read_scan(folder_ / "scans" / fmt::format("{:06}.bin", row.index), meta_.columns,
                      row.begin);
  }

  fs::path folder_;
  Meta meta_;
  std::vector<ScanRow> scans_;
  std::vector<ImuSample> imu_;
  std::size_t next_scan_ = 0;
  std::size_t next_imu_ = 0;
  std::optional<Scan> scan_;  ///< read, waiting for the IMU samples up to its end
};

/// Events per second between the first and the last; `otherwise` when there are fewer than two.
double mean_rate(std::size_t count, Time first, Time last, double otherwise) {
  return count < 2 ? otherwise : static_cast<double>(count - 1) / to_seconds(last - first);
}

}  // namespace

bool is_room(const fs::path& path) {
  return fs::is_regular_file(path / "meta.json") && fs::is_regular_file(path / "scans.txt") &&
         fs::is_directory(path / "scans");
}

Dataset open_room(const fs::path& path, const ReadOptions& options) {
  const Meta meta = read_meta(path);
  auto scans = read_scan_rows(path / "scans.txt");
  std::vector<ImuSample> imu;
  if (fs::exists(path / "imu.txt")) imu = read_imu_text(path / "imu.txt");
  Dataset dataset;
  dataset.path = path;
  dataset.rig = single_lidar_rig(path, options, meta.body_from_lidar);
  LidarInfo& lidar = dataset.rig.lidars.front();
  lidar.rate_hz = mean_rate(scans.size(), scans.front().begin, scans.back().begin, lidar.rate_hz);
  if (!imu.empty()) {
    ImuInfo info;
    info.id = "imu";
    info.rate_hz = mean_rate(imu.size(), imu.front().stamp, imu.back().stamp, info.rate_hz);
    dataset.rig.imus.push_back(info);
  }
  dataset.scan_count = scans.size();
  dataset.events = std::make_unique<RoomSource>(path, meta, std::move(scans), std::move(imu));
  return dataset;
}

std::optional<Trajectory> room_truth(const fs::path& path) {
  const fs::path file = path / "gt.tum";
  if (!fs::exists(file)) return std::nullopt;
  const Trajectory truth = read_tum(file);
  const Meta meta = read_meta(path);
  if (meta.truth == "imu frame" || meta.truth == "body frame") return truth;
  if (meta.truth != "lidar frame") {
    throw InputError((path / "meta.json").string(),
                     fmt::format("truth of the '{}' is not known", meta.truth),
                     "it is of the 'imu frame' or the 'lidar frame'");
  }
  const Pose lidar_from_body = meta.body_from_lidar.inverse();
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : truth.poses()) {
    poses.push_back({pose.stamp, pose.world_from_body * lidar_from_body});
  }
  return Trajectory(std::move(poses), file.string());
}

}  // namespace lidarena
