// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "lidarena/dataset/run_files.hpp"
#include "lidarena/map/occupied_voxels.hpp"
#include "lidarena/odometry/run.hpp"
#include "lidarena/stages/event_record.hpp"
#include "lidarena/stages/motion_record.hpp"

namespace lidarena::stages {

/// How the map of a run is recorded.
struct MapRecord {
  bool is_kept = true;
  double voxel_size_m = 0.02;    ///< the first point of each voxel is kept
  std::filesystem::path file{};  ///< written while scans come; empty: the map stays in memory
};

/// Collects the files of a run while it goes on.
class Recorder final : public odometry::RunObserver {
 public:
  Recorder(odometry::Odometry& odometry, LogSink& log, const MapRecord& map = {});

  void take(const ImuSample& sample) override { events_.add(sample); }
  void take(const Scan& scan, const odometry::ScanResult& result,
            const odometry::ScanCost& cost) override;
  /// Call after the run: all files but `reprojected` and `manifest`. Of a run that diverged the
  /// trajectory is that of the live estimates, since the odometry's own may be invalid. The map is
  /// empty if it was written to a file, or not kept.
  dataset::RunFiles finish(bool diverged);

 private:
  void keep_result(const odometry::ScanResult& result);
  void keep_published();
  void keep_resources(const Scan& scan, const odometry::ScanCost& cost);

  odometry::Odometry& odometry_;
  LogSink& log_;
  bool keeps_map_;
  std::optional<Time> first_stamp_;
  std::vector<StampedPose> live_;
  MotionRecord motion_;
  EventRecord events_;
  map::OccupiedVoxels voxels_;
  dataset::Cloud map_;
  std::optional<dataset::CloudWriter> map_file_;
  std::vector<dataset::ResourceRow> resources_;
};

struct RunResult {
  dataset::RunFiles files;  ///< all except `reprojected` and `manifest`
  odometry::RunSummary summary;
};

/// odometry::run() with its files recorded.
RunResult record_run(odometry::Odometry& odometry, EventSource& events,
                     const odometry::RunOptions& options, LogSink& log, const MapRecord& map = {});

}  // namespace lidarena::stages
