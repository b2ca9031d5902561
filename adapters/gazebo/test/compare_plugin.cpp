// SPDX-License-Identifier: BSD-3-Clause
// A plugin of a <world>, for tests: at given instants casts Lidarena's rays and the physics
// engine's from the link <link>, compares them, prints a line, and ends the process with exit code
// 0 if they agree.
#include <unistd.h>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>

#include <cmath>
#include <cstdio>

#include "adapters/gazebo/gazebo_scene.hpp"
#include "adapters/gazebo/plugin/sdf_config.hpp"
#include "lidarena/sensor/lidar.hpp"

namespace lidarena::gazebo_plugin {
namespace {

struct CompareConfig {
  std::string link;
  std::string seconds;
  Geometry geometry = Geometry::kCollision;
  double tolerance = 1e-4;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("link", self.link, "", "scoped name of the link");
    v("seconds", self.seconds, "s", "instants of simulated time, separated by spaces");
    v("geometry", self.geometry, "",
      "shapes for Lidarena's rays; the engine has only collision shapes");
    v("tolerance", self.tolerance, "m", "maximum difference of ranges", above(0));
  }
};

constexpr double kMinRange = 0.1, kMaxRange = 40.0;  // m

}  // namespace

class ComparePlugin : public ::gazebo::WorldPlugin {
 public:
  void Load(::gazebo::physics::WorldPtr world, sdf::ElementPtr sdf) override {
    world_ = world;
    config_ = read_sdf_config<CompareConfig>(sdf, "compare plugin");
    std::istringstream words(config_.seconds);
    for (double s = 0.0; words >> s;) instants_.push_back(s);
    sensor::SensorConfig sensor;  // a Mid-360, 20,000 rays
    sensor::make_pattern(sensor)->beams(0, beams_);
    update_ = ::gazebo::event::Events::ConnectWorldUpdateEnd([this] { step(); });
  }

 private:
  void step() {
    if (world_->SimTime().Double() < instants_[next_] - 1e-9) return;
    compare();
    if (++next_ < instants_.size()) return;
    std::fflush(stdout);
    _exit(failed_ ? 1 : 0);
  }

  void compare() {
    auto link =
        boost::dynamic_pointer_cast<::gazebo::physics::Link>(world_->EntityByName(config_.link));
    if (!link) {
      std::printf("COMPARE no link %s\n", config_.link.c_str());
      std::fflush(stdout);
      _exit(2);
    }
    if (!scene_) {
      scene_ = std::make_unique<GazeboScene>(world_, config_.geometry, link.get());
    }
    if (auto rebuilt = scene_->rebuilt_if_changed()) ours_ = std::move(rebuilt);
    ours_->move(scene_->poses());
    auto engine = boost::dynamic_pointer_cast<::gazebo::physics::RayShape>(
        world_->Physics()->CreateShape("ray", ::gazebo::physics::CollisionPtr()));
    const Pose pose = to_pose(link->WorldPose());
    std::size_t both = 0, neither = 0, only_ours = 0, only_theirs = 0;
    double worst = 0.0, sum = 0.0;
    for (const sensor::Beam& beam : beams_) {
      const Eigen::Vector3d direction =
          (pose.linear() * beam.direction.cast<double>()).normalized();
      const Eigen::Vector3d from = pose.translation() + kMinRange * direction;
      const Eigen::Vector3d to = pose.translation() + kMaxRange * direction;
      const world::Ray ray{from, direction.cast<float>()};
      world::Hit hit;
      ours_->cast({&ray, 1}, kMaxRange - kMinRange, {&hit, 1});
      engine->SetPoints({from.x(), from.y(), from.z()}, {to.x(), to.y(), to.z()});
      double range = 0.0;
      std::string entity;
      engine->GetIntersection(range, entity);
      const bool theirs = !entity.empty() && range < kMaxRange - kMinRange;
      neither += !theirs && !hit.valid();
      only_ours += hit.valid() && !theirs;
      only_theirs += theirs && !hit.valid();
      if (!theirs || !hit.valid()) continue;
      ++both;
      const double difference = std::abs(range - static_cast<double>(hit.range));
      sum += difference;
      worst = std::max(worst, difference);
    }
    const bool fails =
        worst > config_.tolerance || only_ours + only_theirs > 0 || both < beams_.size() / 10;
    failed_ = failed_ || fails;
    std::printf(
        "COMPARE t %.3f s, sensor at %.2f %.2f %.2f: %zu rays, both hit %zu, neither %zu, "
        "only ours %zu, only the engine's %zu, mean difference %.2e m, largest %.2e m: %s\n",
        world_->SimTime().Double(), pose.translation().x(), pose.translation().y(),
        pose.translation().z(), beams_.size(), both, neither, only_ours, only_theirs,
        both > 0 ? sum / static_cast<double>(both) : 0.0, worst, fails ? "FAILED" : "ok");
  }

  ::gazebo::physics::WorldPtr world_;
  CompareConfig config_;
  std::vector<double> instants_;
  std::size_t next_ = 0;
  bool failed_ = false;
  std::vector<sensor::Beam> beams_;
  std::unique_ptr<GazeboScene> scene_;
  std::shared_ptr<world::MovingWorld> ours_;
  ::gazebo::event::ConnectionPtr update_;
};

GZ_REGISTER_WORLD_PLUGIN(ComparePlugin)

}  // namespace lidarena::gazebo_plugin
