// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/improvement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lidarena/base/error.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<ImprovementStep> shipped_steps() {
  return load_steps(configs().root() / "improve.yaml");
}

std::vector<std::string> names_of(const std::vector<VariedSet>& sets) {
  std::vector<std::string> names;
  for (const VariedSet& set : sets) names.push_back(set.name);
  return names;
}

TEST(Improvement, TakesOfEachStepWhatIsBetterThanTheSensor) {
  const auto mid360 = steps_for(shipped_steps(), configs().load_sensor("livox_mid360"));
  EXPECT_THAT(names_of(mid360),
              ElementsAre("20 scans per second", "IMU ADIS16465", "angles of an OS0",
                          "range noise of an XT32", "shots of an Airy", "field of an OS0",
                          "range of an OS1", "IMU HG1700"));
  // The Mid-360 sees 40 m at 10 % already; its gyro is noisier, its alignment worse than the
  // ADIS's.
  EXPECT_EQ(mid360[6].set.dump(),
            R"({"sensor.max_range_m":120,"sensor.noise.signal.range_at_80_m":120})");
  EXPECT_EQ(mid360[1].set.size(), 3U);

  // The OS0-128 has the angles, the shots and the field.
  EXPECT_THAT(names_of(steps_for(shipped_steps(), configs().load_sensor("ouster_os0_128"))),
              ElementsAre("20 scans per second", "IMU ADIS16465", "range noise of an XT32",
                          "range of an OS1", "IMU HG1700"));
  // No IMU, so nothing of an IMU.
  for (const VariedSet& set : steps_for(shipped_steps(), configs().load_sensor("velodyne_vlp16")))
    EXPECT_THAT(set.name, Not(HasSubstr("IMU")));
}

TEST(Improvement, PlansEachStepOnTheFlightsOfTheSensorItself) {
  const auto steps = steps_for(shipped_steps(), configs().load_sensor("livox_mid360"));
  ImprovementRequest request{.sensor = "livox_mid360", .world = "house", .flight = "house"};
  request.seeds = 3;
  EXPECT_EQ(planned_cells(improvement_study(request, steps), configs()).size(), 9U * 3U);
  request.pairs = true;
  // 28 pairs, less that of the two IMUs, which set the same key.
  EXPECT_EQ(planned_cells(improvement_study(request, steps), configs()).size(), (9U + 27U) * 3U);
  request.flight = "hous";
  EXPECT_THROW(planned_cells(improvement_study(request, steps), configs()), InputError);
}

TEST(Improvement, RefusesAStepThatIsNotComplete) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const auto file = folder.write("steps.yaml", text);
    try {
      steps_for(load_steps(file), configs().load_sensor("livox_mid360"));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error("steps: []\n"), AllOf(HasSubstr("steps.yaml"), HasSubstr("has no steps")));
  EXPECT_THAT(error("steps: [{name: more, set: {sensor.rate_hz: 20}}]\n"),
              AllOf(HasSubstr("steps.yaml: more"), HasSubstr("has no source")));
  EXPECT_THAT(error("steps: [{name: more, source: X, set: {}}]\n"), HasSubstr("sets nothing"));
  EXPECT_THAT(error("steps: [{name: more, source: X, set: {world.seed: 2}}]\n"),
              HasSubstr("world.seed, which is no key of a sensor"));
  EXPECT_THAT(error("steps: [{name: more, source: X, set: {sensor.rate_hz: fast}}]\n"),
              HasSubstr("no number"));
  EXPECT_THAT(error("steps: [{name: more, source: X, set: {sensor.rate: 20}}]\n"),
              AllOf(HasSubstr("sensor.rate"), HasSubstr("schema sensor")));
  EXPECT_THAT(error("steps: [{name: more, source: X, best: less, set: {sensor.rate_hz: 20}}]\n"),
              HasSubstr("steps.yaml:1"));
}

}  // namespace
}  // namespace lidarena::study
