// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/run_manifest.hpp"

namespace lidarena::results {

/// The row of a run in results.csv, kept in place of its metrics.json: a run of an earlier study
/// whose files are gone.
struct KnownRow {
  std::string name, key, algorithm, preset, sensor, status, reason;
  dataset::OwnMap own_map = dataset::OwnMap::kReturns;
  std::optional<double> coverage_percent, ended_at_s;
  std::map<std::string, double> figures;      ///< by column, see column_of()
  std::map<std::string, double> zero_bounds;  ///< %, by the figure's key

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("key", self.key, "", "");
    v("algorithm", self.algorithm, "", "");
    v("preset", self.preset, "", "");
    v("sensor", self.sensor, "", "");
    v("status", self.status, "", "");
    v("reason", self.reason, "", "");
    v("own_map", self.own_map, "", "");
    v("coverage_percent", self.coverage_percent, "%", "");
    v("ended_at_s", self.ended_at_s, "s", "");
    v("figures", self.figures, "", "");
    v("zero_bounds", self.zero_bounds, "", "");
  }
};

inline constexpr const char* kKnownRow = "known.json";  ///< in the folder of such a run

/// The rows of a results.csv that have a key. Throws InputError naming file and line for a file
/// that is not one, or was written by a version without keys.
std::vector<KnownRow> read_known_rows(const std::filesystem::path& csv);

/// Bounds as a cell of results.csv, and back.
std::string bounds_text(const std::map<std::string, double>& bounds);

}  // namespace lidarena::results
