// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/run_files.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <iterator>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kResourceHeader =
    "t_sensor_s,latency_s,cpu_s,rss_bytes,pss_bytes,map_bytes,scan_buffer_bytes,backlog_bytes";
constexpr std::string_view kFinalHeader =
    "final estimate: pose of the body in the world (world_from_body) at the stamped instant\n"
    "time[s] x y z[m] qx qy qz qw";
constexpr std::string_view kLiveHeader =
    "estimate as known at each scan: pose of the body in the world (world_from_body) at the "
    "stamped instant\n"
    "time[s] x y z[m] qx qy qz qw";

constexpr std::string_view kMotionHeader =
    "final estimate with the motion within the scans: pose of the body in the world "
    "(world_from_body) at the stamped instant\n"
    "time[s] x y z[m] qx qy qz qw";

std::string resource_rows(const std::vector<ResourceRow>& rows) {
  std::string text = std::string(kResourceHeader) + "\n";
  for (const ResourceRow& row : rows) {
    fmt::format_to(std::back_inserter(text), "{:.9f},{:.9f},{:.9f},{},{},{},{},{}\n",
                   row.t_sensor_s, row.latency_s, row.cpu_s, row.rss_bytes, row.pss_bytes,
                   row.map_bytes, row.scan_buffer_bytes, row.backlog_bytes);
  }
  return text;
}

std::uint64_t bytes_at(std::string_view word, const std::string& place) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw InputError(place, fmt::format("'{}' is not a number of bytes", word));
  }
  return value;
}

}  // namespace

std::vector<ResourceRow> read_resources(const fs::path& file) {
  TextRows rows(file);
  const auto header = rows.next();
  if (!header || *header != kResourceHeader) {
    throw InputError(file.string() + ":1", "is not the header of resources.csv",
                     fmt::format("it must be {}", kResourceHeader));
  }
  std::vector<ResourceRow> resources;
  while (const auto row = rows.next()) {
    const auto parts = split_commas(*row);
    const std::string place = rows.place();
    if (parts.size() != 8) {
      throw InputError(place, fmt::format("holds {} columns, not 8", parts.size()));
    }
    resources.push_back({finite_number(parts[0], place), finite_number(parts[1], place),
                         finite_number(parts[2], place), bytes_at(parts[3], place),
                         bytes_at(parts[4], place), bytes_at(parts[5], place),
                         bytes_at(parts[6], place), bytes_at(parts[7], place)});
  }
  return resources;
}

void begin_run(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": cannot be created: " + error.message());
  // files of an earlier run must not be taken for files of this one while it is being written
  for (const char* stale : {"manifest.json", "metrics.json", "resources.json", "motion.tum",
                            "events.csv", "map.ply", "reprojected.ply"})
    fs::remove(folder / stale, error);
}

void write_run(const fs::path& folder, const RunFiles& run) {
  if (!run.maps_on_disk) begin_run(folder);
  write_tum(folder / "trajectory.tum", run.trajectory, std::string(kFinalHeader));
  write_tum(folder / "live.tum", run.live, std::string(kLiveHeader));
  if (!run.motion.empty()) write_tum(folder / "motion.tum", run.motion, std::string(kMotionHeader));
  if (!run.maps_on_disk) {
    write_ply(folder / "map.ply", run.map);
    write_ply(folder / "reprojected.ply", run.reprojected);
  }
  write_text_file(folder / "resources.csv", resource_rows(run.resources));
  if (run.events) write_events(folder / "events.csv", *run.events);
  write_run_manifest(folder, run.manifest);
}

RunFiles read_run(const fs::path& folder, ReadMaps maps) {
  RunFiles run;
  run.manifest = read_run_manifest(folder);
  if (maps == ReadMaps::kYes && !fs::exists(folder / "map.ply")) {
    throw InputError(folder.string(),
                     "has no map.ply: a study with 'keep_maps: false' removes it, and 'run --maps "
                     "off' writes none",
                     "the scores are in metrics.json; run it again to get the maps");
  }
  run.trajectory = read_tum(folder / "trajectory.tum", EmptyTrajectory::kAllowed);
  run.live = read_tum(folder / "live.tum", EmptyTrajectory::kAllowed);
  if (fs::exists(folder / "motion.tum")) run.motion = read_tum(folder / "motion.tum");
  if (maps == ReadMaps::kYes) {
    run.map = read_cloud(folder / "map.ply");
    run.reprojected = read_cloud(folder / "reprojected.ply");
  }
  run.resources = read_resources(folder / "resources.csv");
  if (fs::exists(folder / "events.csv")) run.events = read_events(folder / "events.csv");
  return run;
}

}  // namespace lidarena::dataset
