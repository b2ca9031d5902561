// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

/// The ground truth of a dataset, copied in time order together with its events.
class TruthCopier {
 public:
  TruthCopier(const Dataset& in, const OpenTruth& open_truth) : trajectory_(load_truth(in.path)) {
    for (const LidarInfo& lidar : in.rig.lidars) {
      if (!may_have_point_truth(in)) break;
      auto hits = open_scan_truth(in.path, lidar.id);
      if (!hits && open_truth) hits = open_truth(lidar.id);
      if (hits) hits_[lidar.id] = std::move(hits);
    }
  }

  /// Copies the poses up to `time`.
  void copy_poses(Time time, DatasetWriter& out, CopySummary& summary) {
    if (!trajectory_) return;
    for (; next_ < trajectory_->size() && trajectory_->poses()[next_].stamp <= time; ++next_) {
      out.write_truth(trajectory_->poses()[next_]);
      ++summary.poses;
    }
  }

  /// Copies the ground truth of the points of the next scan.
  void copy_hits(const std::string& id, DatasetWriter& out, CopySummary& summary) {
    const auto source = hits_.find(id);
    if (source == hits_.end()) return;
    if (const auto truth = source->second->next()) {
      out.write(*truth);
      ++summary.truth_scans;
    }
  }

 private:
  /// Third-party data have no ground truth of points (and LiDAR ids made up by the reader).
  static bool may_have_point_truth(const Dataset& in) {
    if (fs::is_directory(in.path)) return fs::exists(in.path / layout::kManifest);
    return recording_format_of(in.path) &&
           layout::description_in(read_recording_info(in.path), in.path.string());
  }

  std::optional<Trajectory> trajectory_;
  std::size_t next_ = 0;
  std::map<std::string, std::unique_ptr<ScanTruthSource>> hits_;
};

/// The keys of the manifest that do not describe how the measurements are stored.
Json keys_without_storage(const Json& manifest) {
  Json kept = Json::object();
  if (!manifest.is_object()) return kept;
  for (const auto& [key, value] : manifest.items()) {
    const bool is_storage = key == "topics" || key == "message_counts" || key == "storage" ||
                            key == "dialect" || key == "start_ns" || key == "end_ns" ||
                            key.ends_with("_counts");
    if (!is_storage) kept[key] = value;
  }
  return kept;
}

void check_not_same_dataset(const fs::path& in, const fs::path& out) {
  std::error_code error;
  const bool into_itself =
      fs::exists(out) && (fs::equivalent(in, out, error) ||
                          fs::equivalent(fs::absolute(in).parent_path(), out, error));
  if (into_itself) {
    throw InputError(out.string(), "is the dataset that is to be converted",
                     "choose another output path");
  }
}

}  // namespace

CopySummary copy_dataset(Dataset& in, const fs::path& out, const WriteOptions& options,
                         const OpenTruth& open_truth) {
  check_not_same_dataset(in.path, out);
  TruthCopier truth(in, open_truth);
  DatasetWriter writer(out, in.rig, options);
  CopySummary summary;
  while (const auto event = in.events->next()) {
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      ++summary.scans;
      summary.points += scan->points.size();
      truth.copy_poses(scan->stamp, writer, summary);
      truth.copy_hits(event->sensor_id, writer, summary);
    } else {
      ++summary.imu_samples;
      truth.copy_poses(std::get<ImuSample>(event->data).stamp, writer, summary);
    }
    writer.write(*event);
  }
  truth.copy_poses(Time::max(), writer, summary);
  const auto world = fs::is_directory(in.path) ? find_world_mesh(in.path) : std::nullopt;
  if (world && fs::is_directory(out)) {
    fs::copy_file(*world, out / layout::kWorld, fs::copy_options::overwrite_existing);
  }
  writer.finish(keys_without_storage(in.manifest));
  return summary;
}

}  // namespace lidarena::dataset
