// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/event.hpp"
#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/read_report.hpp"

namespace lidarena::dataset {

/// What to read, and values that the data themselves may not state.
struct ReadOptions {
  std::string sensor;     ///< id or topic of the only LiDAR to read; empty = all
  std::string imu_topic;  ///< of a recording: the IMU to read; empty = the one of the LiDAR
  /// Of a recording of others: read all LiDARs and IMUs, not only those of one odometry.
  bool all_sensors = false;
  std::string layout;  ///< of raw .bin files: xyz, xyzi, xyzt, xyztr; empty = inferred
  std::optional<Pose> body_from_lidar;  ///< overrides the mounting in the dataset
  double rate_hz = 10.0;                ///< sweep rate, for folders without times
};

/// A topic of a recording, for the user.
struct TopicSummary {
  static constexpr const char* kTitle = "TopicSummary";
  std::string topic, type, frame_id;
  std::uint64_t messages = 0;
  double rate_hz = 0.0;
  bool is_read = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("topic", self.topic, "", "");
    v("type", self.type, "", "");
    v("frame_id", self.frame_id, "",
      "of scans and IMU samples in recordings of others, else empty");
    v("messages", self.messages, "", "");
    v("rate_hz", self.rate_hz, "Hz", "0: unknown");
    v("is_read", self.is_read, "", "whether its messages become events");
  }
};

/// An opened dataset: all that an estimator may use. Ground truth is separate, see load_truth().
struct Dataset {
  std::filesystem::path path;
  Rig rig;
  std::optional<std::size_t> scan_count;  ///< of the chosen LiDAR, if known before reading
  Json manifest;                      ///< manifest.json of the folder; null for third-party data
  std::vector<std::string> notes;     ///< assumptions and damage, to be shown to the user
  std::vector<std::string> warnings;  ///< faults that make a run wrong, likewise
  /// Why the IMU of the recording cannot be used with its LiDAR (the rig is then without it).
  std::string imu_fault;
  std::vector<TopicSummary> topics;  ///< of a recording of messages
  std::shared_ptr<void> unpacked;    ///< temporary files that the events are read from
  std::unique_ptr<EventSource> events;
  /// Filled while the events are read; never null.
  std::shared_ptr<ReadReport> report = std::make_shared<ReadReport>();
};

/// Whether `path` is a recording of messages, or a folder with recordings.
bool is_recording(const std::filesystem::path& path);

/// Opens a Lidarena dataset folder, a recording (see open_recording()), or a folder of PCD/PLY/bin
/// sweeps. What recordings of others do not state is inferred, and said: see guess_sensors.hpp.
/// Throws InputError naming file, place and remedy.
Dataset open_dataset(const std::filesystem::path& path, const ReadOptions& options = {});

/// Ground-truth trajectory of the body if the dataset has one (truth.tum). For evaluation only:
/// estimators must not call it.
std::optional<Trajectory> load_truth(const std::filesystem::path& dataset);

/// Ground truth of the points of the LiDAR `sensor` (empty = the only one), scan by scan; null when
/// the dataset has none. For evaluation only: estimators must not call it. Throws InputError for a
/// sensor that the dataset lacks; next() throws it where the file is damaged.
std::unique_ptr<ScanTruthSource> open_scan_truth(const std::filesystem::path& dataset,
                                                 const std::string& sensor = {});

/// The world mesh in the dataset folder (world.ply), if it exists.
std::optional<std::filesystem::path> find_world_mesh(const std::filesystem::path& dataset);

/// Comment at the head of truth.tum.
inline constexpr const char* kTruthHeader =
    "truth: pose of the body in the world (world_from_body) at the stamped instant\n"
    "time[s] x y z[m] qx qy qz qw";

/// How measurements are stored: in one recording (MCAP, bag), or in a folder ID for each sensor
/// with one file per sweep (000000.pcd, .ply, or velodyne/000000.bin with only x y z intensity, and
/// labels/000000.label), times.txt and imu.txt.
enum class DatasetFormat { kMcap, kBag, kPcd, kPly, kKitti };
constexpr auto enum_names(DatasetFormat) {
  return std::array{std::pair{"mcap", DatasetFormat::kMcap}, std::pair{"bag", DatasetFormat::kBag},
                    std::pair{"pcd", DatasetFormat::kPcd}, std::pair{"ply", DatasetFormat::kPly},
                    std::pair{"kitti", DatasetFormat::kKitti}};
}

enum class Dialect {
  kSi,      ///< SI units, one layout for all sensors
  kDriver,  ///< the units and layouts of the manufacturer's driver, if it is known
};
constexpr auto enum_names(Dialect) {
  return std::array{std::pair{"si", Dialect::kSi}, std::pair{"driver", Dialect::kDriver}};
}

struct WriteOptions {
  DatasetFormat format = DatasetFormat::kMcap;
  Dialect dialect = Dialect::kSi;  ///< of recordings; sweeps are always in SI
  bool compress = false;  ///< MCAP chunks, by zstd; bag chunks are always compressed, by LZ4
  /// Of KITTI sweeps: labels by PointTruth::triangle, see write_labels(). Empty: none are written.
  std::vector<std::uint32_t> labels{};
};

/// Opens the ground truth of the points of a LiDAR.
using OpenTruth = std::function<std::unique_ptr<ScanTruthSource>(const std::string& lidar)>;

/// Whether a dataset folder holds measurements; without them it holds only a manifest, from which
/// they are simulated.
bool has_measurements(const std::filesystem::path& folder);

/// Writes a dataset folder: data.mcap, truth.tum, metadata.yaml (so that `ros2 bag play` accepts
/// the folder) and manifest.json; the caller writes world.ply. Files get their names only when
/// complete, manifest.json last: a folder without it is unfinished. An older dataset in the folder
/// is replaced.
///
/// data.mcap holds /ID/points and /ID/imu (an IMU may have the id of its LiDAR), /truth/odometry,
/// /tf (world to body) and /tf_static (body to ID_lidar and ID_imu). A scan's header.stamp is the
/// time of its first firing; its publish time is that of its last firing, when a driver could send
/// it. The log time of a measurement is its publish time, or the log time of the previous
/// measurement if that is later, so that readers that sort by log time keep the order of the
/// events. The rig and the topics are in the metadata record "lidarena".
class DatasetWriter : public EventSink, public ScanTruthSink {
 public:
  /// `path` is a folder or, if it ends in .mcap or .bag, a single file of that format with no other
  /// files. Throws InputError when it cannot be created or two LiDARs (or two IMUs) have the same
  /// id.
  DatasetWriter(const std::filesystem::path& path, const Rig& rig,
                const WriteOptions& options = {});
  ~DatasetWriter() override;
  /// Events must come in the order of EventSource. Throws InputError for a sensor that the rig
  /// lacks, a negative time, or a point earlier than its scan's stamp; Error when the disk is full.
  void write(const Event& event) override;
  /// Ground truth of a scan's points, given before or after the scan; stored as /truth/ID/hits.
  /// Throws InputError for a LiDAR that the rig lacks.
  void write(const ScanTruth& truth) override;
  /// Ground-truth body pose at the full rate, in time order; also written as /truth/odometry and
  /// /tf.
  void write_truth(const StampedPose& pose);
  /// Completes all files. The keys of `manifest` are added to those that every manifest.json has:
  /// format, format_version, rig, topics, message_counts, start_ns, end_ns.
  void finish(const Json& manifest);
  /// Calls finish() without further keys, unless it was called already.
  void close() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Counts of what copy_dataset() copied.
struct CopySummary {
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t imu_samples = 0;
  std::size_t poses = 0;        ///< of the ground-truth trajectory
  std::size_t truth_scans = 0;  ///< scans with ground truth of their points
};

/// Copies an opened dataset to `out`, a folder or a file as for DatasetWriter: events, the rig,
/// ground truth of trajectory and points if `in.path` has them and, from folder to folder, the
/// world mesh and the other keys of the manifest. Throws InputError when the input is damaged (the
/// copy then stays unfinished) or `out` is the input itself; Error when the disk is full.
/// `open_truth`, if given, opens the truth of points of datasets that do not store it.
CopySummary copy_dataset(Dataset& in, const std::filesystem::path& out,
                         const WriteOptions& options = {}, const OpenTruth& open_truth = {});

}  // namespace lidarena::dataset
