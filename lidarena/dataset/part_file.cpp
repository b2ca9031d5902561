// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/part_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::dataset {
namespace {
constexpr std::size_t kBufferBytes = 256 * 1024;  // a few system calls per megabyte

std::string reason(int error_number) { return std::generic_category().message(error_number); }
}  // namespace

PartFile::PartFile(std::filesystem::path file) : file_(std::move(file)), part_(file_) {
  part_ += ".part";
  descriptor_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    throw InputError(part_.string(), "cannot be created: " + reason(errno),
                     "choose an existing folder with write permission");
  }
  buffer_.reserve(kBufferBytes);
}

PartFile::~PartFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void PartFile::fail(std::string_view what, int error_number) {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));  // no later commit can succeed
  throw Error(fmt::format("{}: {} after {} bytes: {}; {} is incomplete, free space and try again",
                          file_.string(), what, size_, reason(error_number), part_.string()));
}

void PartFile::write_through(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void PartFile::flush() {
  write_through(buffer_);
  buffer_.clear();
}

void PartFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  flush();
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void PartFile::write(std::span<const std::byte> bytes) {
  if (buffer_.size() + bytes.size() > kBufferBytes) flush();
  if (bytes.size() >= kBufferBytes) {
    write_through(bytes);
  } else {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
  size_ += bytes.size();
}

void PartFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void PartFile::commit() {
  flush();
  if (::fsync(descriptor_) != 0) fail("cannot be flushed to the disk", errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("cannot be closed", errno);
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) fail("cannot be renamed from " + part_.string(), error.value());
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
  PartFile out(file);
  out.write(text);
  out.commit();
}

}  // namespace lidarena::dataset
