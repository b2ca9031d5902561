// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace lidarena::study {

/// The measurements of a study's datasets, kept on disk while runs need them, within a budget.
class Scratch {
 public:
  /// `datasets`: the folder whose subfolders are the datasets. Deletes what an earlier call that
  /// was killed left there, except the data of the datasets in `needed`.
  Scratch(std::filesystem::path datasets, std::uint64_t budget_bytes,
          std::map<std::string, std::uint64_t> needed);

  /// Whether the data of the dataset ever fit into the budget; otherwise each run flies anew.
  bool is_kept(const std::string& dataset) const;
  /// Whether they fit beside the data that are kept at present.
  bool fits_now(const std::string& dataset) const;
  bool has_data(const std::string& dataset) const;

  void reserve(const std::string& dataset);  ///< they are about to be written
  void settle(const std::string& dataset);   ///< they were written: counts their true size
  /// Deletes them; the dataset is a manifest from then on, simulated whenever it is read.
  void drop(const std::string& dataset);
  /// Drops them, and keeps none of this dataset any more: the disk was full.
  void give_up(const std::string& dataset);

 private:
  std::filesystem::path datasets_;
  std::uint64_t budget_;
  std::map<std::string, std::uint64_t> expected_;  ///< bytes of each dataset that runs need
  std::map<std::string, std::uint64_t> held_;      ///< bytes of those on disk
};

/// Half of the disk space that is free below `folder`, bytes.
std::uint64_t default_scratch_bytes(const std::filesystem::path& folder);

}  // namespace lidarena::study
