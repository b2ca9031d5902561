// SPDX-License-Identifier: BSD-3-Clause
// Add an odometry: it matches planes of grid cells, without a search, and estimates translation
// only. To add yours to `lidarena run NAME`, give it a folder in lidarena/odometry and a row in
// factory.cpp. usage: example_08_add_odometry
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "lidarena/flight/replay_flight.hpp"
#include "lidarena/odometry/odometry.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/stages/recorder.hpp"
#include "lidarena/world/primitives.hpp"
#include "lidarena/world/world.hpp"

namespace {

using namespace lidarena;

constexpr double kCell = 1.0;  // m
constexpr int kIterations = 5;
using Key = std::array<int, 3>;

/// Points of one cell: their number, sum, and sum of outer products.
struct Cell {
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean() const { return sum / count; }
  /// Normal of the points' plane; zero if there are fewer than ten or they do not lie in a plane.
  Eigen::Vector3d normal() const {
    if (count < 10) return Eigen::Vector3d::Zero();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> e(squares / count -
                                                           mean() * mean().transpose());
    const bool flat = e.eigenvalues()[0] < 0.01 * e.eigenvalues()[1];
    return flat ? Eigen::Vector3d(e.eigenvectors().col(0)) : Eigen::Vector3d::Zero();
  }
};

std::map<Key, Cell> cells_of(const std::vector<Eigen::Vector3d>& points,
                             const Eigen::Vector3d& offset) {
  std::map<Key, Cell> cells;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = point + offset;
    const Eigen::Vector3i k = (p / kCell).array().floor().cast<int>();
    Cell& cell = cells[{k.x(), k.y(), k.z()}];
    ++cell.count;
    cell.sum += p;
    cell.squares += p * p.transpose();
  }
  return cells;
}

/// Aligns the cells of each scan with the planes of the first scan's cells.
class CellPlanes : public odometry::Odometry {
 public:
  explicit CellPlanes(const LidarInfo& lidar) : body_from_lidar_(lidar.body_from_lidar) {}
  odometry::OdometryTraits traits() const override { return {}; }
  odometry::ScanResult track(const Scan& scan) override {
    std::vector<Eigen::Vector3d> points;
    for (const Point& p : scan.points)
      points.push_back(body_from_lidar_ * p.position.cast<double>());
    odometry::ScanResult result;
    if (reference_.empty()) {
      reference_ = cells_of(points, {0, 0, 0});
      result.status = odometry::ScanStatus::kInitializing;
    }
    for (int i = 0; i < kIterations; ++i) position_ += step(points);
    result.estimate.stamp = scan.stamp;
    result.estimate.world_from_body.translation() = position_;
    poses_.push_back(result.estimate);
    return result;
  }
  Trajectory trajectory() const override { return Trajectory(poses_); }
  std::vector<Eigen::Vector3f> map() const override {
    std::vector<Eigen::Vector3f> points;
    for (const auto& [key, cell] : reference_) points.push_back(cell.mean().cast<float>());
    return points;
  }
  odometry::MemoryUse memory() const override {
    return {.map = reference_.size() * (sizeof(Key) + sizeof(Cell))};
  }

 private:
  /// The translation that minimizes the squared distances along the planes' normals.
  Eigen::Vector3d step(const std::vector<Eigen::Vector3d>& points) const {
    Eigen::Matrix3d a = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const auto& [key, cell] : cells_of(points, position_)) {
      const auto there = reference_.find(key);
      if (there == reference_.end() || cell.normal().isZero()) continue;
      const Eigen::Vector3d n = there->second.normal();
      const double distance = n.dot(there->second.mean() - cell.mean());
      if (std::abs(distance) > 0.3) continue;
      a += n * n.transpose();
      b += distance * n;
    }
    return a.ldlt().solve(b);
  }

  Pose body_from_lidar_;
  std::map<Key, Cell> reference_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  std::vector<StampedPose> poses_;
};

/// 0.2 m along x in 1.5 s, from rest to rest.
Trajectory path() {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 30; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.1 * (1.0 - std::cos(3.14159265 * i / 30));
    poses.push_back({std::chrono::milliseconds(50 * i), pose});
  }
  return Trajectory(std::move(poses));
}

}  // namespace

int main() {
  const world::World room(world::box_shape({7.3, 5.1, 3.7}), "room");
  const flight::ReplayFlight flight(path());
  sensor::SensorConfig sensor;
  sensor.name = "mid360";
  const auto events = sensor::simulate(room, flight, {sensor}, {}, Parallel());
  CellPlanes odometry(sensor::make_rig({sensor}).lidars[0]);
  LogSink silent;
  const stages::RunResult result = stages::record_run(odometry, *events, {}, silent);
  const auto poses = result.files.trajectory.poses();
  const Eigen::Vector3d moved = poses.back().world_from_body.translation();
  const Eigen::Vector3d expected = flight.at(poses.back().stamp).world_from_body.translation();
  std::printf("estimated translation %.3f %.3f %.3f m, true %.3f %.3f %.3f\n", moved.x(), moved.y(),
              moved.z(), expected.x(), expected.y(), expected.z());
  return (moved - expected).norm() < 0.25 * expected.norm() ? 0 : 1;
}
