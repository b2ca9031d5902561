// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena::dataset {

/// A file being written. Bytes go to NAME.part; commit() makes sure that they are on the disk and
/// only then renames it to NAME. Without commit() NAME.part remains, so that an unfinished file is
/// never taken for a complete one.
class PartFile {
 public:
  /// Creates or empties NAME.part. Throws InputError when the folder is missing or read-only.
  explicit PartFile(std::filesystem::path file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Appends; throws Error naming the file when the disk is full.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Replaces bytes already written; throws Error when that fails.
  void overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Passes buffered bytes to the operating system, so that a crash of this process does not lose
  /// them.
  void flush();
  /// Bytes written so far.
  std::uint64_t size() const { return size_; }
  /// Flushes to the disk and renames; throws Error when either fails. Nothing may be written
  /// afterwards.
  void commit();

 private:
  void write_through(std::span<const std::byte> bytes);
  [[noreturn]] void fail(std::string_view what, int error_number);

  std::filesystem::path file_;
  std::filesystem::path part_;
  int descriptor_ = -1;
  std::vector<std::byte> buffer_;
  std::uint64_t size_ = 0;
};

/// Writes `file` with the content `text`, through a PartFile.
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace lidarena::dataset
