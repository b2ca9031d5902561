// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "lidarena/dataset/byte_stream.hpp"

namespace lidarena {

/// CRC-32 of IEEE 802.3, as zlib has it; `crc` continues an earlier one.
std::uint32_t crc32_of(Bytes bytes, std::uint32_t crc = 0);
/// That of two pieces one after the other, from theirs and the size of the second.
std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_size);

/// One zstd frame; the same input gives the same output (of one version of the library).
class ZstdCompressor {
 public:
  explicit ZstdCompressor(int level);
  ~ZstdCompressor();
  /// Valid until the next call.
  Bytes compress(Bytes input);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One LZ4 frame of independent blocks with a check sum of its content, in the form that ROS 1 bags
/// have it, too. `output` holds the result.
Bytes compress_lz4(Bytes input, std::vector<std::byte>& output);

/// Undoes `method`, "zstd", "lz4" (frame format) or, where the library was there at build time,
/// "bz2", into `output`, which never grows beyond `size`,
/// nor much beyond what the input really holds. Throws std::runtime_error when the input is
/// damaged, does not give exactly `size` bytes, or the method is unknown or was left out.
void decompress(std::string_view method, Bytes input, std::uint64_t size,
                std::vector<std::byte>& output);

}  // namespace lidarena
