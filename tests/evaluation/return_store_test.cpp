// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/return_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "lidarena/base/error.hpp"
#include "tests/listed_sources.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::evaluation {
namespace {

using listed::Events;

Scan scan_of(std::int64_t stamp, std::size_t points, bool timed = true) {
  Scan scan{Time{stamp}, {}, timed};
  for (std::size_t i = 0; i < points; ++i) {
    const auto k = static_cast<std::uint16_t>(i);
    scan.points.push_back({{0.1F, 0.2F, static_cast<float>(i)}, 0.5F * k, 7 * k, k, 1});
  }
  return scan;
}

std::unique_ptr<Events> two_lidars() {
  auto made = std::make_unique<Events>();
  Events& source = *made;
  source.events.push_back({"front", scan_of(10, 5)});
  source.events.push_back({"imu", ImuSample{}});
  source.events.push_back({"rear", scan_of(12, 3)});
  source.events.push_back({"front", scan_of(20, 0)});
  source.events.push_back({"front", scan_of(30, 4, false)});
  return made;
}

TEST(ReturnStore, KeepsTheScoredReturnsOfOneLidarWhileAllEventsPassUnchanged) {
  const TemporaryFolder folder;
  ReturnStore store(folder.path() / "not_made_yet" / "run", "front", 2);
  const auto passed = store.keep_from(two_lidars());
  std::size_t events = 0, points = 0;
  while (const auto event = passed->next()) {
    ++events;
    if (const auto* scan = std::get_if<Scan>(&event->data)) points += scan->points.size();
  }
  EXPECT_EQ(events, 5U);
  EXPECT_EQ(points, 12U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
  for (int time = 0; time < 2; ++time) {  // as often as wanted
    const auto kept = store.read();
    const auto first = kept->next(), second = kept->next(), third = kept->next();
    ASSERT_TRUE(first && second && third);
    EXPECT_FALSE(kept->next());
    const Scan& scan = std::get<Scan>(first->data);
    EXPECT_EQ(first->sensor_id, "front");
    EXPECT_EQ(scan.stamp, Time{10});
    ASSERT_EQ(scan.points.size(), 2U);  // every third of five
    EXPECT_EQ(scan.points[1].position, Eigen::Vector3f(0.1F, 0.2F, 3.0F));
    EXPECT_EQ(scan.points[1].intensity, 1.5F);
    EXPECT_EQ(scan.points[1].dt_ns, 21);
    EXPECT_EQ(scan.points[1].ring, 3);
    EXPECT_EQ(scan.points[1].echo, 1);
    EXPECT_TRUE(std::get<Scan>(second->data).points.empty());
    EXPECT_FALSE(std::get<Scan>(third->data).timed);
  }
}

TEST(ReturnStore, AFullDiskIsAnErrorThatNamesThePlace) {
  const TemporaryFolder folder;
  ReturnStore store(folder.path(), "front", 20'000);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  auto source = std::make_unique<Events>();
  source->events.push_back({"front", scan_of(10, 5000)});
  const auto passed = store.keep_from(std::move(source));
  try {
    passed->next();
    store.read();
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(folder.path().string()), std::string::npos);
  }
  std::signal(SIGXFSZ, ignored);
  setrlimit(RLIMIT_FSIZE, &before);
}

}  // namespace
}  // namespace lidarena::evaluation
