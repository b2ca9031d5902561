// SPDX-License-Identifier: BSD-3-Clause
// `simulate --live` publishes what `simulate` writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/dds/live_helpers.hpp"

namespace lidarena::dds {
namespace {

using ::testing::HasSubstr;

TEST(SimulateLive, PublishesTheMessagesThatTheDatasetWouldHold) {
  const LiveCalls live;
  live.simulate("data", 2.0);
  LiveReader reader(live.options(),
                    {.topics = {}, .idle = std::chrono::seconds(4), .stopped = after(kLimit)});
  Program simulate = live.start(
      "simulate --live --wait 3 --json --world house --flight house --sensor livox_mid360 "
      "--seconds 2 --out " +
          live.path("live"),
      "simulate.txt");
  Messages received = read_all(reader);
  ASSERT_EQ(simulate.wait(), 0) << live.text("simulate.txt");
  EXPECT_GE(received["/clock"].size(), 150U);
  received.erase("/clock");
  EXPECT_EQ(reader.lost(), 0U);
  const Messages written = read_all(*dataset::open_recording(live.path("data/data.mcap")));
  ASSERT_EQ(written.at("/livox_mid360/points").size(), 20U);
  for (const auto& [topic, messages] : written) EXPECT_EQ(received[topic], messages) << topic;
  EXPECT_EQ(received.size(), written.size());
  EXPECT_FALSE(fs::exists(live.path("live/data.mcap")));
  EXPECT_TRUE(fs::exists(live.path("live/manifest.json")));
}

TEST(SimulateLive, KeepsToTheRateAndCanLeaveOutTheTruth) {
  const LiveCalls live;
  LiveReader reader(live.options(),
                    {.topics = {}, .idle = std::chrono::seconds(4), .stopped = after(kLimit)});
  const std::string arguments =
      " --live --wait 3 --sensors-only --world house --flight house --sensor livox_mid360 ";
  Program simulate =
      live.start("simulate --json" + arguments + "--rate 2 --seconds 4 --out " + live.path("live"),
                 "simulate.txt");
  const Messages received = read_all(reader);
  ASSERT_EQ(simulate.wait(), 0) << live.text("simulate.txt");
  EXPECT_FALSE(received.contains("/truth/odometry"));
  EXPECT_FALSE(received.contains("/tf"));
  EXPECT_EQ(received.at("/livox_mid360/points").size() + reader.lost("/livox_mid360/points"), 40U);
  const std::string text = live.text("simulate.txt");  // messages of the log, then the document
  const Json told = Json::parse(text.substr(text.find("{\n")));
  EXPECT_GT(told.at("published").at("seconds"), 1.8);
  EXPECT_LT(told.at("published").at("seconds"), 3.5);
}

TEST(SimulateLive, WhatCannotBePublishedIsRefused) {
  const LiveCalls live;
  EXPECT_EQ(live.call("simulate --live --truth --world house --flight house --sensor livox_mid360 "
                      "--seconds 1 --out " +
                      live.path("live") + live.domain()),
            2);
  EXPECT_THAT(live.text("log.txt"), HasSubstr("leave out --truth"));
}

}  // namespace
}  // namespace lidarena::dds
