// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

void prepare(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
  // Files of an earlier dataset must not be taken for files of this one.
  for (const char* stale : {layout::kManifest, layout::kTruth, layout::kTruthPart, layout::kData,
                            layout::kBag, layout::kRosbagMetadata}) {
    fs::remove(folder / stale, error);
  }
  // Marks the folder as unfinished until the manifest is complete.
  std::ofstream(folder / layout::kManifestPart);
}

/// `options` with the format given by the file name (.mcap or .bag), if any.
WriteOptions with_format_of_name(const fs::path& path, WriteOptions options) {
  if (const auto format = recording_format_of(path)) {
    options.format = *format == RecordingFormat::kBag ? DatasetFormat::kBag : DatasetFormat::kMcap;
  }
  return options;
}

bool has_lidar(const Rig& rig, const std::string& id) {
  return std::ranges::any_of(rig.lidars, [&](const auto& lidar) { return lidar.id == id; });
}

bool has_imu(const Rig& rig, const std::string& id) {
  return std::ranges::any_of(rig.imus, [&](const auto& imu) { return imu.id == id; });
}

}  // namespace

struct DatasetWriter::Impl {
  Impl(const fs::path& path, const Rig& r, const WriteOptions& o)
      : place(path),
        rig(r),
        options(with_format_of_name(path, o)),
        is_folder(!recording_format_of(path)) {
    layout::topics_of(rig);  // throws if two sensors have the same id
    if (!is_folder) {
      store = make_recording_store(path, rig, options, false);
      return;
    }
    prepare(path);
    if (options.format != DatasetFormat::kMcap && options.format != DatasetFormat::kBag) {
      options.dialect = Dialect::kSi;
      store = make_sweep_store(path, rig, options);
      return;
    }
    const bool is_bag = options.format == DatasetFormat::kBag;
    store =
        make_recording_store(path / (is_bag ? layout::kBag : layout::kData), rig, options, true);
  }

  void check(bool is_known, const std::string& id) const {
    if (is_known) return;
    throw InputError(place.string(), "'" + id + "' is not a sensor of the rig",
                     "add it to the rig");
  }

  void write(const std::string& id, const ImuSample& sample) const {
    check(has_imu(rig, id), id);
    store->write(id, sample);
  }
  void write(const std::string& id, const Scan& scan) const {
    check(has_lidar(rig, id), id);
    store->write(id, scan);
  }

  Json manifest_with(Json manifest, const Json& extra) const {
    manifest["format"] = layout::kFormat;
    manifest["format_version"] = layout::kFormatVersion;
    manifest["rig"] = to_json(rig);
    manifest["storage"] = value_to_json(options.format);
    manifest["dialect"] = value_to_json(options.dialect);
    for (const auto& [key, value] : extra.items()) {
      if (!manifest.contains(key)) manifest[key] = value;
    }
    return manifest;
  }

  fs::path place;
  Rig rig;
  WriteOptions options;
  bool is_folder;  ///< else a single file
  std::unique_ptr<DatasetStore> store;
  std::optional<TumWriter> truth;
  bool finished = false;
};

DatasetWriter::DatasetWriter(const fs::path& path, const Rig& rig, const WriteOptions& options)
    : impl_(std::make_unique<Impl>(path, rig, options)) {}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::write(const Event& event) {
  std::visit([&](const auto& data) { impl_->write(event.sensor_id, data); }, event.data);
}

void DatasetWriter::write(const ScanTruth& truth) {
  impl_->check(has_lidar(impl_->rig, truth.sensor_id), truth.sensor_id);
  impl_->store->write(truth);
}

void DatasetWriter::write_truth(const StampedPose& pose) {
  Impl& w = *impl_;
  if (w.is_folder) {
    if (!w.truth) w.truth.emplace(w.place / layout::kTruth, kTruthHeader);
    w.truth->write(pose);
  }
  w.store->write_truth(pose);
}

void DatasetWriter::finish(const Json& manifest) {
  Impl& w = *impl_;
  if (w.finished) return;
  const Json stored = w.store->finish();
  if (w.truth) w.truth->close();
  if (w.is_folder) write_json(w.place / layout::kManifest, w.manifest_with(stored, manifest));
  w.finished = true;
}

void DatasetWriter::close() { finish(Json::object()); }

}  // namespace lidarena::dataset
