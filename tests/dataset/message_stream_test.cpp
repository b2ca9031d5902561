// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/message_stream.hpp"

#include <gmock/gmock.h>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset {
namespace {

std::vector<int> numbers(Bytes bytes) {
  std::vector<int> values;
  for (const std::byte byte : bytes) values.push_back(std::to_integer<int>(byte));
  return values;
}

// Derived by hand from the rules of CDR: a number of N bytes starts at a multiple of N, counted
// from the end of the header of four bytes.
TEST(Cdr, PadsNumbersToTheirOwnSize) {
  MessageWriter out;
  out.put(std::uint8_t{1});
  out.put(std::uint16_t{0x0203});
  out.put(std::uint8_t{4});
  out.put(std::uint32_t{0x05060708});
  out.put(std::uint8_t{9});
  out.put(1.0);                                                       // 0x3FF0000000000000
  EXPECT_THAT(numbers(out.bytes()), testing::ElementsAre(0, 1, 0, 0,  // header: CDR, little endian
                                                         1, 0, 0x03, 0x02,        // u8, pad, u16
                                                         4, 0, 0, 0,              // u8, pad to 8
                                                         0x08, 0x07, 0x06, 0x05,  // u32 at 8
                                                         9, 0, 0, 0,  // u8 at 12, pad to 16
                                                         0, 0, 0, 0, 0, 0, 0xF0, 0x3F));  // f64
}

TEST(Cdr, StringsCarryTheirLengthAndAZero) {
  MessageWriter out;
  out.put(std::string_view("ab"));
  out.put(std::uint32_t{7});
  EXPECT_THAT(numbers(out.bytes()), testing::ElementsAre(0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0, 0,  //
                                                         7, 0, 0, 0));
}

TEST(Cdr, AnEmptySequenceOfDoublesIsItsLengthAlone) {
  MessageWriter out;
  out.put(std::uint32_t{0});
  out.put(std::uint8_t{5});
  EXPECT_THAT(numbers(out.bytes()), testing::ElementsAre(0, 1, 0, 0, 0, 0, 0, 0, 5));
}

TEST(Cdr, TheHeaderOfAMessageLiesAsRosWritesIt) {
  MessageWriter out;
  ros::put_header(std::chrono::seconds(2) + Time{3}, "os", out);
  out.put(1.0);
  EXPECT_THAT(numbers(out.bytes()),
              testing::ElementsAre(0, 1, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0,  // sec, nanosec
                                   3, 0, 0, 0, 'o', 's', 0, 0,          // frame_id, pad to 16
                                   0, 0, 0, 0, 0, 0, 0xF0, 0x3F));
}

TEST(Cdr, TimesBeforeTheEpochHaveNegativeSecondsAndPositiveNanoseconds) {
  MessageWriter out;
  ros::put_header(Time{-1}, "", out);
  MessageReader in(out.bytes(), "test");
  EXPECT_EQ(in.get<std::int32_t>(), -1);
  EXPECT_EQ(in.get<std::uint32_t>(), 999'999'999U);
  MessageReader again(out.bytes(), "test");
  EXPECT_EQ(ros::get_header(again).stamp, Time{-1});
}

TEST(Cdr, WhatIsWrittenIsRead) {
  MessageWriter out;
  out.put(std::int16_t{-2});
  out.put(std::string_view("hello"));
  out.put(3.5F);
  out.put(std::uint64_t{1} << 40);
  out.put(std::string_view(""));
  MessageReader in(out.bytes(), "test");
  EXPECT_EQ(in.get<std::int16_t>(), -2);
  EXPECT_EQ(in.get_string(), "hello");
  EXPECT_EQ(in.get<float>(), 3.5F);
  EXPECT_EQ(in.get<std::uint64_t>(), std::uint64_t{1} << 40);
  EXPECT_EQ(in.get_string(), "");
}

TEST(Cdr, AMessageThatEndsTooEarlyIsBadInput) {
  MessageWriter out;
  out.put(std::uint32_t{1000});  // a length with nothing after it
  EXPECT_THROW(MessageReader(out.bytes(), "test").get_string(), InputError);
  EXPECT_THROW(MessageReader(out.bytes(), "test").get_octets(), InputError);
  EXPECT_THROW(MessageReader(out.bytes(), "test").get_length(1), InputError);
  EXPECT_THROW(MessageReader(out.bytes(), "test").get<double>(), InputError);
  EXPECT_THROW(MessageReader(Bytes{}, "test"), InputError);
}

TEST(Cdr, OtherEncodingsAreRefused) {
  for (const int second : {0, 2, 3, 7}) {  // big endian, parameter lists, CDR version 2
    const std::array<std::byte, 8> bytes{std::byte{0}, static_cast<std::byte>(second)};
    EXPECT_THROW(MessageReader(bytes, "test"), InputError) << second;
  }
}

}  // namespace
}  // namespace lidarena::dataset
