// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/run_manifest.hpp"

#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/json_file.hpp"

namespace lidarena::dataset {

namespace fs = std::filesystem;

bool is_run(const fs::path& folder) {
  const fs::path file = folder / layout::kManifest;
  if (!fs::exists(file)) return false;
  const Json manifest = read_json(file);
  return manifest.is_object() && manifest.value("kind", Json()) == RunManifest().kind;
}

RunManifest read_run_manifest(const fs::path& folder) {
  const fs::path file = folder / layout::kManifest;
  if (!fs::exists(file)) {
    throw InputError(folder.string(), "is not a finished run: it has no manifest.json",
                     "run the algorithm again");
  }
  RunManifest manifest;
  lidarena::read_json(read_json(file), manifest, file.string());
  return manifest;
}

void write_run_manifest(const fs::path& folder, const RunManifest& manifest) {
  write_json(folder / layout::kManifest, to_json(manifest));
}

}  // namespace lidarena::dataset
