// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/pattern_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/sensor/coverage.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;
using sensor::Beam;
using ::testing::HasSubstr;

const ConfigFolder kSensorConfigs(LIDARENA_SOURCE_DIR "/configs");

/// A shot and its time since the start.
struct Shot {
  std::int64_t time_ns;
  Beam beam;
};

std::vector<Shot> first_shots(const sensor::SensorConfig& sensor, std::size_t count) {
  const auto pattern = make_pattern(sensor);
  sensor::Shots shots(*pattern);
  std::vector<Shot> all;
  for (; all.size() < count; shots.advance()) all.push_back({shots.time().count(), shots.beam()});
  return all;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string refusal(const sensor::SensorConfig& sensor, const PatternLength& length,
                    const fs::path& file) {
  try {
    write_pattern(sensor, length, file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class T>
T value_at(const std::string& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

TEST(PatternFile, NumPyAndCsvTablesOfEverySensorHaveTheShotsOfItsPattern) {
  const TemporaryFolder folder;
  for (const std::string& name : kSensorConfigs.names("sensors")) {
    SCOPED_TRACE(name);
    const sensor::SensorConfig sensor = kSensorConfigs.load_sensor(name);
    const fs::path npy = folder.path() / "p.npy", csv = folder.path() / "p.csv";
    const std::uint64_t scans = make_pattern(sensor)->repeats_after() == 1 ? 1 : 2;
    const PatternWritten written = write_pattern(sensor, {.scans = scans}, npy);
    ASSERT_EQ(written.scans, scans);
    const std::vector<Shot> shots = first_shots(sensor, written.shots);
    const std::string bytes = text_of(npy);
    const std::size_t data = 10 + value_at<std::uint16_t>(bytes, 8);
    EXPECT_EQ(data % 64, 0U);
    ASSERT_EQ(bytes.size(), data + 64 * shots.size());
    EXPECT_THAT(bytes.substr(0, data), HasSubstr("(" + std::to_string(shots.size()) + ", 8)"));

    write_pattern(sensor, {.scans = scans}, csv);
    const std::string text = text_of(csv);
    const std::string head = "time_ns,x,y,z,ring,origin_x,origin_y,origin_z\n";
    ASSERT_EQ(text.substr(0, head.size()), head);
    const char* next = text.c_str() + head.size();
    std::size_t wrong = 0, rows = 0;
    for (const auto& [time_ns, b] : shots) {
      const float values[7] = {
          b.direction.x(), b.direction.y(), b.direction.z(), static_cast<float>(b.ring),
          b.origin.x(),    b.origin.y(),    b.origin.z()};
      const std::size_t row = data + 64 * rows++;
      char* end = nullptr;
      wrong += value_at<double>(bytes, row) == 1e-9 * static_cast<double>(time_ns) ? 0 : 1;
      wrong += std::strtoll(next, &end, 10) == time_ns ? 0 : 1;
      for (std::size_t c = 0; c < 7; ++c) {
        wrong +=
            value_at<double>(bytes, row + 8 * (c + 1)) == static_cast<double>(values[c]) ? 0 : 1;
        wrong += *end == ',' && std::strtof(end + 1, &end) == values[c] ? 0 : 1;
      }
      next = end + 1;
    }
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(next, text.c_str() + text.size()) << "rows beyond the last shot";
  }
}

TEST(PatternFile, AMatrixOfRobotecTurnsTheZAxisIntoTheShotAndMovesItToItsOrigin) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "p.mat3x4f";
  for (const char* name : {"livox_mid360", "ouster_os0_128"}) {
    SCOPED_TRACE(name);
    const sensor::SensorConfig sensor = kSensorConfigs.load_sensor(name);
    const PatternWritten written = write_pattern(sensor, {.scans = 1}, file);
    const std::string bytes = text_of(file);
    ASSERT_EQ(bytes.size(), 48 * written.shots);
    std::size_t shot = 0;
    for (const auto& [time_ns, beam] : first_shots(sensor, written.shots)) {
      Eigen::Matrix<float, 3, 4, Eigen::RowMajor> matrix;
      std::memcpy(matrix.data(), bytes.data() + 48 * shot++, 48);
      const Eigen::Matrix3f rotation = matrix.leftCols<3>();
      ASSERT_LT((rotation * Eigen::Vector3f::UnitZ() - beam.direction).norm(), 1e-6F);
      ASSERT_EQ(matrix.col(3), beam.origin);
      ASSERT_LT((rotation * rotation.transpose() - Eigen::Matrix3f::Identity()).norm(), 1e-5F);
      ASSERT_GT(rotation.determinant(), 0.9F);
    }
  }
}

TEST(PatternFile, AProfileOfIsaacSimHasTheAnglesAndTimesOfEachScanAsAnEmitterState) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "p.json";
  const sensor::SensorConfig sensor = kSensorConfigs.load_sensor("livox_mid360");
  const PatternWritten written = write_pattern(sensor, {.scans = 2}, file);
  const Json profile = dataset::read_json(file).at("profile");
  EXPECT_EQ(profile.at("scanType"), "solidState");
  EXPECT_EQ(profile.at("numberOfEmitters"), 20000);
  EXPECT_EQ(profile.at("numRaysPerLine"), Json::array({20000}));
  EXPECT_EQ(profile.at("emitterStateCount"), 2);
  EXPECT_LE(profile.at("minDistBetweenEchos").get<double>(),
            profile.at("nearRangeM").get<double>());
  ASSERT_EQ(profile.at("emitterStates").size(), 2U);
  const std::vector<Shot> shots = first_shots(sensor, written.shots);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Json& state = profile["emitterStates"][i / 20000];
    const std::size_t place = i % 20000;
    const double azimuth = state["azimuthDeg"][place].get<double>() * kDegree;
    const double elevation = state["elevationDeg"][place].get<double>() * kDegree;
    const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation),
                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    ASSERT_LT((direction - shots[i].beam.direction.cast<double>()).norm(), 1e-6) << i;
    ASSERT_EQ(state["fireTimeNs"][place], shots[i].beam.dt_ns);
    ASSERT_EQ(state["channelId"][place], place + 1);
  }
  EXPECT_EQ(write_pattern(sensor, {}, file).scans, 1U) << "the default";
}

TEST(PatternFile, APrimOfIsaacSimListsAnEmitterStateOfEachScan) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "p.usda";
  sensor::SensorConfig sensor = kSensorConfigs.load_sensor("velodyne_vlp16");
  sensor.name = "16 lasers";
  write_pattern(sensor, {.scans = 2}, file);
  const std::string text = text_of(file);
  EXPECT_THAT(text, HasSubstr("#usda 1.0\n"));
  EXPECT_THAT(text, HasSubstr("def OmniLidar \"_16_lasers\""));
  EXPECT_THAT(text, HasSubstr("\"OmniSensorGenericLidarCoreEmitterStateAPI:s002\"]"));
  EXPECT_THAT(text, HasSubstr("uint omni:sensor:Core:scanRateBaseHz = 10\n"));
  EXPECT_THAT(text, HasSubstr("uint omni:sensor:Core:numberOfEmitters = 28928\n"));
  const std::string key = "float[] omni:sensor:Core:emitterState:s002:elevationDeg = [";
  const auto begin = text.find(key);
  ASSERT_NE(begin, std::string::npos);
  std::istringstream list(text.substr(begin + key.size(), text.find(']', begin + 30)));
  for (const auto& [time_ns, beam] : first_shots(sensor, 28928)) {
    double elevation = 0.0;
    char comma = ' ';
    list >> elevation >> comma;
    ASSERT_NEAR(std::sin(elevation * kDegree), beam.direction.z(), 1e-6);
  }
}

TEST(PatternFile, HasTheWholeCycleUnlessALengthIsGiven) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "p.npy";
  EXPECT_EQ(write_pattern(kSensorConfigs.load_sensor("velodyne_vlp16"), {}, file).scans, 1U);
  const sensor::SensorConfig mid360 = kSensorConfigs.load_sensor("livox_mid360");
  const PatternWritten whole = write_pattern(mid360, {}, file);
  EXPECT_EQ(whole.scans, 120U);
  EXPECT_EQ(whole.repeats_after, 120U);
  EXPECT_EQ(whole.shots, 2'400'000U);
  EXPECT_EQ(write_pattern(mid360, {.seconds = 0.5}, file).scans, 5U);
  EXPECT_EQ(write_pattern(mid360, {.seconds = 0.51}, file).scans, 6U);
}

TEST(PatternFile, SaysWhatIsWrongWithEndingAndLength) {
  const TemporaryFolder folder;
  const sensor::SensorConfig mid360 = kSensorConfigs.load_sensor("livox_mid360");
  const fs::path npy = folder.path() / "p.npy";
  EXPECT_THAT(refusal(mid360, {}, folder.path() / "p.mat"),
              AllOf(HasSubstr("p.mat: "), HasSubstr(".mat3x4f (RobotecGPULidar)")));
  EXPECT_THAT(refusal(mid360, {.scans = 1, .seconds = 1}, npy), HasSubstr("give one of them"));
  EXPECT_THAT(refusal(mid360, {.seconds = 1e6}, npy), HasSubstr("100000000 shots"));
  EXPECT_THAT(refusal(kSensorConfigs.load_sensor("livox_avia"), {}, npy),
              AllOf(HasSubstr("livox_avia: "), HasSubstr("10000 s"), HasSubstr("--seconds")));
  sensor::SensorConfig slow = mid360;
  slow.rate_hz = 2.5;
  EXPECT_THAT(refusal(slow, {}, folder.path() / "p.usda"), HasSubstr("2.5 scans per second"));
  EXPECT_FALSE(fs::exists(npy));
}

}  // namespace
}  // namespace lidarena::stages
