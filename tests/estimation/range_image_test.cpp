// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/range_image.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace lidarena::estimation {
namespace {

Scan scan_of(const std::vector<Point>& points) {
  Scan scan;
  scan.points = points;
  return scan;
}

Point at(float x, float y, std::uint16_t ring) {
  Point point;
  point.position = {x, y, 0.0F};
  point.ring = ring;
  return point;
}

RangeImage image_of(const Scan& scan, const ImageLayout& layout) {
  std::vector<Eigen::Vector3f> positions;
  for (const Point& point : scan.points) positions.push_back(point.position);
  return project(scan, positions, layout);
}

TEST(RangeImage, PutsPointsInRowsByRingAndInColumnsByAzimuthTheFirstOneStays) {
  ImageLayout layout;
  layout.columns = 8;  // each 45 degrees, the first from -180 to -135
  const Scan scan = scan_of({at(2, 0.1F, 1), at(-2, -0.1F, 0), at(3, 0.1F, 1), at(0.1F, 2, 1)});
  const RangeImage image = image_of(scan, layout);
  ASSERT_EQ(image.row_end, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(image.row(0)[0].column, 0);
  EXPECT_EQ(image.row(1)[0].column, 4);
  EXPECT_EQ(image.row(1)[0].range, scan.points[0].position.norm()) << "the first point of the cell";
  EXPECT_EQ(image.row(1)[1].column, 5);
}

TEST(RangeImage, ByArrivalPointsStandAsTheyCame) {
  ImageLayout layout;
  layout.by_azimuth = false;
  const Scan scan = scan_of({at(5, 0, 1), at(2, 0, 0), at(0, 5, 1), at(-5, 0, 1)});
  const RangeImage image = image_of(scan, layout);
  ASSERT_EQ(image.row(1).size(), 3U);
  EXPECT_EQ(image.row(1)[1].position.y(), 5.0F);
  EXPECT_EQ(image.row(1)[2].column, 2);
}

TEST(RangeImage, LeavesOutWhatIsNotUsable) {
  ImageLayout layout;
  layout.min_range_m = 1.0;
  layout.max_range_m = 10.0;
  layout.row_stride = 2;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scan scan =
      scan_of({at(0.5F, 0, 0), at(11, 0, 0), at(nan, 1, 0), at(5, 0, 1), at(5, 0, 2)});
  const RangeImage image = image_of(scan, layout);
  ASSERT_EQ(image.pixels.size(), 1U);
  EXPECT_EQ(image.row(2).size(), 1U);
}

}  // namespace
}  // namespace lidarena::estimation
