// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena::report {

using Rgb = std::array<std::uint8_t, 3>;

/// A picture of 8-bit RGB pixels, first row at the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;

  Image(int w, int h, Rgb background)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), background) {}
  Rgb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// The picture as the bytes of a PNG file, with a palette if it has no more than 256 colors; the
/// same picture gives the same bytes.
std::string encode_png(const Image& image);
std::string base64(std::string_view bytes);

/// Color of a point-to-mesh distance in meters: dark blue at 0 to yellow at 20 cm (ordered in
/// lightness, so that it is readable in gray print and with color blindness), red beyond.
Rgb distance_color(double distance_m);

}  // namespace lidarena::report
