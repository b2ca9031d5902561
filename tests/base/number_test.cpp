// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/number.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

namespace lidarena {
namespace {

TEST(Number, IsReadWholeOrNotAtAll) {
  EXPECT_EQ(parse_number("-0.1"), -0.1);
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_EQ(parse_number("42"), 42.0);
  for (const char* text : {"", " ", "1 ", " 1", "+1", "1,5", "0x10", "one", "1e", "-"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(Number, HasAPointWhateverTheLocale) {
  if (std::setlocale(LC_NUMERIC, "de_DE.UTF-8") == nullptr) GTEST_SKIP() << "no German locale here";
  const auto number = parse_number("2.5");
  std::setlocale(LC_NUMERIC, "C");
  EXPECT_EQ(number, 2.5);
}

}  // namespace
}  // namespace lidarena
