// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/compression.hpp"

#ifdef LIDARENA_HAVE_BZIP2
#include <bzlib.h>
#endif
#include <libdeflate.h>
#include <lz4frame.h>
#define XXH_INLINE_ALL  // no library to link with
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::dataset {
namespace {

struct DeleteZstd {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};
struct DeleteLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

/// Calls `step(output, input)`, which consumes part of both and returns true at the end of a frame,
/// until the input is consumed. The output grows by doubling, so that a damaged `size` cannot cause
/// a huge allocation.
template <class Step>
void decompress_stream(Bytes input, std::uint64_t size, std::vector<std::byte>& output,
                       const Step& step) {
  constexpr std::uint64_t kFirstGuess = 1 << 20;  // bytes
  std::size_t used = 0;
  bool frame_ended = false;
  output.resize(std::min(size, std::max<std::uint64_t>(kFirstGuess, 4 * input.size())));
  while (!input.empty()) {
    if (used == output.size() && used < size)
      output.resize(std::min<std::uint64_t>(size, 2 * used));
    std::span<std::byte> free_output = std::span(output).subspan(used);
    const std::size_t input_before = input.size();
    const std::size_t free_before = free_output.size();
    frame_ended = step(free_output, input);
    used += free_before - free_output.size();
    const bool stuck = input.size() == input_before && free_output.size() == free_before;
    if (stuck && used == size) throw std::runtime_error("holds more bytes than stated");
    if (stuck) throw std::runtime_error("cannot be decompressed");
  }
  while (!frame_ended && used < size) {  // all input consumed, output still in the decompressor
    if (used == output.size()) output.resize(std::min<std::uint64_t>(size, 2 * used));
    std::span<std::byte> free_output = std::span(output).subspan(used);
    const std::size_t free_before = free_output.size();
    frame_ended = step(free_output, input);
    if (free_output.size() == free_before) break;
    used += free_before - free_output.size();
  }
  if (!frame_ended || used != size) throw std::runtime_error("holds fewer bytes than stated");
}

void decompress_zstd(Bytes input, std::uint64_t size, std::vector<std::byte>& output) {
  const std::unique_ptr<ZSTD_DCtx, DeleteZstd> context(ZSTD_createDCtx());
  decompress_stream(input, size, output, [&](std::span<std::byte>& free_output, Bytes& rest) {
    ZSTD_inBuffer in{rest.data(), rest.size(), 0};
    ZSTD_outBuffer out{free_output.data(), free_output.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(result)) throw std::runtime_error(ZSTD_getErrorName(result));
    rest = rest.subspan(in.pos);
    free_output = free_output.subspan(out.pos);
    return result == 0;
  });
}

/// liblz4 before 1.9.4 always verifies them.
template <class Options>
void skip_checksums(Options& options) {
  if constexpr (requires { options.skipChecksums; }) options.skipChecksums = 1;
}

/// Decompresses LZ4 frames. The checksum of a frame's content is verified here, because Debian's
/// liblz4 computes it slower than it decompresses; those of blocks are verified by liblz4.
class Lz4Frames {
 public:
  Lz4Frames() {
    LZ4F_dctx* created = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)))
      throw std::bad_alloc();
    context_.reset(created);
  }

  /// A step of decompress_stream().
  bool operator()(std::span<std::byte>& free_output, Bytes& rest) {
    if (frame_size_ == 0) read_header(rest);
    LZ4F_decompressOptions_t options{};
    if (has_checksum_) skip_checksums(options);
    std::size_t consumed = rest.size();
    std::size_t produced = free_output.size();
    const std::size_t result = checked(LZ4F_decompress(
        context_.get(), free_output.data(), &produced, rest.data(), &consumed, &options));
    rest = rest.subspan(consumed);
    free_output = free_output.subspan(produced);
    frame_size_ += produced;
    if (result == 0)
      verify({free_output.data() - frame_size_, std::exchange(frame_size_, 0)}, rest);
    return result == 0;
  }

 private:
  static std::size_t checked(std::size_t result) {
    if (LZ4F_isError(result)) throw std::runtime_error(LZ4F_getErrorName(result));
    return result;
  }
  void read_header(Bytes& rest) {
    LZ4F_frameInfo_t info{};
    std::size_t consumed = rest.size();
    checked(LZ4F_getFrameInfo(context_.get(), &info, rest.data(), &consumed));
    rest = rest.subspan(consumed);
    has_checksum_ = info.contentChecksumFlag == LZ4F_contentChecksumEnabled &&
                    info.blockChecksumFlag == LZ4F_noBlockChecksum;
  }
  /// `rest`: what follows the frame, whose last bytes are the checksum.
  void verify(Bytes content, Bytes rest) const {
    if (!has_checksum_) return;
    std::uint32_t stored = 0;
    std::memcpy(&stored, rest.data() - sizeof stored, sizeof stored);
    if (XXH32(content.data(), content.size(), 0) != stored)
      throw std::runtime_error("has a wrong checksum");
  }

  std::unique_ptr<LZ4F_dctx, DeleteLz4> context_;
  std::size_t frame_size_ = 0;  ///< bytes of the current frame that were decompressed
  bool has_checksum_ = false;   ///< of the current frame, to be verified here
};

void decompress_lz4(Bytes input, std::uint64_t size, std::vector<std::byte>& output) {
  Lz4Frames frames;
  decompress_stream(input, size, output, std::ref(frames));
}

#ifdef LIDARENA_HAVE_BZIP2
struct EndBzip2 {
  void operator()(bz_stream* stream) const { BZ2_bzDecompressEnd(stream); }
};

void decompress_bz2(Bytes input, std::uint64_t size, std::vector<std::byte>& output) {
  bz_stream state{};
  if (BZ2_bzDecompressInit(&state, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, EndBzip2> stream(&state);
  decompress_stream(input, size, output, [&](std::span<std::byte>& free_output, Bytes& rest) {
    // the library takes its input as char*, but does not modify it
    stream->next_in = reinterpret_cast<char*>(const_cast<std::byte*>(rest.data()));
    stream->avail_in = static_cast<unsigned>(rest.size());
    stream->next_out = reinterpret_cast<char*>(free_output.data());
    stream->avail_out = static_cast<unsigned>(free_output.size());
    const int result = BZ2_bzDecompress(stream.get());
    if (result != BZ_OK && result != BZ_STREAM_END) throw std::runtime_error("is not valid bz2");
    rest = rest.last(stream->avail_in);
    free_output = free_output.last(stream->avail_out);
    return result == BZ_STREAM_END;
  });
}
#else
void decompress_bz2(Bytes, std::uint64_t, std::vector<std::byte>&) {
  throw std::runtime_error(
      "is compressed with bz2, which this build lacks: use 'rosbag decompress'");
}
#endif

}  // namespace

std::uint32_t crc32_of(Bytes bytes, std::uint32_t crc) {
  return bytes.empty() ? crc : libdeflate_crc32(crc, bytes.data(), bytes.size());
}

struct ZstdCompressor::Impl {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  std::vector<std::byte> output;
};

ZstdCompressor::ZstdCompressor(int level) : impl_(std::make_unique<Impl>()) {
  ZSTD_CCtx_setParameter(impl_->context, ZSTD_c_compressionLevel, level);
}

ZstdCompressor::~ZstdCompressor() { ZSTD_freeCCtx(impl_->context); }

Bytes ZstdCompressor::compress(Bytes input) {
  impl_->output.resize(ZSTD_compressBound(input.size()));
  const std::size_t size = ZSTD_compress2(impl_->context, impl_->output.data(),
                                          impl_->output.size(), input.data(), input.size());
  if (ZSTD_isError(size)) throw std::runtime_error(ZSTD_getErrorName(size));
  return Bytes(impl_->output).first(size);
}

Bytes compress_lz4(Bytes input, std::vector<std::byte>& output) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max1MB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  output.resize(LZ4F_compressFrameBound(input.size(), &preferences));
  const std::size_t size =
      LZ4F_compressFrame(output.data(), output.size(), input.data(), input.size(), &preferences);
  if (LZ4F_isError(size)) throw std::runtime_error(LZ4F_getErrorName(size));
  return Bytes(output).first(size);
}

void decompress(std::string_view method, Bytes input, std::uint64_t size,
                std::vector<std::byte>& output) {
  if (method == "zstd") return decompress_zstd(input, size, output);
  if (method == "lz4") return decompress_lz4(input, size, output);
  if (method == "bz2") return decompress_bz2(input, size, output);
  throw std::runtime_error("is compressed with the unknown method '" + std::string(method) + "'");
}

bool is_zstd(Bytes bytes) {
  constexpr std::uint32_t kMagic = 0xFD2FB528;
  std::uint32_t beginning = 0;
  if (bytes.size() >= sizeof beginning) std::memcpy(&beginning, bytes.data(), sizeof beginning);
  return beginning == kMagic;
}

void decompress_zstd_frame(Bytes input, std::vector<std::byte>& output) {
  const unsigned long long size = ZSTD_getFrameContentSize(input.data(), input.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw std::runtime_error("a compressed message does not state its size");
  decompress_zstd(input, size, output);
}

void decompress_zstd_file(const std::filesystem::path& in, const std::filesystem::path& out) {
  constexpr std::size_t kBlock = 1 << 20;  // bytes
  std::ifstream from(in, std::ios::binary);
  std::ofstream to(out, std::ios::binary);
  const std::unique_ptr<ZSTD_DCtx, DeleteZstd> context(ZSTD_createDCtx());
  std::vector<char> packed(kBlock), unpacked(kBlock);
  std::size_t rest = 1;  // 0: a frame has ended
  while (from.read(packed.data(), kBlock), from.gcount() > 0) {
    ZSTD_inBuffer input{packed.data(), static_cast<std::size_t>(from.gcount()), 0};
    ZSTD_outBuffer output{unpacked.data(), kBlock, kBlock};
    while (input.pos < input.size || output.pos == output.size) {
      output.pos = 0;
      rest = ZSTD_decompressStream(context.get(), &output, &input);
      if (ZSTD_isError(rest)) throw std::runtime_error(ZSTD_getErrorName(rest));
      to.write(unpacked.data(), static_cast<std::streamsize>(output.pos));
      if (rest == 0 && input.pos == input.size) break;
    }
  }
  to.flush();
  if (!to) throw Error(out.string() + ": cannot be written; set TMPDIR to a folder with space");
  if (rest != 0) throw std::runtime_error("the compressed file is cut off");
}

}  // namespace lidarena::dataset
