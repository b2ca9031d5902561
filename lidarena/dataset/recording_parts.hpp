// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "lidarena/dataset/recording.hpp"

/// Recordings of several files: split bags, and folders with the bags of one take.
namespace lidarena::dataset {

/// Whether the name is that of a recording: it ends in .mcap, .bag or .db3, then possibly in
/// .active, .part (still being written when the recorder died) or .zstd, .zst (compressed as a
/// whole).
bool is_recording_name(const std::filesystem::path& file);

/// The recordings in `folder` in natural order of their names; empty if there are none.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder);

/// One reader after the other, in the order of the files' first messages.
std::unique_ptr<RecordingReader> open_parts(const std::vector<std::filesystem::path>& files);
/// The sum of the files' contents.
RecordingInfo read_parts_info(const std::vector<std::filesystem::path>& files);

/// Files that were compressed as a whole, unpacked to a temporary folder that exists as long as
/// this object.
class UnpackedRecording {
 public:
  /// Unpacks `recording` (a file or a folder) if it is, or holds, a compressed file; else there is
  /// nothing to do. Throws InputError when a file is damaged, Error when the disk is full.
  explicit UnpackedRecording(const std::filesystem::path& recording);
  ~UnpackedRecording();
  UnpackedRecording(const UnpackedRecording&) = delete;
  UnpackedRecording& operator=(const UnpackedRecording&) = delete;

  /// What to read.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::filesystem::path folder_;  ///< empty: nothing was unpacked
};

}  // namespace lidarena::dataset
