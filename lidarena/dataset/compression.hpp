// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "lidarena/dataset/byte_stream.hpp"

namespace lidarena::dataset {

/// CRC-32 of IEEE 802.3; `crc` is that of the preceding bytes.
std::uint32_t crc32_of(Bytes bytes, std::uint32_t crc = 0);

/// Compresses to one zstd frame; the same input gives the same output (with the same version of the
/// library).
class ZstdCompressor {
 public:
  explicit ZstdCompressor(int level);
  ~ZstdCompressor();
  /// The result is valid until the next call.
  Bytes compress(Bytes input);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Compresses to one LZ4 frame of independent blocks with a content checksum, as in ROS 1 bags. The
/// result is a view into `output`.
Bytes compress_lz4(Bytes input, std::vector<std::byte>& output);

/// Decompresses `input` into `output`. `method` is "zstd", "lz4" (frame format) or, if built with
/// libbz2, "bz2". `output` never grows beyond `size`, nor much beyond the true size of the
/// decompressed data. Throws std::runtime_error when the input is damaged or does not give exactly
/// `size` bytes, or when the method is unknown or not built in.
void decompress(std::string_view method, Bytes input, std::uint64_t size,
                std::vector<std::byte>& output);

/// Whether the bytes begin as a zstd frame.
bool is_zstd(Bytes bytes);

/// Decompresses a zstd frame that states its size. Throws std::runtime_error as decompress().
void decompress_zstd_frame(Bytes input, std::vector<std::byte>& output);

/// Decompresses the zstd file `in` to the file `out`. Throws std::runtime_error when `in` is
/// damaged, Error when `out` cannot be written.
void decompress_zstd_file(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace lidarena::dataset
