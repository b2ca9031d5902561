// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lidarena {
namespace {

constexpr std::size_t kRaysPerBlock = 1024;

/// What one block of shots brought back; `truth` runs parallel to `points`.
struct Returns {
  std::vector<Point> points;
  std::vector<PointTruth> truth;
};

/// Where the lidar is during a scan; shots of one instant share the pose.
class LidarMotion {
 public:
  LidarMotion(const Flight& flight, Time stamp, const SensorConfig& config)
      : flight_(flight),
        stamp_(stamp),
        body_from_lidar_(config.body_from_lidar),
        rolling_(config.mode == ScanMode::kRolling) {}

  /// world_from_lidar at `dt_ns` after the stamp.
  const Pose& at(std::int32_t dt_ns) {
    const Time instant = stamp_ + Time{rolling_ ? dt_ns : 0};
    if (!known_ || instant != instant_) {
      world_from_lidar_ = flight_.pose_at(instant) * body_from_lidar_;
      instant_ = instant;
      known_ = true;
    }
    return world_from_lidar_;
  }

 private:
  const Flight& flight_;
  Time stamp_;
  Pose body_from_lidar_;
  bool rolling_;
  bool known_ = false;
  Time instant_{0};
  Pose world_from_lidar_;
};

/// How far along its beam a shot starts: nowhere but at the beam's origin, except in the fault that
/// kOfficial keeps: shots start at the minimum range, and the range is counted from there.
double start_shift(const SensorConfig& config) {
  return config.mode == ScanMode::kOfficial ? config.min_range_m : 0.0;
}

void aim(std::span<const Beam> beams, double shift, LidarMotion motion, std::span<Ray> rays) {
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Pose& world_from_lidar = motion.at(beams[i].dt_ns);
    const Eigen::Vector3d direction = beams[i].direction.cast<double>();
    rays[i].origin = world_from_lidar * (beams[i].origin.cast<double>() + shift * direction);
    rays[i].direction = (world_from_lidar.linear() * direction).cast<float>();
  }
}

/// From the sensor's axis, as the sensor counts.
double true_range(const Beam& beam, const Hit& hit) {
  return static_cast<double>(beam.origin.norm()) + static_cast<double>(hit.range);
}

bool within_limits(const SensorConfig& config, const Beam& beam, const Hit& hit) {
  if (!hit.valid()) return false;
  const double range = true_range(beam, hit);
  return range >= config.min_range_m && range <= config.max_range_m;
}

/// `shift` as start_shift(): the truth knows where the shot should have started.
PointTruth make_truth(const Beam& beam, const Ray& ray, const Hit& hit, double shift) {
  const Eigen::Vector3d way = static_cast<double>(hit.range) * ray.direction.cast<double>();
  return {.position = (ray.origin + way).cast<float>(),
          .range = static_cast<float>(true_range(beam, hit) + shift),
          .normal = hit.normal,
          .triangle = hit.triangle};
}

/// Gaussian, of the same sigma at every range.
double range_error(const SensorConfig& config, const CounterRandom& random, std::uint64_t ray) {
  return config.range_noise_m > 0.0 ? config.range_noise_m * random.normals(ray)[0] : 0.0;
}

bool has_times(ScanMode mode) { return mode == ScanMode::kRolling || mode == ScanMode::kFrozen; }

Point make_point(const SensorConfig& config, const Beam& beam, double range, float intensity) {
  Point point;
  point.position = beam.origin + static_cast<float>(range) * beam.direction;
  point.intensity = intensity;
  point.dt_ns = has_times(config.mode) ? beam.dt_ns : 0;
  point.ring = beam.ring;
  return point;
}

/// Casts `shots`, which are the rays `first_ray`, `first_ray` + 1, ... since the sensor's start.
Returns shoot(const SensorConfig& config, const World& world, const LidarMotion& motion,
              std::span<const Beam> shots, const CounterRandom& random, std::uint64_t first_ray,
              bool with_truth) {
  const double shift = start_shift(config);
  std::vector<Ray> rays(shots.size());
  std::vector<Hit> hits(shots.size());
  aim(shots, shift, motion, rays);
  world.cast(rays, config.max_range_m - shift, hits);

  Returns returns;
  returns.points.reserve(shots.size());
  if (with_truth) returns.truth.reserve(shots.size());
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (!within_limits(config, shots[i], hits[i])) continue;
    const double range =
        static_cast<double>(hits[i].range) + range_error(config, random, first_ray + i);
    const float intensity = lambert_intensity(rays[i].direction, hits[i].normal);
    returns.points.push_back(make_point(config, shots[i], range, intensity));
    if (with_truth) returns.truth.push_back(make_truth(shots[i], rays[i], hits[i], shift));
  }
  return returns;
}

/// One part of all blocks, in order.
template <class T>
std::vector<T> join(const std::vector<Returns>& blocks, std::vector<T> Returns::*part) {
  std::size_t count = 0;
  for (const Returns& block : blocks) count += (block.*part).size();
  std::vector<T> all;
  all.reserve(count);
  for (const Returns& block : blocks) {
    all.insert(all.end(), (block.*part).begin(), (block.*part).end());
  }
  return all;
}

}  // namespace

float lambert_intensity(const Eigen::Vector3f& direction, const Eigen::Vector3f& normal) {
  return 255.0F * std::min(1.0F, std::abs(direction.dot(normal)));
}

Lidar::Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern,
             const std::string& id, std::uint64_t seed, bool noise)
    : config_(config),
      pattern_(std::move(pattern)),
      random_(seed, stream_of((id + "/range").c_str())) {
  if (!noise) config_.range_noise_m = 0.0;
  std::vector<Beam> beams;
  pattern_->beams(0, beams);
  if (!beams.empty()) last_dt_ns_ = beams.back().dt_ns;
}

Time Lidar::stamp(std::uint64_t index) const {
  return static_cast<std::int64_t>(index) * pattern_->period();
}

Time Lidar::last_firing(std::uint64_t index) const { return stamp(index) + Time{last_dt_ns_}; }

Scan Lidar::measure(const World& world, const Flight& flight, std::uint64_t index,
                    const Parallel& parallel, std::vector<PointTruth>* truth) const {
  std::vector<Beam> beams;
  pattern_->beams(index, beams);
  const LidarMotion motion(flight, stamp(index), config_);
  std::vector<Returns> blocks((beams.size() + kRaysPerBlock - 1) / kRaysPerBlock);
  parallel.for_blocks(beams.size(), kRaysPerBlock, [&](std::size_t begin, std::size_t end) {
    const std::span<const Beam> shots(beams.data() + begin, end - begin);
    const std::uint64_t first_ray = index * beams.size() + begin;
    blocks[begin / kRaysPerBlock] =
        shoot(config_, world, motion, shots, random_, first_ray, truth != nullptr);
  });

  Scan scan;
  scan.stamp = stamp(index);
  scan.timed = has_times(config_.mode);
  scan.points = join(blocks, &Returns::points);
  if (truth != nullptr) *truth = join(blocks, &Returns::truth);
  return scan;
}

}  // namespace lidarena
