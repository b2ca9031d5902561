// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/imu_text.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/points/sweep_dataset.hpp"
#include "lidarena/dataset/points/sweep_file.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

/// Creates the folder of a sensor and removes the sweeps of an older dataset from it.
void prepare(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    const bool is_numbered =
        stem.size() == 6 && std::ranges::all_of(stem, [](char c) { return c >= '0' && c <= '9'; });
    if (is_numbered && entry.is_regular_file()) fs::remove(entry.path(), error);
  }
}

void check_name(const std::string& id) {
  if (fs::path(id).filename() == id && id != "." && id != ".." && !id.empty()) return;
  throw InputError("rig", "'" + id + "' cannot be the name of a folder", "rename the sensor");
}

class SweepStore final : public DatasetStore {
 public:
  SweepStore(const fs::path& folder, const Rig& rig, const WriteOptions& options)
      : folder_(folder), format_(options.format), labels_(options.labels) {
    for (const LidarInfo& lidar : rig.lidars) check_name(lidar.id);
    for (const ImuInfo& imu : rig.imus) check_name(imu.id);
    for (const LidarInfo& lidar : rig.lidars) {
      prepare(layout::sweep_path(folder, lidar.id, format_, 0).parent_path());
      const fs::path labels = layout::labels_path(folder, lidar.id, 0).parent_path();
      if (fs::exists(labels)) prepare(labels);  // of an older dataset
      sweeps_[lidar.id].times = std::make_unique<PartFile>(folder / lidar.id / layout::kTimes);
    }
    for (const ImuInfo& imu : rig.imus) {
      prepare(folder / imu.id);
      imus_[imu.id].rows = std::make_unique<ImuTextWriter>(folder / imu.id / layout::kImu);
    }
  }

  void write(const std::string& id, const ImuSample& sample) override {
    ImuRows& imu = imus_.at(id);
    imu.rows->write(sample);
    ++imu.count;
  }

  void write(const std::string& id, const Scan& scan) override {
    Sweeps& sweeps = sweeps_.at(id);
    if (sweeps.count > 0 && scan.stamp <= sweeps.latest) {
      throw InputError(folder_.string(),
                       "a scan of '" + id + "' is not later than the previous one");
    }
    const fs::path file = layout::sweep_path(folder_, id, format_, sweeps.count);
    if (format_ == DatasetFormat::kPcd) write_sweep_pcd(file, scan);
    if (format_ == DatasetFormat::kPly) write_sweep_ply(file, scan);
    if (format_ == DatasetFormat::kKitti) write_sweep_bin(file, scan);
    sweeps.times->write(format_seconds(scan.stamp) + "\n");
    sweeps.latest = scan.stamp;
    ++sweeps.count;
  }

  /// Ground-truth files are numbered like the scans, so every scan must have one, in the same
  /// order.
  void write(const ScanTruth& truth) override {
    Sweeps& sweeps = sweeps_.at(truth.sensor_id);
    if (sweeps.hits == 0) {
      prepare(layout::hits_path(folder_, truth.sensor_id, 0).parent_path());
    }
    if (format_ == DatasetFormat::kKitti && !labels_.empty()) {
      const fs::path file = layout::labels_path(folder_, truth.sensor_id, sweeps.hits);
      if (sweeps.hits == 0) prepare(file.parent_path());
      write_labels(file, truth.points, labels_);
    }
    write_hits(layout::hits_path(folder_, truth.sensor_id, sweeps.hits++), truth.points);
  }

  void write_truth(const StampedPose&) override {}  // the caller writes truth.tum

  Json finish() override {
    Json scans = Json::object();
    Json hits = Json::object();
    Json samples = Json::object();
    for (auto& [id, sweeps] : sweeps_) {
      sweeps.times->commit();
      scans[id] = sweeps.count;
      if (sweeps.hits == 0) continue;
      if (sweeps.hits != sweeps.count) {
        throw InputError(folder_.string(),
                         "not every scan of '" + id + "' has ground truth of its points",
                         "write the ground truth of all scans or of none");
      }
      hits[id] = sweeps.hits;
    }
    for (auto& [id, imu] : imus_) {
      imu.rows->close();
      samples[id] = imu.count;
    }
    return {{"scan_counts", scans}, {"imu_counts", samples}, {"hit_counts", hits}};
  }

 private:
  struct Sweeps {
    std::unique_ptr<PartFile> times;
    std::size_t count = 0;
    std::size_t hits = 0;
    Time latest{0};
  };
  struct ImuRows {
    std::unique_ptr<ImuTextWriter> rows;
    std::size_t count = 0;
  };

  fs::path folder_;
  DatasetFormat format_;
  std::vector<std::uint32_t> labels_;
  std::map<std::string, Sweeps> sweeps_;
  std::map<std::string, ImuRows> imus_;
};

}  // namespace

std::unique_ptr<DatasetStore> make_sweep_store(const fs::path& folder, const Rig& rig,
                                               const WriteOptions& options) {
  return std::make_unique<SweepStore>(folder, rig, options);
}

}  // namespace lidarena::dataset
