// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/dataset_manifest.hpp"

#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/json_file.hpp"

namespace lidarena::dataset {

std::optional<DatasetManifest> read_dataset_manifest(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / layout::kManifest;
  if (!std::filesystem::exists(file)) return std::nullopt;
  DatasetManifest manifest;
  lidarena::read_json(read_json(file), manifest, file.string());
  return manifest;
}

}  // namespace lidarena::dataset
