// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/lidar_block.hpp"
#include "lidarena/sensor/lidar_motion.hpp"
#include "lidarena/sensor/lidar_shake.hpp"
#include "lidarena/sensor/range_drift.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kShotsPerBlock = 1024;
constexpr std::size_t kPartsPerScan =
    32;  // number of parts that a scan is split into for the threads
constexpr std::size_t kShotsPerInstant = 256;              // of a world that moves
constexpr double kSigmaOfFwhm = 1.0 / 2.3548200450309493;  // Gaussian: 1 / (2 sqrt(2 ln 2))

/// The configuration without measurement errors, with a single echo.
SensorConfig without_noise(SensorConfig config) {
  config.range_noise_m = 0.0;
  config.noise = {};
  config.returns.count = 1;
  if (config.imu) config.imu->vibration_moves_lidar = false;
  return config;
}

SensorClock lidar_clock(const ClockConfig& config, Time period, const std::string& id,
                        std::uint64_t seed) {
  return {config.offset_s, config.drift, config.stamp_jitter_s, period, id, seed};
}

std::vector<Beam> first_beams(const ScanPattern& pattern) {
  std::vector<Beam> beams;
  pattern.beams(0, beams);
  return beams;
}

std::size_t channels_of(const ScanPattern& pattern) {
  std::size_t channels = 0;
  for (const Beam& beam : first_beams(pattern))
    channels = std::max(channels, std::size_t{beam.ring} + 1);
  return channels;
}

/// Of every group of `stride` values keeps the first counts[group], without gaps between groups.
template <class T>
void close_gaps(std::vector<T>& values, std::size_t stride,
                const std::vector<std::size_t>& counts) {
  std::size_t end = 0;
  for (std::size_t block = 0; block < counts.size(); ++block) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(block * stride);
    if (end != block * stride) {
      std::copy_n(begin, counts[block], values.begin() + static_cast<std::ptrdiff_t>(end));
    }
    end += counts[block];
  }
  values.resize(end);
}

}  // namespace

Lidar::Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern,
             const std::string& id, std::uint64_t seed, bool noise)
    : config_(noise ? config : without_noise(config)),
      pattern_(std::move(pattern)),
      random_(seed, stream_of((id + "/range").c_str())),
      clock_(lidar_clock(config_.noise.clock, pattern_->period(), id, seed)),
      bias_(config_.noise.bias, id, seed, channels_of(*pattern_)),
      signal_(config.noise.signal),
      stray_random_(seed, stream_of((id + "/strays").c_str())),
      glare_random_(seed, stream_of((id + "/glare").c_str())),
      ramp_random_(seed, stream_of((id + "/ramp").c_str())),
      sub_rays_(sub_ray_offsets(config_.noise.beam.sub_rays)),
      beam_sigma_(kDegree * kSigmaOfFwhm *
                  Vector2d(config_.noise.beam.width_deg, config_.noise.beam.height_deg)),
      energy_of_ray_(1.0 / static_cast<double>(sub_rays_.size())),
      angle_sigma_(static_cast<float>(kDegree * config_.noise.angle_noise_deg)),
      table_(*pattern_),
      order_(first_beams(*pattern_)) {
  check_returns(config.noise, config.returns, config.name.empty() ? "sensor" : config.name);
  for (const Beam& beam : first_beams(*pattern_)) last_dt_ns_ = std::max(last_dt_ns_, beam.dt_ns);
  if (config_.imu && config_.imu->vibration_moves_lidar) {
    vibration_.emplace(*config_.imu, id + "/imu", seed);
    if (vibration_->empty()) vibration_.reset();
  }
  shots_per_block_ = order_.tile() * std::max<std::size_t>(1, kShotsPerBlock / order_.tile());
  has_range_noise_ = config_.range_noise_m > 0.0 || config_.noise.near_range_noise_m > 0.0;
  if (has_particles(config_.noise.air)) {
    air_.emplace(config_.noise, signal_, config_.min_range_m, config_.max_range_m, id, seed);
  }
  is_simple_ = sub_rays_.size() == 1 && config_.noise.bounces == 0 && !air_ &&
               config_.noise.blooming.share == 0.0;
  needs_signal_ = !is_simple_ || config_.noise.dropouts || config_.noise.weak_signal_noise ||
                  config_.returns.intensity == IntensityKind::kSignal;
}

Time Lidar::begin(std::uint64_t index) const {
  return static_cast<std::int64_t>(index) * pattern_->period();
}

Time Lidar::last_firing(std::uint64_t index) const {
  const Time firing = stamp(index) + Time{clock_.elapsed(last_dt_ns_)};
  if (config_.mode != ScanMode::kFrozenRamp) return firing;
  return std::max(firing, stamp(index) + from_seconds(ramp(index)));
}

/// Length of the ramp of scan `index`, s.
double Lidar::ramp(std::uint64_t index) const {
  return config_.ramp_s * (0.5 + ramp_random_.uniform(index));
}

void Lidar::put_ramp(std::uint64_t index, Scan& scan) const {
  if (config_.mode != ScanMode::kFrozenRamp) return;
  scan.timed = true;
  const double step_ns = 1e9 * ramp(index) / static_cast<double>(scan.points.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    scan.points[i].dt_ns = static_cast<std::int32_t>(step_ns * static_cast<double>(i));
}

/// Sub-rays of a shot have similar directions and are stored next to each other; beams of a single
/// ray are stored in casting order.
void Lidar::place_rays(Block& block) const {
  const std::size_t split = sub_rays_.size();
  const std::size_t count = block.shots.size();
  if (block.places.size() == count) return;  // same as for the previous block
  block.places.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    block.places[i] = static_cast<std::uint32_t>(split == 1 ? order_.place(i, count) : i * split);
  }
  block.rays.resize(count * split);
  block.hits.resize(count * split);
}

void Lidar::aim(const PoseAt& pose_at, Block& block) const {
  const auto start = static_cast<float>(start_offset(config_));
  const std::size_t split = sub_rays_.size();
  Vector3d position = Vector3d::Zero();
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();  // world_from_lidar, single precision
  std::int32_t known_dt = -1;
  for (std::size_t i = 0; i < block.shots.size(); ++i) {
    const Beam& beam = block.shots[i];
    if (beam.dt_ns != known_dt) {  // shots of one instant share the pose
      const Pose world_from_lidar = pose_at(beam.dt_ns);
      position = world_from_lidar.translation();
      rotation = world_from_lidar.linear().cast<float>();
      known_dt = beam.dt_ns;
    }
    const Vector3f offset = rotation * (beam.origin + start * beam.direction);
    const Vector3d origin = position + offset.cast<double>();
    if (split == 1) {
      block.rays[block.places[i]] = {origin, rotation * beam.direction};
      continue;
    }
    const Vector3d axis = beam.direction.cast<double>();
    const double spin = 2.0 * std::numbers::pi * random_.uniform(block.first_ray + i, kSpin);
    const Eigen::Rotation2Dd spin_rotation(spin);
    for (std::size_t k = 0; k < split; ++k) {
      const Vector3d direction =
          deflected(axis, beam_sigma_.cwiseProduct(spin_rotation * sub_rays_[k]));
      block.rays[block.places[i] + k] = {origin, rotation * direction.cast<float>()};
    }
  }
}

/// Normal random numbers come in pairs; two consecutive shots share one for their ranges.
void Lidar::draw_noise(Block& block) const {
  const std::size_t shots = block.shots.size();
  if (has_range_noise_) block.range_noise.draw(random_, block.first_ray / 2, shots / 2 + 1, kRange);
  if (angle_sigma_ > 0.0F) block.direction_noise.draw(random_, block.first_ray, shots, kAngle);
}

/// Casts all rays of the block. If the world moves, those of some 256 shots at a time.
void Lidar::cast(const world::Surfaces& world, Block& block) const {
  const double max_range = config_.max_range_m - start_offset(config_);
  const std::size_t split = sub_rays_.size(), count = block.shots.size();
  const std::size_t tiles = std::max<std::size_t>(1, kShotsPerInstant / order_.tile());
  const std::size_t part = world.moves() ? tiles * order_.tile() : count;
  for (std::size_t first = 0; first < count; first += part) {
    const std::size_t size = std::min(part, count - first);
    const Time middle{config_.mode == ScanMode::kRolling ? block.shots[first + size / 2].dt_ns : 0};
    const std::span rays = std::span(block.rays).subspan(first * split, size * split);
    const std::span hits = std::span(block.hits).subspan(first * split, size * split);
    world.cast_at(block.begin + middle, rays, max_range, hits, world::RayOrder::kNeighbors);
  }
}

void Lidar::shoot(const world::Surfaces& world, const PoseAt& world_from_lidar,
                  Block& block) const {
  place_rays(block);
  aim(world_from_lidar, block);
  cast(world, block);
  block.count = 0;
  draw_noise(block);
  collect(world, block);
}

/// Replaces `points` (and `truth`) by the points of the shots.
void Lidar::shoot_all(const world::Surfaces& world, const PoseAt& world_from_lidar, Time begin,
                      std::span<const Beam> shots, std::uint64_t first_ray,
                      const Parallel& parallel, std::vector<Point>& points,
                      std::vector<PointTruth>* truth) const {
  const auto max_points = static_cast<std::size_t>(config_.returns.count);  // max. points per shot
  points.resize(shots.size() * max_points);
  if (truth != nullptr) truth->resize(points.size());

  std::vector<std::size_t> counts((shots.size() + shots_per_block_ - 1) / shots_per_block_);
  const std::size_t blocks_together = std::max<std::size_t>(1, counts.size() / kPartsPerScan);
  parallel.for_blocks(counts.size(), blocks_together, [&](std::size_t first, std::size_t last) {
    Block block;
    block.drift = range_drift(config_.noise.drift, begin);
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t from = i * shots_per_block_;
      block.begin = begin;
      block.shots = shots.subspan(from, std::min(shots_per_block_, shots.size() - from));
      block.first_ray = first_ray + from;
      block.points = points.data() + from * max_points;
      if (truth != nullptr) block.truth = truth->data() + from * max_points;
      shoot(world, world_from_lidar, block);
      counts[i] = block.count;
    }
  });
  close_gaps(points, shots_per_block_ * max_points, counts);
  if (truth != nullptr) close_gaps(*truth, shots_per_block_ * max_points, counts);
}

Scan Lidar::measure(const world::Surfaces& world, const flight::Flight& flight, std::uint64_t index,
                    const Parallel& parallel, std::vector<PointTruth>* truth) const {
  std::vector<Beam> storage;
  const std::span<const Beam> shots = beams(index, storage);
  const bool rolling = config_.mode == ScanMode::kRolling;
  const LidarMotion motion(flight, mounted(config_), begin(index), last_dt_ns_, rolling);
  std::optional<LidarShake> shake;
  if (vibration_) {
    shake.emplace(*vibration_, flight, config_.imu->lidar_from_imu, begin(index),
                  rolling ? last_dt_ns_ : 0);
  }
  const PoseAt world_from_lidar = [&](std::int32_t dt_ns) {
    return shake ? motion.at(dt_ns) * shake->at(rolling ? dt_ns : 0) : motion.at(dt_ns);
  };
  Scan scan = empty_scan(index);
  shoot_all(world, world_from_lidar, begin(index), shots, index * shots.size(), parallel,
            scan.points, truth);
  put_ramp(index, scan);
  return scan;
}

Scan Lidar::empty_scan(std::uint64_t index) const {
  Scan scan;
  scan.stamp = stamp(index);
  scan.timed = has_own_times(config_.mode);
  return scan;
}

void Lidar::measure_part(const world::Surfaces& world, const PoseAt& world_from_lidar,
                         std::span<const Beam> shots, std::uint64_t first_ray,
                         std::vector<Point>& points, std::vector<PointTruth>* truth) const {
  std::vector<Point> more;
  std::vector<PointTruth> more_truth;
  const Time of_scan = begin(first_ray / pattern_->beams_per_scan());
  shoot_all(world, world_from_lidar, of_scan, shots, first_ray, Parallel(1), more,
            truth == nullptr ? nullptr : &more_truth);
  points.insert(points.end(), more.begin(), more.end());
  if (truth != nullptr) truth->insert(truth->end(), more_truth.begin(), more_truth.end());
}

}  // namespace lidarena::sensor
