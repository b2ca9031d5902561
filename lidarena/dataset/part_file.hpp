// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena {

/// A file in the making. Bytes go to NAME.part; commit() makes sure they are on the disk and only
/// then gives the file its name. Destroyed without commit, NAME.part stays, so what is unfinished
/// never looks whole.
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
  /// Replaces bytes that were written before; throws Error when that fails.
  void overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Hands what is buffered to the system, so that a crash of this process does not lose it.
  void flush();
  /// Bytes written so far.
  std::uint64_t size() const { return size_; }
  /// Flushes to the disk and renames; throws Error when either fails. Nothing may be written after.
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

/// Writes `text` as the whole of `file`, by way of a PartFile.
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace lidarena
