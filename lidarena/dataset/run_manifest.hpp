// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::dataset {

enum class RunStatus { kOk, kDiverged, kFailed };
constexpr auto enum_names(RunStatus) {
  return std::array{std::pair{"ok", RunStatus::kOk}, std::pair{"diverged", RunStatus::kDiverged},
                    std::pair{"failed", RunStatus::kFailed}};
}

/// What the points of map.ply are: returns, or means of returns, whose noise is not visible.
enum class OwnMap { kNone, kReturns, kMeans };
constexpr auto enum_names(OwnMap) {
  return std::array{std::pair{"none", OwnMap::kNone}, std::pair{"returns", OwnMap::kReturns},
                    std::pair{"means", OwnMap::kMeans}};
}

/// Where the times of a run were measured.
struct MachineFacts {
  std::string processor;
  int cores = 0;
  double memory_gib = 0.0;
  std::string lidarena;
  bool empty() const { return lidarena.empty(); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("processor", self.processor, "", "name of the processor");
    v("cores", self.cores, "", "");
    v("memory_gib", self.memory_gib, "GiB", "");
    v("lidarena", self.lidarena, "", "version of the program");
  }
};

/// What became of the scans.
struct RunCounts {
  std::uint64_t scans = 0, refused = 0, dropped = 0;
  double longest_delay_s = 0.0;
  std::map<std::string, std::uint64_t> statuses;
  double sensor_seconds = 0.0, compute_seconds = 0.0;
  bool diverged = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("scans", self.scans, "", "registered");
    v("refused", self.refused, "", "out of time order");
    v("dropped", self.dropped, "", "because the method was late; paced runs only");
    v("longest_delay_s", self.longest_delay_s, "s", "from a scan's last point to its pose; paced");
    v("statuses", self.statuses, "", "scans by their status");
    v("sensor_seconds", self.sensor_seconds, "s", "length of the recording");
    v("compute_seconds", self.compute_seconds, "s", "wall time inside the method");
    v("diverged", self.diverged, "", "");
  }
};

/// What a program outside took as a whole.
struct ProcessUse {
  double processor_seconds = 0.0, peak_mb = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("processor_seconds", self.processor_seconds, "s", "CPU time");
    v("peak_mb", self.peak_mb, "MB", "highest resident memory");
  }
};

/// manifest.json of a RUN folder: what was run, on what, and how it ended.
struct RunManifest {
  std::string kind = "run";
  std::string algorithm, preset;
  Json config;
  std::string config_file;
  std::vector<std::string> overrides;
  std::string dataset, sensor;
  std::optional<Pose> body_from_lidar;
  int threads = 0;
  std::vector<std::string> also;
  int parts = 1;
  bool paced = false, live = false;
  OwnMap own_map = OwnMap::kReturns;
  RunStatus status = RunStatus::kOk;
  std::string reason, recording_ended;
  MachineFacts made_on;
  RunCounts summary;
  std::optional<ProcessUse> process;
  Json messages;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("kind", self.kind, "", "run");
    v("algorithm", self.algorithm, "", "name of the method or program");
    v("preset", self.preset, "", "its preset; external or live for a program outside");
    v("config", self.config, "", "its complete settings");
    v("config_file", self.config_file, "", "file that overrode values of the preset");
    v("overrides", self.overrides, "", "key=value, as given to --set");
    v("dataset", self.dataset, "", "path from this folder; empty: live topics");
    v("sensor", self.sensor, "", "id of the LiDAR");
    v("body_from_lidar", self.body_from_lidar, "", "mounting: x y z (m) qx qy qz qw");
    v("threads", self.threads, "", "");
    v("also", self.also, "", "ids of further LiDARs whose points are in its scans");
    v("parts", self.parts, "", "scans in which each sweep was handed over");
    v("paced", self.paced, "", "scans were dropped when the method was late");
    v("live", self.live, "", "the run was made of live topics");
    v("own_map", self.own_map, "", "what the points of map.ply are");
    v("status", self.status, "", "");
    v("reason", self.reason, "", "why the status is not ok");
    v("recording_ended", self.recording_ended, "",
      "where the recording was cut off or damaged; empty if it was not");
    v("made_on", self.made_on, "", "where the times were measured");
    v("summary", self.summary, "", "what became of the scans");
    v("process", self.process, "", "what a program outside took");
    v("messages", self.messages, "", "of live topics: counts of lost and bad ones");
  }
};

/// Whether the folder has the manifest of a run.
bool is_run(const std::filesystem::path& folder);
/// Throws InputError when the manifest is missing or damaged.
RunManifest read_run_manifest(const std::filesystem::path& folder);
void write_run_manifest(const std::filesystem::path& folder, const RunManifest& manifest);

}  // namespace lidarena::dataset
