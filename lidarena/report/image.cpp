// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/image.hpp"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "lidarena/base/error.hpp"

namespace lidarena::report {
namespace {

constexpr std::size_t kPaletteColors = 256;

/// A picture with a palette of at most 256 colors and one byte per pixel.
struct Indexed {
  std::vector<Rgb> palette;
  std::vector<std::uint8_t> pixels;
};

/// Empty if the picture has too many colors.
std::optional<Indexed> indexed(const Image& image) {
  Indexed result;
  std::map<Rgb, std::uint8_t> known;
  for (const Rgb& color : image.pixels) {
    const auto [entry, is_new] = known.try_emplace(color, static_cast<std::uint8_t>(known.size()));
    if (is_new && result.palette.size() == kPaletteColors) return std::nullopt;
    if (is_new) result.palette.push_back(color);
    result.pixels.push_back(entry->second);
  }
  return result;
}

}  // namespace

std::string encode_png(const Image& image) {
  const std::optional<Indexed> few = indexed(image);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = few ? PNG_FORMAT_RGB_COLORMAP : PNG_FORMAT_RGB;
  png.colormap_entries = few ? static_cast<png_uint_32>(few->palette.size()) : 0;
  const void* pixels = few ? static_cast<const void*>(few->pixels.data()) : image.pixels.data();
  const void* palette = few ? few->palette.data() : nullptr;
  png_alloc_size_t size = 0;
  if (png_image_write_to_memory(&png, nullptr, &size, 0, pixels, 0, palette) == 0) {
    throw Error(std::string("encoding a PNG: ") + png.message);
  }
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels, 0, palette) == 0) {
    throw Error(std::string("encoding a PNG: ") + png.message);
  }
  bytes.resize(size);
  return bytes;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (std::size_t i = 0, out = 0; i < bytes.size(); i += 3, out += 4) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k <= n; ++k) {
      text[out + k] = kAlphabet[(group >> (18U - 6U * k)) & 63U];
    }
  }
  return text;
}

Rgb distance_color(double distance_m) {
  constexpr double kMaxRampDistance_m = 0.20;
  constexpr std::array<Rgb, 5> kRamp{Rgb{0, 34, 78}, Rgb{55, 83, 130}, Rgb{110, 125, 125},
                                     Rgb{180, 165, 90}, Rgb{254, 226, 52}};
  constexpr Rgb kOutlier{214, 32, 39};
  if (!(distance_m <= kMaxRampDistance_m)) return kOutlier;
  const double position = distance_m / kMaxRampDistance_m * (kRamp.size() - 1);
  const auto low = std::min<std::size_t>(static_cast<std::size_t>(position), kRamp.size() - 2);
  const double s = position - static_cast<double>(low);
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] =
        static_cast<std::uint8_t>(std::lround((1.0 - s) * kRamp[low][c] + s * kRamp[low + 1][c]));
  }
  return color;
}

}  // namespace lidarena::report
