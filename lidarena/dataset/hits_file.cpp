// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/hits_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "lidarena hits 1\n";

struct ScanHeader {
  std::int64_t stamp_ns = 0;
  std::uint64_t returns = 0;  ///< their number, with kHasClasses if their triangles follow
};

constexpr std::uint64_t kHasClasses = std::uint64_t{1} << 63U;

/// Position and normal.
using Row = std::array<float, 6>;

Row row_of(const PointTruth& hit) {
  return {hit.position.x(), hit.position.y(), hit.position.z(),
          hit.normal.x(),   hit.normal.y(),   hit.normal.z()};
}

bool has_classes(const ScanTruth& truth, std::size_t triangles) {
  return !std::ranges::all_of(truth.points, [triangles](const PointTruth& hit) {
    return is_of_world(hit.triangle, triangles);
  });
}

PointTruth hit_of(const Row& row) {
  PointTruth hit;
  hit.position = {row[0], row[1], row[2]};
  hit.normal = {row[3], row[4], row[5]};
  return hit;
}

fs::path hits_path(const fs::path& dataset, const std::string& sensor) {
  return dataset / (sensor + kHitsEnding);
}

class HitsReader final : public ScanTruthSource {
 public:
  HitsReader(const fs::path& file, std::string sensor)
      : file_(file),
        sensor_(std::move(sensor)),
        in_(file, std::ios::binary),
        left_(fs::file_size(file)) {
    std::array<char, kMagic.size()> magic{};
    read(magic);
    if (std::string_view(magic.data(), magic.size()) != kMagic)
      throw InputError(file_.string(), "is not a file of hits", "simulate the dataset again");
  }

  std::optional<ScanTruth> next() override {
    if (left_ == 0) return std::nullopt;
    std::array<ScanHeader, 1> header;
    read(header);
    const std::uint64_t returns = header[0].returns & ~kHasClasses;
    if (returns > left_ / sizeof(Row)) fail();
    rows_.resize(returns);
    read(rows_);
    ScanTruth truth{sensor_, Time{header[0].stamp_ns}, {}};
    truth.points.reserve(rows_.size());
    for (const Row& row : rows_) truth.points.push_back(hit_of(row));
    if (returns == header[0].returns) return truth;
    triangles_.resize(returns);
    read(triangles_);
    for (std::size_t i = 0; i < returns; ++i) truth.points[i].triangle = triangles_[i];
    return truth;
  }

 private:
  template <class Range>
  void read(Range& values) {
    const std::size_t bytes = values.size() * sizeof(values[0]);
    if (bytes > left_ ||
        !in_.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(bytes)))
      fail();
    left_ -= bytes;
  }
  [[noreturn]] void fail() const {
    throw InputError(file_.string(), "is cut off", "simulate the dataset again");
  }

  fs::path file_;
  std::string sensor_;
  std::ifstream in_;
  std::uintmax_t left_;
  std::vector<Row> rows_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace

HitsWriter::HitsWriter(const fs::path& folder, const Rig& rig, std::size_t triangles)
    : triangles_(triangles) {
  for (const LidarInfo& lidar : rig.lidars) {
    auto file = std::make_unique<PartFile>(hits_path(folder, lidar.id));
    file->write(kMagic);
    files_[lidar.id] = std::move(file);
  }
}

HitsWriter::~HitsWriter() = default;

void HitsWriter::write(const ScanTruth& truth) {
  PartFile& file = *files_.at(truth.sensor_id);
  std::vector<Row> rows;
  rows.reserve(truth.points.size());
  for (const PointTruth& hit : truth.points) rows.push_back(row_of(hit));
  const bool classes = has_classes(truth, triangles_);
  const ScanHeader header{truth.stamp.count(), rows.size() | (classes ? kHasClasses : 0)};
  file.write(std::as_bytes(std::span(&header, 1)));
  file.write(std::as_bytes(std::span(rows)));
  if (!classes) return;
  std::vector<std::uint32_t> triangles;
  for (const PointTruth& hit : truth.points) triangles.push_back(hit.triangle);
  file.write(std::as_bytes(std::span(triangles)));
}

void HitsWriter::commit() {
  for (auto& [sensor, file] : files_) file->commit();
}

void remove_hits(const fs::path& dataset) {
  for (const fs::directory_entry& entry : fs::directory_iterator(dataset)) {
    if (entry.path().filename().string().ends_with(kHitsEnding)) fs::remove(entry.path());
  }
}

std::unique_ptr<ScanTruthSource> open_hits(const fs::path& dataset, const std::string& sensor) {
  const fs::path file = hits_path(dataset, sensor);
  if (!fs::exists(file)) return nullptr;
  return std::make_unique<HitsReader>(file, sensor);
}

}  // namespace lidarena::dataset
