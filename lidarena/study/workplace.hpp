// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace lidarena::study {

/// The folder in which one leased unit is worked on. It is laid out as the study's own folder
/// (datasets/, runs/), to which finished folders are published: each appears there whole or not at
/// all, because it is renamed into its place. All is deleted at the end. Functions throw Error or
/// filesystem_error if a disk is full or the folder was deleted by another process.
class Workplace {
 public:
  /// `scratch`: folder on any disk; empty = in the study's folder. `token`: of the lease.
  Workplace(std::filesystem::path study, const std::filesystem::path& scratch,
            const std::string& token);
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  const std::filesystem::path& root() const { return root_; }
  /// Copies the run's folder from the study, to go on with it.
  void fetch_run(const std::string& name) const;
  void publish_run(const std::string& name) const;
  /// Publishes the dataset without its measurements. Its world becomes a link to worlds/, where
  /// each world is stored once, under the digest of its bytes.
  void publish_dataset(const std::string& name) const;
  /// Deletes the measurements; the dataset is a manifest from then on.
  void drop_data(const std::string& dataset) const;
  /// Size of the measurements on disk.
  std::uint64_t data_bytes(const std::string& dataset) const;
  /// Tells the status of the study what is going on, if it can be written.
  void tell(const std::string& what) const;

 private:
  void replace(const std::filesystem::path& ready, const std::filesystem::path& place) const;
  void store_world(const std::filesystem::path& file) const;

  std::filesystem::path study_;
  std::filesystem::path staging_;  ///< in the study's folder
  std::filesystem::path root_;
};

/// What the owner of a lease told last; empty if nothing.
std::string told_by(const std::filesystem::path& study, const std::string& token);

/// Deletes what a process that has died left in the study's folder and, if that is on this machine,
/// in its scratch folder.
void clear_workplace(const std::filesystem::path& study, const std::filesystem::path& scratch,
                     const std::string& token);

/// Whether not even a megabyte can be written below the folder.
bool disk_is_full(const std::filesystem::path& folder);

}  // namespace lidarena::study
