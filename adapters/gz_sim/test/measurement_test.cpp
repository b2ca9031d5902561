// SPDX-License-Identifier: BSD-3-Clause
// The plugins in a running server: what they measure, against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "adapters/gz_sim/test/closed_forms.hpp"
#include "adapters/gz_sim/test/test_server.hpp"
#include "adapters/gz_sim/test/test_world.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::gz_sim_test {
namespace {

constexpr double kTolerance = 1e-4;  // m; a direction rounded to a float moves a hit at 15 m and
                                     // a grazing angle of 5 degrees by 2e-5 m

/// Differences between measured and expected ranges, m.
struct Comparison {
  std::size_t points = 0;
  double largest = 0.0;

  void add(double measured, double expected) {
    ++points;
    largest = std::max(largest, std::abs(measured - expected));
  }
};

/// Compares each point with bodies_at(its instant), seen from world_from_lidar(its instant).
template <class PoseAtTime, class BodiesAtTime>
Comparison compare(const std::vector<Scan>& scans, PoseAtTime world_from_lidar,
                   BodiesAtTime bodies_at) {
  Comparison result;
  for (const Scan& scan : scans) {
    for (const Point& point : scan.points) {
      const Time t = time_of(scan, point);
      const Pose pose = world_from_lidar(t);
      const Vector3d p = point.position.cast<double>();
      result.add(p.norm(),
                 nearest(bodies_at(t), pose.translation(), pose.linear() * p.normalized()));
    }
  }
  return result;
}

/// Number of shots of a Mid-360's scans that hit one of the bodies within the range limits.
std::size_t shots_that_hit(const std::vector<Scan>& scans, const Pose& world_from_lidar,
                           const std::vector<Distance>& bodies) {
  const sensor::SensorConfig mid360;
  const auto pattern = sensor::make_pattern(mid360);
  std::vector<sensor::Beam> beams;
  std::size_t count = 0;
  for (const Scan& scan : scans) {
    pattern->beams(static_cast<std::uint64_t>(scan.stamp / pattern->period()), beams);
    for (const sensor::Beam& beam : beams) {
      const double range = nearest(bodies, world_from_lidar.translation(),
                                   world_from_lidar.linear() * beam.direction.cast<double>());
      count += range >= mid360.min_range_m && range <= kMaxRange;
    }
  }
  return count;
}

void report(const char* what, const Comparison& result) {
  fmt::print("{}: {} points, largest difference {:.2e} m\n", what, result.points, result.largest);
}

TEST_F(GzSim, AStandingSensorMeasuresClosedForms) {
  const SdfPose robot{{0, 0, 1}, {0.1, -0.2, 0.3}}, mount{{0.1, 0.2, 0.3}, {0, 0, 0.5}};
  {
    TestServer server(primitives() + model("robot", robot, sensor(mount, recording(file()))));
    server.step(450);
  }
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans.front().stamp, 100 * kStep);
  const Pose world_from_lidar = robot.pose() * mount.pose();
  const std::vector<Distance> bodies = primitives_in_closed_form();
  const Comparison result = compare(
      scans, [&](Time) { return world_from_lidar; }, [&](Time) { return bodies; });
  report("a standing sensor", result);
  EXPECT_LT(result.largest, kTolerance);
  const std::size_t shots = shots_that_hit(scans, world_from_lidar, bodies);
  EXPECT_GT(shots, 5'000U);
  EXPECT_NEAR(static_cast<double>(result.points), static_cast<double>(shots), 3.0);
  for (std::size_t body = 0; body < bodies.size(); ++body) {  // each of them was hit
    std::size_t hits = 0;
    for (const Point& point : scans.front().points) {
      const Vector3d direction = world_from_lidar.linear() * point.position.cast<double>();
      const double range = bodies[body](world_from_lidar.translation(), direction.normalized());
      hits += std::abs(range - direction.norm()) < kTolerance;
    }
    EXPECT_GT(hits, 50U) << "body " << body;
  }
}

TEST_F(GzSim, EachShotIsCastFromThePoseOfItsInstant) {
  const Motion motion;
  const SdfPose mount{{0.1, 0, 0.2}, {0, 0.1, 0}};
  const fs::path trajectory = folder_.write("motion.tum", motion.tum(0.8));
  {
    TestServer server(primitives() + flying(sensor(mount, recording(file())), trajectory));
    server.step(750);
  }
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  ASSERT_EQ(scans.size(), 6U);
  const std::vector<Distance> bodies = primitives_in_closed_form();
  const auto bodies_at = [&](Time) { return bodies; };
  const auto lidar_at = [&](Time t) { return motion.at(to_seconds(t)) * mount.pose(); };
  const Comparison result = compare(scans, lidar_at, bodies_at);
  report("a sensor at 3 m/s and 1.5 rad/s", result);
  EXPECT_GT(result.points, 10'000U);
  // Edges: a shot may pass a body that its neighbor hits, so compare all but one in a thousand.
  std::size_t off = 0, off_by_a_step = 0;
  for (const Scan& scan : scans) {
    for (const Point& point : scan.points) {
      const Vector3d p = point.position.cast<double>();
      const auto difference = [&](Time t) {
        const Pose pose = lidar_at(t);
        return std::abs(p.norm() -
                        nearest(bodies, pose.translation(), pose.linear() * p.normalized()));
      };
      off += !(difference(time_of(scan, point)) < kTolerance);
      off_by_a_step += !(difference(time_of(scan, point) + kStep) < kTolerance);
    }
  }
  EXPECT_LE(1000 * off, result.points);
  EXPECT_GT(2 * off_by_a_step, result.points) << "the check would not notice a step of 1 ms";
}

TEST_F(GzSim, TheImuFeelsGravityAndTheLeverArm) {
  const Motion motion;
  const SdfPose mount{{0.4, -0.3, 0.2}, {0, 0.1, 0.5}};
  const fs::path trajectory = folder_.write("motion.tum", motion.tum(0.8));
  {
    TestServer server(flying(sensor(mount, recording(file(), "")), trajectory));
    server.step(700);
  }
  sensor::SensorConfig config = sensor::load_sensor(LIDARENA_SENSOR_FOLDER "/livox_mid360.yaml");
  const Pose body_from_imu = mount.pose() * config.imu->lidar_from_imu;
  const std::vector<ImuSample> samples = samples_in(file(), "livox_mid360");
  ASSERT_GE(samples.size(), 138U);
  double gyro = 0.0, accel = 0.0;
  for (const ImuSample& sample : samples) {
    const Pose world_from_imu = motion.at(to_seconds(sample.stamp)) * body_from_imu;
    const Eigen::Matrix3d imu_from_world = world_from_imu.linear().transpose();
    const Vector3d rate = Motion::kRate * motion.axis;  // the axis is the same in world and body
    const Vector3d lever =
        motion.at(to_seconds(sample.stamp)).linear() * body_from_imu.translation();
    const Vector3d felt = rate.cross(rate.cross(lever)) + Vector3d(0, 0, flight::kGravity);
    gyro = std::max(gyro, (sample.gyro - imu_from_world * rate).norm());
    accel = std::max(accel, (sample.accel - imu_from_world * felt).norm());
  }
  fmt::print("IMU: {} samples, rates within {:.1e} rad/s, accelerations within {:.1e} m/s^2\n",
             samples.size(), gyro, accel);
  EXPECT_LT(gyro, 1e-4);
  EXPECT_LT(accel, 1e-3);  // the lever arm's part is 1.1 m/s^2
}

TEST_F(GzSim, ABallIsSeenToFallAsThePhysicsHasIt) {
  constexpr double kRadius = 1.0, kHeight = 8.0;
  const SdfPose robot{{0, 0, 1}};
  {
    TestServer server(model("ball", {{4, 0, kHeight}},
                            shape("<sphere><radius>1.0</radius></sphere>"), /*moves=*/true) +
                      model("robot", robot, sensor({}, recording(file()))));
    server.step(1150);
  }
  const auto center_at = [&](Time t) {  // after n steps: the velocity first, then the position
    const auto n = static_cast<double>((t + kStep - Time{1}) / kStep);
    return Vector3d(4, 0, kHeight - flight::kGravity * 1e-6 * n * (n + 1) / 2);
  };
  const Comparison result = compare(
      scans_in(file(), "livox_mid360"), [&](Time) { return robot.pose(); },
      [&](Time t) { return std::vector{ball(center_at(t), kRadius)}; });
  report("a falling ball", result);
  EXPECT_GT(result.points, 2'000U);
  EXPECT_LT(result.largest, kTolerance);
}

/// Instants, in order, of the points that lie on a ball.
std::vector<Time> sightings(const std::vector<Scan>& scans, const Pose& world_from_lidar,
                            const Vector3d& center, double radius) {
  std::vector<Time> seen;
  for (const Scan& scan : scans) {
    for (const Point& point : scan.points) {
      const Vector3d p = world_from_lidar * point.position.cast<double>();
      if (std::abs((p - center).norm() - radius) < kTolerance) {
        seen.push_back(time_of(scan, point));
      }
    }
  }
  return seen;
}

TEST_F(GzSim, AModelSpawnedInFlightIsSeenAndARemovedOneIsNot) {
  const SdfPose robot{{0, 0, 1}};
  const Vector3d center(0, 0, 2);  // around the sensor, so that every shot tells
  constexpr double kRadius = 4.0;
  {
    TestServer server(model("ground", {}, shape(kGround)) +
                      model("robot", robot, sensor({}, recording(file()))));
    server.step(300);
    server.spawn(model("ball", {center}, shape("<sphere><radius>4</radius></sphere>")));
    server.step(300);
    server.remove("ball");
    server.step(350);
  }
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  ASSERT_EQ(scans.size(), 8U);
  const std::vector<Distance> without{plane_at(0.0)}, with{plane_at(0.0), ball(center, kRadius)};
  const Comparison result = compare(
      scans, [&](Time) { return robot.pose(); },
      [&](Time t) { return t > 300 * kStep && t <= 600 * kStep ? with : without; });
  report("a model spawned and removed", result);
  EXPECT_LT(result.largest, kTolerance);
  const std::vector<Time> seen = sightings(scans, robot.pose(), center, kRadius);
  ASSERT_GT(seen.size(), 50'000U);
  EXPECT_GT(seen.front(), 300 * kStep);
  EXPECT_LT(seen.front(), 301 * kStep);
  EXPECT_GT(seen.back(), 599 * kStep);
  EXPECT_LE(seen.back(), 600 * kStep);
}

TEST_F(GzSim, AStaticModelIsSeenWhereAUserPutsIt) {
  const SdfPose robot{{0, 0, 1}};
  const Vector3d before(4, 0, 2), after(-3, 3, 2);
  {
    TestServer server(model("ball", {before}, shape("<sphere><radius>1.5</radius></sphere>")) +
                      model("robot", robot, sensor({}, recording(file()))));
    server.step(300);
    server.place("ball", after);
    server.step(350);
  }
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  ASSERT_EQ(scans.size(), 5U);
  const Comparison result = compare(
      scans, [&](Time) { return robot.pose(); },
      [&](Time t) { return std::vector{ball(t > 300 * kStep ? after : before, 1.5)}; });
  report("a static model moved by a user", result);
  EXPECT_GT(result.points, 2'000U);
  EXPECT_LT(result.largest, kTolerance);
}

TEST_F(GzSim, CollisionShapesAreSeenWhenAskedFor) {
  const SdfPose robot{{0, 0, 1}};
  const std::string both = shape("<sphere><radius>1.5</radius></sphere>") +
                           shape("<box><size>1 1 1</size></box>", "collision");
  {
    TestServer server(
        model("body", {{3, 0, 2}}, both) + model("ground", {}, shape(kGround, "collision")) +
        model("robot", robot,
              sensor({}, recording(file(), "<imu>off</imu><geometry>collision</geometry>"))));
    server.step(250);
  }
  const std::vector<Distance> bodies{plane_at(0.0), box(SdfPose{{3, 0, 2}}.pose(), {1, 1, 1})};
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  const Comparison result = compare(
      scans, [&](Time) { return robot.pose(); }, [&](Time) { return bodies; });
  report("collision shapes", result);
  EXPECT_LT(result.largest, kTolerance);
  EXPECT_NEAR(static_cast<double>(result.points),
              static_cast<double>(shots_that_hit(scans, robot.pose(), bodies)), 3.0);
}

constexpr const char* kCube = R"(o cube
v -0.5 -0.5 -0.5
v 0.5 -0.5 -0.5
v -0.5 0.5 -0.5
v 0.5 0.5 -0.5
v -0.5 -0.5 0.5
v 0.5 -0.5 0.5
v -0.5 0.5 0.5
v 0.5 0.5 0.5
f 1 3 4
f 1 4 2
f 5 6 8
f 5 8 7
f 1 2 6
f 1 6 5
f 3 7 8
f 3 8 4
f 1 5 7
f 1 7 3
f 2 4 8
f 2 8 6
)";

TEST_F(GzSim, AMeshHasItsScaleAndItsPose) {
  const SdfPose robot{{0, 0, 1}}, place{{3, 1, 2}, {0.2, -0.3, 0.7}};
  const fs::path mesh = folder_.write("cube.obj", kCube);
  {
    TestServer server(
        model("crate", place,
              shape("<mesh><uri>" + mesh.string() + "</uri><scale>1 2 3</scale></mesh>")) +
        model("robot", robot, sensor({}, recording(file()))));
    server.step(350);
  }
  const std::vector<Distance> bodies{box(place.pose(), {1, 2, 3})};
  const std::vector<Scan> scans = scans_in(file(), "livox_mid360");
  const Comparison result = compare(
      scans, [&](Time) { return robot.pose(); }, [&](Time) { return bodies; });
  report("a mesh", result);
  EXPECT_GT(result.points, 500U);
  EXPECT_LT(result.largest, kTolerance);
  EXPECT_NEAR(static_cast<double>(result.points),
              static_cast<double>(shots_that_hit(scans, robot.pose(), bodies)), 3.0);
}

TEST_F(GzSim, TwoSensorsSeeEachOtherButNotThemselves) {
  const std::string housing = shape("<sphere><radius>0.3</radius></sphere>");
  const SdfPose left{{0, 0, 1}}, right{{2, 0, 1.5}};
  {
    TestServer server(model("left", left, housing + sensor({}, recording(file("left.mcap")))) +
                      model("right", right, housing + sensor({}, recording(file("right.mcap")))));
    server.step(250);
  }
  const auto check = [&](const std::string& name, const SdfPose& own, const SdfPose& other) {
    const std::vector<Scan> scans = scans_in(file(name), "livox_mid360");
    const std::vector<Distance> bodies{ball(other.position, 0.3)};
    const Comparison result = compare(
        scans, [&](Time) { return own.pose(); }, [&](Time) { return bodies; });
    EXPECT_LT(result.largest, kTolerance) << name;
    EXPECT_NEAR(static_cast<double>(result.points),
                static_cast<double>(shots_that_hit(scans, own.pose(), bodies)), 3.0)
        << name;
    return result.points;
  };
  EXPECT_GT(check("left.mcap", left, right), 50U);  // up from the left one: in its field of view
  check("right.mcap", right, left);
}

}  // namespace
}  // namespace lidarena::gz_sim_test
