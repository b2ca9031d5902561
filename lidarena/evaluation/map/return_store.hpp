// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "lidarena/base/event.hpp"

namespace lidarena::evaluation {

/// The scored returns of one LiDAR (see scored_returns.hpp), kept on the disk while a dataset is
/// read for another purpose, so that it need not be read, or simulated, a second time. The file
/// has no name: it ends with this object or with the process.
class ReturnStore {
 public:
  /// Keeps at most `max_returns` of each scan of `lidar_id`, in a file on the disk of `folder`.
  /// Throws Error if it cannot be created.
  ReturnStore(const std::filesystem::path& folder, std::string lidar_id, std::size_t max_returns);

  /// `events` unchanged, each scan of the LiDAR being kept on its way. The store must outlive the
  /// returned source, which throws Error when the disk is full.
  std::unique_ptr<EventSource> keep_from(std::unique_ptr<EventSource> events);
  /// The kept scans, from the first on. One source at a time; the store must outlive it.
  std::unique_ptr<EventSource> read() const;

 private:
  class Keeper;
  class Reader;
  void keep(const Scan& scan);

  std::filesystem::path folder_;
  std::string lidar_id_;
  std::size_t max_returns_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

}  // namespace lidarena::evaluation
