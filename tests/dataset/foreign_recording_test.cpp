// SPDX-License-Identifier: BSD-3-Clause
#include "tests/dataset/foreign_recording.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Time kEpoch = ForeignRecording::kEpoch;
constexpr int kSweepPoints = 301;
constexpr Time kPeriod = milliseconds(100);
const TimeField kNone{};

Time stamp_of(int sweep) { return kEpoch + sweep * kPeriod; }

/// Times of a sweep's points from 0 to `span`, plus `start`.
std::vector<double> times(double span, double start = 0.0) {
  std::vector<double> values;
  for (int i = 0; i < kSweepPoints; ++i) values.push_back(start + span * i / (kSweepPoints - 1));
  return values;
}

ImuSample at_rest(Time stamp) { return {stamp, {0.01, 0.0, 0.0}, {0.0, 0.0, 9.80665}}; }

/// What was read: the scans, the samples and what was said about them.
struct Read {
  Dataset dataset;
  std::vector<Scan> scans;
  std::vector<ImuSample> samples;
  std::vector<std::string> left_out;
};

Read read(const fs::path& file, const ReadOptions& options = {}) {
  Read all{open_dataset(file, options), {}, {}, {}};
  read_whole_part(all.dataset);
  while (auto event = all.dataset.events->next()) {
    if (auto* scan = std::get_if<Scan>(&event->data)) {
      all.scans.push_back(std::move(*scan));
    } else {
      all.samples.push_back(std::get<ImuSample>(event->data));
    }
  }
  all.left_out = all.dataset.report->lines();
  return all;
}

class ForeignRecordings : public testing::Test {
 protected:
  fs::path file(const std::string& name = "take.mcap") const { return folder_.path() / name; }

  /// Twenty sweeps whose time field has the values that `values(sweep)` gives.
  template <class Values>
  Read read_sweeps(const TimeField& field, const Values& values) {
    ForeignRecording out(file());
    for (int k = 0; k < 20; ++k)
      out.sweep("/points", stamp_of(k), field, values(k), stamp_of(k) + kPeriod);
    out.close();
    return read(file());
  }

  TemporaryFolder folder_;
};

/// The last point of each sweep is fired 99 ms after its stamp.
void expect_swept(const std::vector<Scan>& scans, int tolerance_ns = 20) {
  ASSERT_EQ(scans.size(), 20U);
  for (int k = 0; k < 20; ++k) {
    const Scan& scan = scans[static_cast<std::size_t>(k)];
    EXPECT_TRUE(scan.timed);
    EXPECT_NEAR(static_cast<double>((scan.stamp - stamp_of(k)).count()), 0.0, tolerance_ns);
    EXPECT_NEAR(scan.points.back().dt_ns, 99e6, tolerance_ns) << "sweep " << k;
  }
}

TEST_F(ForeignRecordings, TimesOfPointsAreReadInTheUnitThatFillsThePeriod) {
  using enum ros::FieldType;
  struct Case {
    TimeField field;
    double span;
    int tolerance_ns;
  };
  for (const Case& c :
       {Case{{"t", kUint32}, 99e6, 1}, Case{{"time", kUint32}, 99e3, 1000},
        Case{{"time_stamp", kUint32}, 99e6, 1}, Case{{"time", kFloat32}, 0.099, 20},
        Case{{"offset_time", kFloat32}, 99.0, 20}, Case{{"point_time", kFloat64}, 99e3, 1}}) {
    const Read all = read_sweeps(c.field, [&](int) { return times(c.span); });
    SCOPED_TRACE(c.field.name + " to " + std::to_string(c.span));
    expect_swept(all.scans, c.tolerance_ns);
    EXPECT_THAT(all.dataset.warnings, IsEmpty());
    EXPECT_THAT(all.left_out, IsEmpty());
  }
}

TEST_F(ForeignRecordings, AUnitOtherThanTheUsualOneIsSaid) {
  const Read all = read_sweeps({"time", ros::FieldType::kUint32}, [](int) { return times(99e3); });
  EXPECT_THAT(all.dataset.notes,
              Contains(HasSubstr("field 'time' is taken to be in microseconds")));
}

TEST_F(ForeignRecordings, TimesFromZeroToOneAreSharesOfThePeriod) {
  const Read all = read_sweeps({"time", ros::FieldType::kFloat32}, [](int) { return times(0.99); });
  expect_swept(all.scans);
  EXPECT_THAT(all.dataset.notes, Contains(HasSubstr("runs from 0 to 1 over a sweep")));
}

TEST_F(ForeignRecordings, TimesThatNoUnitExplainsAreNotUsedAndBothFiguresAreNamed) {
  const Read all = read_sweeps({"time", ros::FieldType::kFloat32}, [](int) { return times(0.7); });
  EXPECT_FALSE(all.scans.at(0).timed);
  EXPECT_THAT(
      all.dataset.warnings,
      Contains(testing::AllOf(HasSubstr("/points"), HasSubstr("'time'"), HasSubstr("span 0.7 s"),
                              HasSubstr("every 0.1 s"), HasSubstr("not de-skewed"))));
}

TEST_F(ForeignRecordings, TimesThatDoNotFillThePeriodAreWarnedOf) {
  const Read all = read_sweeps({"time", ros::FieldType::kFloat32}, [](int) { return times(0.03); });
  EXPECT_TRUE(all.scans.at(0).timed);
  EXPECT_THAT(all.dataset.warnings,
              Contains(testing::AllOf(HasSubstr("span 0.03 s"), HasSubstr("every 0.1 s"))));
}

TEST_F(ForeignRecordings, PointsWithoutTimesAreSaidNotToBeDeskewed) {
  for (const TimeField& field : {kNone, TimeField{"time", ros::FieldType::kFloat32}}) {
    const Read all = read_sweeps(field, [](int) { return times(0.0); });
    EXPECT_FALSE(all.scans.at(0).timed);
    EXPECT_THAT(all.dataset.warnings, Contains(HasSubstr("not de-skewed")));
  }
}

TEST_F(ForeignRecordings, AnotherClockOfThePointsGivesTheDifferencesWithinASweep) {
  for (const double offset_s : {37.0, -1.7e9 + 600.0, 8.0}) {
    const Read all = read_sweeps({"timestamp", ros::FieldType::kFloat64}, [&](int k) {
      return times(0.099, to_seconds(stamp_of(k)) + offset_s);
    });
    expect_swept(all.scans, 500);  // a double of 1.7e9 s has a resolution of 240 ns
    EXPECT_THAT(all.dataset.warnings, Contains(HasSubstr("is on another clock than header.stamp")));
  }
}

TEST_F(ForeignRecordings, AbsoluteTimesOnTheClockOfTheStampNeedNoWord) {
  const Read all = read_sweeps({"timestamp", ros::FieldType::kFloat64},
                               [](int k) { return times(0.099, to_seconds(stamp_of(k))); });
  expect_swept(all.scans, 500);
  EXPECT_THAT(all.dataset.warnings, IsEmpty());
}

TEST_F(ForeignRecordings, ACounterThatWrapsWithinASweepIsNegativeBeforeIt) {
  const Read all = read_sweeps({"t", ros::FieldType::kUint32}, [](int k) {
    std::vector<double> values = times(99e6);
    if (k == 7) std::fill_n(values.begin(), 5, -2e6);
    return values;
  });
  ASSERT_EQ(all.scans.size(), 20U);
  EXPECT_EQ(all.scans[7].stamp, stamp_of(7) - milliseconds(2));
  EXPECT_EQ(all.scans[7].points.back().dt_ns, 101'000'000);
  EXPECT_EQ(all.scans[8].stamp, stamp_of(8));
}

TEST_F(ForeignRecordings, SweepsWithOneOldTimeKeepTheirStampAndAreCounted) {
  const Read all = read_sweeps({"timestamp", ros::FieldType::kFloat64}, [](int k) {
    const bool is_stuck = k >= 10 && k < 15;
    return times(is_stuck ? 0.0 : 0.099, to_seconds(stamp_of(is_stuck ? 10 : k)));
  });
  ASSERT_EQ(all.scans.size(), 20U);
  EXPECT_FALSE(all.scans[12].timed);
  EXPECT_EQ(all.scans[12].stamp, stamp_of(12));
  EXPECT_THAT(all.left_out, Contains(testing::AllOf(HasSubstr("/points: sweep with implausible"),
                                                    HasSubstr("5 times, first at 1700000001"))));
}

TEST_F(ForeignRecordings, PointsWithoutAFiniteTimeAreLeftOut) {
  const Read all = read_sweeps({"time", ros::FieldType::kFloat32}, [](int k) {
    std::vector<double> values = times(0.099);
    if (k == 3) values[100] = NAN;
    return values;
  });
  EXPECT_EQ(all.scans.at(3).points.size(), static_cast<std::size_t>(kSweepPoints - 1));
  EXPECT_THAT(all.left_out, testing::SizeIs(1));
}

/// Two seconds of sweeps and IMU samples in the order of time, changed by the caller.
struct Take {
  std::vector<std::pair<Time, int>> sweeps;         ///< stamp and index
  std::vector<std::pair<Time, ImuSample>> samples;  ///< log time and sample
};

Take take_of(int sweeps, double seconds) {
  Take take;
  for (int k = 0; k < sweeps; ++k) take.sweeps.emplace_back(stamp_of(k), k);
  for (int i = 0; 0.005 * i <= seconds; ++i) {
    const Time stamp = kEpoch + i * milliseconds(5);
    take.samples.emplace_back(stamp, at_rest(stamp));
  }
  return take;
}

const TimeField kT{"t", ros::FieldType::kUint32};

void write_by_time(const Take& take, ForeignRecording& out) {
  std::size_t next = 0;
  for (const auto& [stamp, index] : take.sweeps) {
    const Time log_time = stamp_of(index) + kPeriod;
    for (; next < take.samples.size() && take.samples[next].first <= log_time; ++next)
      out.imu("/imu", take.samples[next].second, take.samples[next].first);
    out.sweep("/points", stamp, kT, times(99e6), log_time);
  }
  for (; next < take.samples.size(); ++next)
    out.imu("/imu", take.samples[next].second, take.samples[next].first);
}

TEST_F(ForeignRecordings, TopicsOneAfterTheOtherAreReadByTime) {
  for (const std::string name : {"scans_first.mcap", "imu_first.mcap", "scans_first.bag"}) {
    const Take take = take_of(100, 10.1);
    ForeignRecording out(file(name));
    const auto sweeps = [&] {
      for (const auto& [stamp, index] : take.sweeps)
        out.sweep("/points", stamp, kT, times(99e6), stamp + kPeriod);
    };
    if (name.starts_with("scans")) sweeps();
    for (const auto& [log_time, sample] : take.samples) out.imu("/imu", sample, log_time);
    if (name.starts_with("imu")) sweeps();
    out.close();
    Dataset dataset = open_dataset(file(name));
    Time covered = Time::min();
    std::size_t scans = 0, samples = 0;
    while (const auto event = dataset.events->next()) {
      if (const auto* scan = std::get_if<Scan>(&event->data)) {
        EXPECT_LE(end_of(*scan), covered) << name;
        ++scans;
      } else {
        covered = std::get<ImuSample>(event->data).stamp;
        ++samples;
      }
    }
    EXPECT_EQ(scans, 100U) << name;
    EXPECT_EQ(samples, take.samples.size()) << name;
    EXPECT_THAT(dataset.report->lines(), IsEmpty()) << name;
  }
}

TEST_F(ForeignRecordings, SweepsWrittenInAnotherOrderAreReadByLogTime) {
  Take take = take_of(20, 2.1);
  std::swap(take.sweeps[10], take.sweeps[11]);
  ForeignRecording out(file());
  write_by_time(take, out);
  out.close();
  const Read all = read(file());
  ASSERT_EQ(all.scans.size(), 20U);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(all.scans[static_cast<std::size_t>(k)].stamp, stamp_of(k));
}

TEST_F(ForeignRecordings, WhatIsLateOrDoubledIsLeftOutAndCounted) {
  Take take = take_of(20, 2.1);
  take.sweeps[7].first = stamp_of(6);  // recorded twice
  take.sweeps[12].first = stamp_of(9);
  take.samples[50].second.stamp -= milliseconds(8);
  for (std::size_t i = 100; i < 105; ++i)
    take.samples[i].second.stamp = take.samples[99].second.stamp;
  ForeignRecording out(file());
  write_by_time(take, out);
  out.close();
  const Read all = read(file());
  EXPECT_EQ(all.scans.size(), 18U);
  EXPECT_EQ(all.samples.size(), take.samples.size() - 6);
  EXPECT_THAT(all.left_out, Contains(testing::AllOf(HasSubstr("'points': sweep not later"),
                                                    HasSubstr("2 times"))));
  EXPECT_THAT(all.left_out, Contains(testing::AllOf(HasSubstr("'imu': IMU sample not later"),
                                                    HasSubstr("6 times"))));
}

TEST_F(ForeignRecordings, AnImuThatEndsOrBeginsLateDoesNotEndTheScans) {
  for (const bool ends : {true, false}) {
    Take take = take_of(100, 10.1);
    std::erase_if(take.samples, [&](const auto& entry) {
      return ends == (entry.first > kEpoch + std::chrono::seconds(ends ? 2 : 8));
    });
    ForeignRecording out(file());
    write_by_time(take, out);
    out.close();
    const Read all = read(file());
    EXPECT_EQ(all.scans.size(), 100U);
    EXPECT_EQ(all.samples.size(), take.samples.size());
    if (ends) {
      EXPECT_THAT(all.left_out, Contains(HasSubstr("no sample from here to the end")));
    } else {
      EXPECT_THAT(all.dataset.warnings, Contains(HasSubstr("/imu begins 8.0")));
    }
  }
}

TEST_F(ForeignRecordings, ClocksThatDifferAreNamedWithTheirDifference) {
  for (const double offset_s : {-1.7e9 + 100.0, 37.0, -1.8}) {
    Take take = take_of(20, 2.1);
    for (auto& [log_time, sample] : take.samples) sample.stamp += from_seconds(offset_s);
    ForeignRecording out(file());
    write_by_time(take, out);
    out.close();
    const Read all = read(file());
    EXPECT_EQ(all.scans.size(), 20U);
    EXPECT_THAT(all.dataset.rig.imus, IsEmpty());
    EXPECT_THAT(all.dataset.imu_fault, HasSubstr("the clocks of /imu and /points differ by"));
  }
}

TEST_F(ForeignRecordings, SamplesThatCannotBeMeasurementsAreLeftOut) {
  Take take = take_of(20, 2.1);
  take.samples[30].second.accel.setConstant(NAN);
  take.samples[40].second.accel.setConstant(1e6);
  for (std::size_t i = 0; i < 10; ++i) {
    take.samples[i].second.accel.setZero();
    take.samples[i].second.gyro.setZero();
  }
  ForeignRecording out(file());
  write_by_time(take, out);
  out.close();
  const Read all = read(file());
  EXPECT_EQ(all.samples.size(), take.samples.size() - 12);
  EXPECT_THAT(all.left_out, Contains(HasSubstr("IMU sample not finite")));
  EXPECT_THAT(all.left_out, Contains(HasSubstr("beyond 40 g")));
  EXPECT_THAT(all.left_out, Contains(HasSubstr("all zero, left out: 10 times")));
}

/// A recording of a LiDAR, a depth camera and two IMUs.
void write_several(const fs::path& file) {
  ForeignRecording out(file);
  for (int k = 0; k < 20; ++k) {
    const Time log_time = stamp_of(k) + kPeriod;
    out.sweep("/depth/points", stamp_of(k), kNone, times(0.0), log_time, "camera");
    for (int i = 0; i < 20; ++i) {
      const Time stamp = stamp_of(k) + i * milliseconds(5);
      out.imu("/mavros/imu/data", at_rest(stamp), stamp, "base_link");
      out.imu("/os/imu", at_rest(stamp), stamp, "os_imu");
    }
    out.sweep("/os/points", stamp_of(k), kT, times(99e6), log_time, "os_lidar");
    out.odometry("/odometry", {stamp_of(k), Pose::Identity()});
  }
  out.close();
}

std::vector<std::string> ids_of(const Dataset& dataset) {
  std::vector<std::string> ids;
  for (const LidarInfo& lidar : dataset.rig.lidars) ids.push_back(lidar.id);
  for (const ImuInfo& imu : dataset.rig.imus) ids.push_back(imu.id);
  return ids;
}

TEST_F(ForeignRecordings, OfSeveralTopicsThoseThatBelongTogetherAreTaken) {
  write_several(file());
  const Dataset dataset = open_dataset(file());
  EXPECT_THAT(ids_of(dataset), testing::ElementsAre("os", "os_imu"));
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("from /os/points, not from /depth/points")));
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("from /os/imu, not from /mavros/imu/data")));
}

TEST_F(ForeignRecordings, LidarAndImuAreChosenByTopic) {
  write_several(file());
  ReadOptions options;
  options.sensor = "/depth/points";
  options.imu_topic = "/mavros/imu/data";
  EXPECT_THAT(ids_of(open_dataset(file(), options)),
              testing::ElementsAre("depth", "mavros_imu_data"));
  options.imu_topic = "/none";
  EXPECT_THAT(input_error([&] { open_dataset(file(), options); }),
              HasSubstr("it has: /mavros/imu/data, /os/imu"));
}

TEST_F(ForeignRecordings, TopicsAreListedWithTypeRateAndFrame) {
  write_several(file());
  const Dataset dataset = open_dataset(file());
  ASSERT_EQ(dataset.topics.size(), 5U);
  const TopicSummary& imu = *std::ranges::find(dataset.topics, "/os/imu", &TopicSummary::topic);
  EXPECT_EQ(imu.type, "sensor_msgs/msg/Imu");
  EXPECT_EQ(imu.frame_id, "os_imu");
  EXPECT_NEAR(imu.rate_hz, 200.0, 1e-6);
  EXPECT_TRUE(imu.is_read);
}

TEST_F(ForeignRecordings, ACopyHasAllLidarsAndImus) {
  write_several(file());
  ReadOptions options;
  options.all_sensors = true;
  Dataset in = open_dataset(file(), options);
  EXPECT_EQ(copy_dataset(in, file("copy.mcap")).scans, 40U);
  const Dataset copy = open_dataset(file("copy.mcap"));
  EXPECT_THAT(ids_of(copy), testing::ElementsAre("depth", "os", "mavros_imu_data", "os_imu"));
}

TEST_F(ForeignRecordings, StaticFramesMountTheSensors) {
  const Pose body_from_lidar = make_pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.1});
  const double half = std::numbers::sqrt2 / 2.0;
  const Pose mount_from_imu =
      make_pose(Eigen::Quaterniond(half, 0.0, 0.0, half), {0.01, 0.02, 0.0});
  const Pose body_from_mount = make_pose(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0});
  ForeignRecording out(file());
  out.frames({{kEpoch, "base_link", "lidar", body_from_lidar},
              {kEpoch, "base_link", "mount", body_from_mount},
              {kEpoch, "mount", "imu", mount_from_imu}},
             kEpoch);
  write_by_time(take_of(20, 2.1), out);
  out.close();
  const Dataset dataset = open_dataset(file());
  EXPECT_EQ(dataset.rig.body_frame, "base_link");
  EXPECT_TRUE(dataset.rig.lidars.at(0).body_from_lidar.isApprox(body_from_lidar, 1e-12));
  EXPECT_TRUE(
      dataset.rig.imus.at(0).body_from_imu.isApprox(body_from_mount * mount_from_imu, 1e-12));
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("/tf_static mounts lidar, imu on the body")));

  ReadOptions options;
  options.body_from_lidar = body_from_mount;
  const Dataset given = open_dataset(file(), options);
  EXPECT_TRUE(given.rig.lidars.at(0).body_from_lidar.isApprox(body_from_mount, 1e-12));
}

TEST_F(ForeignRecordings, OfACutFileTheWholePartIsReadAndTheEndIsReported) {
  for (const std::string name : {"cut.mcap", "cut.bag"}) {
    ForeignRecording out(file(name));
    write_by_time(take_of(1000, 100.1), out);
    out.close();
    fs::resize_file(file(name), fs::file_size(file(name)) * 6 / 10);
    const Read all = read(file(name));
    EXPECT_GT(all.scans.size(), 500U) << name;
    EXPECT_LT(all.scans.size(), 600U) << name;
    EXPECT_THAT(all.dataset.report->ended(), HasSubstr("is cut off after")) << name;
  }
}

TEST_F(ForeignRecordings, OfACutFileTheWholePartIsCopied) {
  ForeignRecording out(file());
  write_by_time(take_of(1000, 100.1), out);
  out.close();
  fs::resize_file(file(), fs::file_size(file()) * 6 / 10);
  Dataset in = open_dataset(file());
  read_whole_part(in);
  EXPECT_GT(copy_dataset(in, file("copy.mcap")).scans, 500U);
  EXPECT_THAT(in.report->ended(), HasSubstr("is cut off after"));
  EXPECT_EQ(open_dataset(file("copy.mcap")).scan_count.value_or(0),
            read(file("copy.mcap")).scans.size());
}

TEST_F(ForeignRecordings, AnEmptyFileIsCalledEmpty) {
  for (const char* name : {"a.mcap", "a.bag"}) {
    folder_.write(name, "");
    EXPECT_THAT(input_error([&] { open_dataset(file(name)); }), HasSubstr("is empty"));
  }
}

TEST_F(ForeignRecordings, AFolderOfBagsIsOneTakeInTheOrderOfTime) {
  fs::create_directory(file("takes"));
  // the names are in another order than the times
  for (const auto& [name, first] : {std::pair{"b.bag", 0}, std::pair{"a.bag", 10}}) {
    ForeignRecording out(file("takes") / name);
    for (int k = first; k < first + 10; ++k)
      out.sweep("/points", stamp_of(k), kT, times(99e6), stamp_of(k) + kPeriod);
    out.close();
  }
  const Read all = read(file("takes"));
  ASSERT_EQ(all.scans.size(), 20U);
  EXPECT_EQ(all.dataset.scan_count, 20U);
  EXPECT_EQ(all.scans[0].stamp, stamp_of(0));
  EXPECT_THAT(all.left_out, IsEmpty());
}

}  // namespace
}  // namespace lidarena::dataset
