// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/point_truth.hpp"

namespace lidarena {

/// How to read folders of raw sweeps whose layout no file states.
struct ReadOptions {
  std::string sensor;  ///< id of the one LiDAR wanted; empty = all
  std::string layout;  ///< of raw float32 binaries: xyz, xyzi, xyzt, xyztr; empty = must be clear
  std::optional<Pose> body_from_lidar;  ///< overrides what the dataset says
  double rate_hz = 10.0;                ///< sweeps per second where the folder gives no times
};

/// An opened dataset: what an estimator may see. The truth is apart, see load_truth().
struct Dataset {
  std::filesystem::path path;
  Rig rig;
  std::optional<std::size_t> scan_count;  ///< of the chosen sensor, where known beforehand
  Json manifest;                          ///< manifest.json of the folder; null for foreign data
  std::vector<std::string> notes;         ///< what was inferred, not stated: to be shown
  std::unique_ptr<EventSource> events;
};

/// Opens a dataset folder of ours, a single .mcap or ROS 1 .bag, a bag folder of rosbag2 with one
/// .mcap, or a folder of PCD/PLY/bin sweeps. In recordings of others,
/// topics are found by type: the first with scans (PointCloud2, Livox CustomMsg) or that of
/// `options.sensor` (topic or id), and the first Imu, whose accelerations may be in g. Throws
/// InputError naming file, place and remedy.
Dataset open_dataset(const std::filesystem::path& path, const ReadOptions& options = {});

/// True motion of the body where the dataset carries one (truth.tum).
/// For evaluation; nothing that estimates may call it.
std::optional<Trajectory> load_truth(const std::filesystem::path& dataset);

/// What the points of the LiDAR `sensor` (empty = the only one) hit, scan after scan; null when the
/// dataset does not carry it. For evaluation; nothing that estimates may call it. Throws InputError
/// for a sensor that the dataset lacks; next() throws it where the file is broken.
std::unique_ptr<ScanTruthSource> open_scan_truth(const std::filesystem::path& dataset,
                                                 const std::string& sensor = {});

/// The world's mesh beside the dataset (world.ply), if there.
std::optional<std::filesystem::path> find_world_mesh(const std::filesystem::path& dataset);

/// Comment at the head of truth.tum.
inline constexpr const char* kTruthHeader =
    "truth: pose of the body in the world (world_from_body) at the stamped instant\n"
    "time[s] x y z[m] qx qy qz qw";

/// How measurements are stored: one recording, or a folder /ID for each sensor with a file a sweep
/// (000000.pcd, .ply, or velodyne/000000.bin: x y z intensity alone), times.txt and imu.txt.
enum class DatasetFormat { kMcap, kBag, kPcd, kPly, kKitti };
template <>
struct EnumNames<DatasetFormat> {
  static constexpr std::array names{
      std::pair{"mcap", DatasetFormat::kMcap}, std::pair{"bag", DatasetFormat::kBag},
      std::pair{"pcd", DatasetFormat::kPcd}, std::pair{"ply", DatasetFormat::kPly},
      std::pair{"kitti", DatasetFormat::kKitti}};
};

enum class Dialect {
  kSi,      ///< SI units, one layout for all sensors
  kDriver,  ///< the units and layouts of the sensor's own driver, where it is known
};
template <>
struct EnumNames<Dialect> {
  static constexpr std::array names{std::pair{"si", Dialect::kSi},
                                    std::pair{"driver", Dialect::kDriver}};
};

struct WriteOptions {
  DatasetFormat format = DatasetFormat::kMcap;
  Dialect dialect = Dialect::kSi;  ///< of recordings; sweeps are always in SI
  bool compress = false;           ///< chunks of MCAP by zstd; those of bags always are, by LZ4
};

/// Whether a dataset folder holds its measurements; else it is a manifest alone, to be flown.
bool has_measurements(const std::filesystem::path& folder);

/// Writes a dataset folder: data.mcap, truth.tum, metadata.yaml (so that `ros2 bag play` takes the
/// folder), manifest.json; world.ply is the caller's. Files appear under their names only once
/// complete, manifest.json last: a folder without one is unfinished. An older dataset in the folder
/// is replaced.
///
/// data.mcap holds /ID/points and /ID/imu (an IMU may share its LiDAR's id), /truth/odometry, /tf
/// (world to body) and /tf_static (body to ID_lidar and ID_imu). A scan's header.stamp is its first
/// firing; its publish time the last, when a driver could send it. The log time of a measurement is
/// its publish time, or that of the measurement before if that is later, so the order of the events
/// survives readers that sort by log time. The rig and the topics are in the metadata record
/// "lidarena".
class DatasetWriter : public EventSink, public ScanTruthSink {
 public:
  /// `path` is the folder; or, where it ends in .mcap or .bag, a single file of that format,
  /// without anything beside it. Throws InputError when it cannot be made or two LiDARs (or IMUs)
  /// have one id.
  DatasetWriter(const std::filesystem::path& path, const Rig& rig,
                const WriteOptions& options = {});
  ~DatasetWriter() override;
  /// In the order of EventSource. Throws InputError for a sensor that the rig lacks, a negative
  /// time, or a point before its scan's stamp; Error when the disk is full.
  void write(const Event& event) override;
  /// What a scan's points hit, before or after the scan: /truth/ID/hits. Throws InputError for a
  /// LiDAR that the rig lacks.
  void write(const ScanTruth& truth) override;
  /// True body pose, at the full rate, in order of time; also written as /truth/odometry and /tf.
  void write_truth(const StampedPose& pose);
  /// Completes all files. The keys of `manifest` are added to those of manifest.json that every
  /// dataset has: format, format_version, rig, topics, message_counts, start_ns, end_ns.
  void finish(const Json& manifest);
  /// finish() without further keys, if that was not called.
  void close() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What copy_dataset() carried over.
struct CopySummary {
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t imu_samples = 0;
  std::size_t poses = 0;        ///< of the truth
  std::size_t truth_scans = 0;  ///< whose points' truth came along
};

/// Writes an opened dataset anew to `out`, a folder or a file as DatasetWriter takes it: events,
/// the rig, the truth of path and points where `in.path` has one, and from folder to folder the
/// world and the manifest's other keys. Throws InputError where the input is broken (what was
/// written stays unfinished) or `out` is the input itself; Error when the disk is full.
CopySummary copy_dataset(Dataset& in, const std::filesystem::path& out,
                         const WriteOptions& options = {});

}  // namespace lidarena
