// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <limits>

#include "lidarena/report/image.hpp"
#include "lidarena/report/svg.hpp"
#include "lidarena/report/top_view.hpp"

namespace lidarena::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Width, height and pixels of a PNG, read by libpng.
Image decoded(const std::string& bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()), 0);
  png.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height), {0, 0, 0});
  EXPECT_NE(png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr), 0);
  return image;
}

TEST(Image, APngGivesItsPixelsBack) {
  Image image(3, 2, {10, 20, 30});
  image.at(2, 1) = {200, 100, 50};
  const Image back = decoded(encode_png(image));
  ASSERT_EQ(back.width, 3);
  ASSERT_EQ(back.height, 2);
  EXPECT_EQ(back.pixels, image.pixels);
}

TEST(Image, APngWithOrWithoutAPaletteGivesItsPixelsBack) {
  for (const int colors : {255, 256, 257}) {
    Image image(32, 32, {0, 0, 0});
    for (int i = 0; i < 32 * 32; ++i) {
      const int color = i % colors;
      image.at(i % 32, i / 32) = {static_cast<std::uint8_t>(color % 256),
                                  static_cast<std::uint8_t>(color / 256), 7};
    }
    EXPECT_EQ(decoded(encode_png(image)).pixels, image.pixels) << colors << " colors";
  }
}

TEST(Image, Base64AgreesWithTheExamplesOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Image, ColorsGrowLighterWithTheDistanceUntilTheThreshold) {
  const auto lightness = [](Rgb c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  double last = -1;
  for (int mm = 0; mm <= 200; ++mm) {
    const double now = lightness(distance_color(mm * 1e-3));
    EXPECT_GE(now, last - 1.0) << mm;  // one gray level of rounding
    last = now;
  }
  EXPECT_EQ(distance_color(0.2001), distance_color(5.0));
  EXPECT_EQ(distance_color(std::numeric_limits<double>::quiet_NaN()), distance_color(5.0));
}

TEST(Svg, TicksAreNiceAndCoverTheRange) {
  EXPECT_THAT(nice_ticks(0, 20, 4), ElementsAre(0, 5, 10, 15, 20));
  EXPECT_THAT(nice_ticks(0.3, 1.0, 3), ElementsAre(0.4, 0.6000000000000001, 0.8, 1.0));
  EXPECT_THAT(nice_ticks(3, 3, 5), ElementsAre(3));
}

TEST(Svg, TextCannotBreakThePage) {
  EXPECT_EQ(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(TopView, APointFallsWhereItsCoordinatesSay) {
  // A 10 m square outline at 1 cm spacing and one far outlier, which must not shrink the picture
  // (it is well below one point in a thousand).
  dataset::Cloud cloud;
  for (int i = 0; i < 1000; ++i) {
    const float s = 0.01F * static_cast<float>(i);
    for (const Eigen::Vector3f& p : {Eigen::Vector3f(s, 0, 0), Eigen::Vector3f(s, 10, 0),
                                     Eigen::Vector3f(0, s, 0), Eigen::Vector3f(10, s, 0)}) {
      cloud.points.push_back(p);
    }
  }
  cloud.points.emplace_back(1000.0F, 1000.0F, 0.0F);
  cloud.distance.assign(cloud.points.size(), 0.0F);
  TopView view;
  view.map = &cloud;
  view.width = 212;  // 10 m and 3 % margin on each side: 20 pixels a meter
  const std::string svg = top_view_svg(view);
  const std::string marker = "base64,";
  const std::size_t begin = svg.find(marker) + marker.size();
  const std::string text = svg.substr(begin, svg.find('\'', begin) - begin);
  // decodes base64, the inverse of the tested encoder
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (const char c : text) {
    if (c == '=') break;
    group = (group << 6U) | static_cast<std::uint32_t>(alphabet.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>((group >> static_cast<unsigned>(bits -= 8)) & 255U);
  }
  Image image = decoded(bytes);
  ASSERT_NEAR(image.height, 212, 1);
  const Rgb white{255, 255, 255};
  EXPECT_EQ(image.at(106, 106), white) << "the middle of the square is empty";
  EXPECT_NE(image.at(106, 6), white) << "its far side, y = 10 m, is at the top";
  EXPECT_NE(image.at(6, 106), white) << "its left side, x = 0, is on the left";
}

}  // namespace
}  // namespace lidarena::report
