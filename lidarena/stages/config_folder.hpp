// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lidarena::sensor {
struct SensorConfig;
}

namespace lidarena::stages {

/// The folder `configs/` with one subfolder per kind: worlds, flights, sensors, odometry, studies.
/// A NAME is the stem of a file in one of them.
class ConfigFolder {
 public:
  explicit ConfigFolder(std::filesystem::path root) : root_(std::move(root)) {}

  /// The nearest `configs` folder at or above `start`, or `share/lidarena/configs` beside a `bin`.
  /// Throws InputError when there is none.
  static ConfigFolder find(const std::filesystem::path& start);

  const std::filesystem::path& root() const { return root_; }
  /// Stems of the files of a kind, sorted.
  std::vector<std::string> names(const std::string& kind) const;
  /// `name_or_path` itself if such a file exists, else the kind's file of that stem; of a word
  /// without a folder and an extension the kind's file comes first. Otherwise throws an InputError
  /// that suggests the most similar name.
  std::filesystem::path resolve(const std::string& kind, const std::string& name_or_path) const;
  /// The sensor of this name or file, see sensor::load_sensor().
  sensor::SensorConfig load_sensor(const std::string& name_or_path) const;
  /// Its file and those on which it is based.
  std::vector<std::filesystem::path> sensor_files(const std::string& name_or_path) const;

 private:
  std::filesystem::path root_;
};

}  // namespace lidarena::stages
