// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/text_file.hpp"

#include <gmock/gmock.h>

#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(DecimalTime, KeepsEveryNanosecond) {
  EXPECT_EQ(parse_seconds("1690309709.285305601"), Time{1690309709285305601});
  EXPECT_EQ(parse_seconds("1403715540.4621429443"), Time{1403715540462142944});
  EXPECT_EQ(parse_seconds("-0.000000001"), Time{-1});
  EXPECT_EQ(parse_seconds("+12"), Time{12'000'000'000});
  EXPECT_EQ(parse_seconds(".5"), Time{500'000'000});
  EXPECT_EQ(parse_seconds("3."), Time{3'000'000'000});
  EXPECT_EQ(parse_seconds("000000000000000000000000.001"), Time{1'000'000});
  EXPECT_EQ(parse_seconds("0"), Time{0});
}

TEST(DecimalTime, UnderstandsExponents) {
  EXPECT_EQ(parse_seconds("1.403715524907143116e+09"), Time{1403715524907143116});
  EXPECT_EQ(parse_seconds("1.5E3"), Time{1'500'000'000'000});
  EXPECT_EQ(parse_seconds("25e-10"), Time{3});
  EXPECT_EQ(parse_seconds("1e-400"), Time{0});
}

TEST(DecimalTime, HalfANanosecondRoundsAwayFromZero) {
  EXPECT_EQ(parse_seconds("0.0000000005"), Time{1});
  EXPECT_EQ(parse_seconds("0.00000000049999"), Time{0});
  EXPECT_EQ(parse_seconds("-1.9999999995"), Time{-2'000'000'000});
}

TEST(DecimalTime, WhatIsNoTimeIsRefused) {
  for (const char* word : {"", "-", ".", "abc", "1.2.3", "1e", "1e+", "1e+-3", "nan", "inf", "1 2",
                           "0x10", "1e30", "9223372036.854775808", "--1", "1,5"}) {
    EXPECT_EQ(parse_seconds(word), std::nullopt) << word;
  }
  EXPECT_EQ(parse_seconds("9223372036.854775807"), Time::max());
}

TEST(DecimalTime, IsWrittenAsItIsRead) {
  for (const std::int64_t ns :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{999'999'999},
        std::int64_t{-1'500'000'000}, std::int64_t{1690309709285305601}, Time::max().count()}) {
    EXPECT_EQ(parse_seconds(format_seconds(Time{ns})), Time{ns});
  }
  EXPECT_EQ(format_seconds(Time{-1}), "-0.000000001");
  EXPECT_EQ(format_seconds(Time{1690309709285305601}), "1690309709.285305601");
}

TEST(TextRows, LeavesOutWhatIsNotData) {
  TextRows rows("\xEF\xBB\xBF# header\r\n\r\n  1\t2  \r\n\n \t \n#x\n3 4", "a.txt");
  EXPECT_EQ(rows.next(), "1\t2");
  EXPECT_EQ(rows.place(), "a.txt:3");
  EXPECT_EQ(rows.next(), "3 4");
  EXPECT_EQ(rows.place(), "a.txt:7");
  EXPECT_EQ(rows.next(), std::nullopt);
  EXPECT_EQ(rows.next(), std::nullopt);
}

TEST(TextRows, SplitsAtBlanksAndCommas) {
  EXPECT_THAT(split_words("a \t b\tc"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(split_words(""), ElementsAre());
  EXPECT_THAT(split_commas("a, b ,,c"), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(split_commas(""), ElementsAre(""));
}

TEST(Numbers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(parse_double("-1.25e2"), -125.0);
  EXPECT_EQ(parse_double("+0.5"), 0.5);
  for (const char* word : {"", "+", "1.0x", "1,5", "+-1", "0x1p3"}) {
    EXPECT_EQ(parse_double(word), std::nullopt) << word;
  }
  EXPECT_THAT(input_error([] { finite_number("nan", "f:3"); }), HasSubstr("f:3: 'nan' is not fin"));
  EXPECT_THAT(input_error([] { finite_number("-inf", "f:3"); }), HasSubstr("is not finite"));
}

TEST(ReadBytes, NamesWhatCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(input_error([&] { read_bytes(folder.path() / "none"); }), HasSubstr("no such file"));
  EXPECT_THAT(input_error([&] { read_bytes(folder.path()); }), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace lidarena::dataset
