// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace lidarena {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kRaysPerBlock = 1024;
constexpr double kSigmaOfFwhm = 1.0 / 2.3548200450309493;  // Gaussian: 1 / (2 sqrt(2 ln 2))
constexpr double kRadians = std::numbers::pi / 180.0;

/// What the random numbers of a ray are for; those of its further echoes follow.
enum Draw : std::uint32_t { kRange, kDetection, kAngle, kSpin, kDraws };

std::uint32_t draw_of(Draw draw, std::size_t echo) {
  return draw + kDraws * static_cast<std::uint32_t>(echo);
}

/// How far along its beam a shot starts: nowhere but at the beam's origin, except in the fault that
/// kOfficial keeps: shots start at the minimum range, and the range is counted from there.
double start_shift(const SensorConfig& config) {
  return config.mode == ScanMode::kOfficial ? config.min_range_m : 0.0;
}

bool has_times(ScanMode mode) { return mode == ScanMode::kRolling || mode == ScanMode::kFrozen; }

/// From the sensor's axis, as the sensor counts.
double sensor_range(const Beam& beam, const Hit& hit) {
  return static_cast<double>(beam.origin.norm()) + static_cast<double>(hit.range);
}

/// The configuration of a sensor that measures the geometry.
SensorConfig without_noise(SensorConfig config) {
  config.range_noise_m = 0.0;
  config.noise = {};
  config.returns.count = 1;
  return config;
}

std::vector<Beam> first_beams(const ScanPattern& pattern) {
  std::vector<Beam> beams;
  pattern.beams(0, beams);
  return beams;
}

/// One part of all blocks, in order.
template <class Block, class T>
std::vector<T> join(const std::vector<Block>& blocks, std::vector<T> Block::*part) {
  std::size_t count = 0;
  for (const Block& block : blocks) count += (block.*part).size();
  std::vector<T> all;
  all.reserve(count);
  for (const Block& block : blocks) {
    all.insert(all.end(), (block.*part).begin(), (block.*part).end());
  }
  return all;
}

}  // namespace

/// Some shots of a scan on their way; `truth` runs parallel to `points`.
struct Lidar::Block {
  std::span<const Beam> shots;
  std::uint64_t first_ray = 0;  ///< number of the first shot since the sensor's start
  bool with_truth = false;
  std::vector<Ray> rays;  ///< in casting order
  std::vector<Hit> hits;
  std::vector<SubEcho> parts;  ///< of the shot at hand
  std::vector<Echo> echoes;    ///< of the shot at hand
  std::vector<Point> points;
  std::vector<PointTruth> truth;
};

Lidar::Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern,
             const std::string& id, std::uint64_t seed, bool noise)
    : config_(noise ? config : without_noise(config)),
      pattern_(std::move(pattern)),
      random_(seed, stream_of((id + "/range").c_str())),
      signal_(config.noise.signal),
      sub_rays_(sub_ray_offsets(config_.noise.beam.sub_rays)),
      beam_sigma_(kRadians * kSigmaOfFwhm *
                  Vector2d(config_.noise.beam.width_deg, config_.noise.beam.height_deg)),
      table_(*pattern_),
      order_(first_beams(*pattern_)) {
  check_returns(config.noise, config.returns, config.name.empty() ? "sensor" : config.name);
  const std::vector<Beam> beams = first_beams(*pattern_);
  if (!beams.empty()) last_dt_ns_ = beams.back().dt_ns;
  shots_per_block_ = order_.tile() * std::max<std::size_t>(1, kRaysPerBlock / order_.tile());
  needs_signal_ = sub_rays_.size() > 1 || config_.noise.dropouts ||
                  config_.noise.weak_signal_noise ||
                  config_.returns.intensity == IntensityKind::kSignal;
}

Time Lidar::stamp(std::uint64_t index) const {
  return static_cast<std::int64_t>(index) * pattern_->period();
}

Time Lidar::last_firing(std::uint64_t index) const { return stamp(index) + Time{last_dt_ns_}; }

/// Sub-rays of a shot lie together; single rays lie in casting order.
void Lidar::aim(const LidarMotion& motion, Block& block) const {
  const double shift = start_shift(config_);
  const std::size_t split = sub_rays_.size();
  Pose world_from_lidar = Pose::Identity();
  std::int32_t known_dt = -1;
  for (std::size_t i = 0; i < block.shots.size(); ++i) {
    const Beam& beam = block.shots[i];
    if (beam.dt_ns != known_dt) {  // shots of one instant share the pose
      world_from_lidar = motion.at(beam.dt_ns);
      known_dt = beam.dt_ns;
    }
    const Vector3d axis = beam.direction.cast<double>();
    const Vector3d origin = world_from_lidar * (beam.origin.cast<double>() + shift * axis);
    if (split == 1) {
      block.rays[order_.place(i, block.shots.size())] = {
          origin, (world_from_lidar.linear() * axis).cast<float>()};
      continue;
    }
    const double spin = 2.0 * std::numbers::pi * random_.uniform(block.first_ray + i, kSpin);
    const Eigen::Rotation2Dd turn(spin);
    for (std::size_t k = 0; k < split; ++k) {
      const Vector3d direction = turned_aside(axis, beam_sigma_.cwiseProduct(turn * sub_rays_[k]));
      block.rays[i * split + k] = {origin, (world_from_lidar.linear() * direction).cast<float>()};
    }
  }
}

/// Fills the shot's echoes from its hits: those detected, in the order in which they are reported.
void Lidar::receive(const World& world, std::size_t shot, Block& block) const {
  const std::size_t split = sub_rays_.size();
  const std::size_t first = split == 1 ? order_.place(shot, block.shots.size()) : shot * split;
  block.parts.clear();
  for (std::size_t k = 0; k < split; ++k) {
    const Hit& hit = block.hits[first + k];
    if (!hit.valid()) continue;
    const double range = sensor_range(block.shots[shot], hit);
    if (range < config_.min_range_m || range > config_.max_range_m) continue;
    const double cosine = -static_cast<double>(hit.normal.dot(block.rays[first + k].direction));
    const double energy =
        backscatter(world.mesh().material(hit.triangle), cosine) / static_cast<double>(split);
    const double signal = needs_signal_ ? signal_.signal(energy, range) : 0.0;
    block.parts.push_back({range, energy, signal, static_cast<std::uint32_t>(k)});
  }
  if (split == 1) {
    block.echoes.clear();
    for (const SubEcho& e : block.parts) block.echoes.push_back({e.range, e.energy, e.signal, 0});
  } else {
    merge_echoes(block.parts, config_.noise.beam.pulse_length_m, block.echoes);
  }
  if (config_.noise.dropouts) {
    std::size_t number = 0;
    std::erase_if(block.echoes, [&](const Echo& echo) {
      return !is_detected(echo, block.first_ray + shot, number++);
    });
  }
  choose_echoes(config_.returns, block.echoes);
}

bool Lidar::is_detected(const Echo& echo, std::uint64_t ray, std::size_t number) const {
  return random_.uniform(ray, draw_of(kDetection, number)) <
         signal_.detection_probability(echo.signal);
}

double Lidar::measured_range(const Echo& echo, std::uint64_t ray, std::size_t number) const {
  const double sigma = range_sigma(config_.range_noise_m, config_.noise, echo.range, echo.signal);
  double range = echo.range;
  if (sigma > 0.0) range += sigma * random_.normals(ray, draw_of(kRange, number))[0];
  const double step = config_.noise.range_step_m;
  return step > 0.0 ? step * std::round(range / step) : range;
}

Vector3f Lidar::reported_direction(const Beam& beam, std::uint64_t ray) const {
  const double sigma = kRadians * config_.noise.angle_noise_deg;
  if (sigma == 0.0) return beam.direction;
  const auto [left, up] = random_.normals(ray, kAngle);
  return turned_aside(beam.direction.cast<double>(), {sigma * left, sigma * up}).cast<float>();
}

/// Makes points, and their truth, of the shot's echoes.
void Lidar::report(std::size_t shot, Block& block) const {
  const Beam& beam = block.shots[shot];
  const std::uint64_t ray = block.first_ray + shot;
  const std::size_t split = sub_rays_.size();
  const Vector3f direction = reported_direction(beam, ray);
  const bool raw = config_.returns.intensity == IntensityKind::kSignal;
  for (std::size_t k = 0; k < block.echoes.size(); ++k) {
    const Echo& echo = block.echoes[k];
    const double way = measured_range(echo, ray, k) - static_cast<double>(beam.origin.norm());
    Point point;
    point.position = beam.origin + static_cast<float>(way) * direction;
    point.intensity = static_cast<float>(raw ? echo.signal : std::min(255.0, 255.0 * echo.energy));
    point.dt_ns = has_times(config_.mode) ? beam.dt_ns : 0;
    point.ring = beam.ring;
    point.echo = static_cast<std::uint8_t>(k);
    block.points.push_back(point);
    if (!block.with_truth) continue;
    const std::size_t place =
        split == 1 ? order_.place(shot, block.shots.size()) : shot * split + echo.sub_ray;
    const Hit& hit = block.hits[place];
    const Vector3d to_surface = hit.range * block.rays[place].direction.cast<double>();
    block.truth.push_back(
        {.position = (block.rays[place].origin + to_surface).cast<float>(),
         .range = static_cast<float>(sensor_range(beam, hit) + start_shift(config_)),
         .normal = hit.normal,
         .triangle = hit.triangle});
  }
}

Lidar::Block Lidar::shoot(const World& world, const LidarMotion& motion,
                          std::span<const Beam> shots, std::uint64_t first_ray,
                          bool with_truth) const {
  Block block;
  block.shots = shots;
  block.first_ray = first_ray;
  block.with_truth = with_truth;
  block.rays.resize(shots.size() * sub_rays_.size());
  block.hits.resize(block.rays.size());
  aim(motion, block);
  world.cast(block.rays, config_.max_range_m - start_shift(config_), block.hits,
             RayOrder::kNeighbours);
  block.points.reserve(shots.size());
  if (with_truth) block.truth.reserve(shots.size());
  for (std::size_t shot = 0; shot < shots.size(); ++shot) {
    receive(world, shot, block);
    report(shot, block);
  }
  block.rays = {};
  block.hits = {};
  return block;
}

Scan Lidar::measure(const World& world, const Flight& flight, std::uint64_t index,
                    const Parallel& parallel, std::vector<PointTruth>* truth) const {
  std::vector<Beam> storage;
  const std::span<const Beam> beams = table_.beams(index, storage);
  const LidarMotion motion(flight, config_.body_from_lidar, stamp(index), last_dt_ns_,
                           config_.mode == ScanMode::kRolling);
  std::vector<Block> blocks((beams.size() + shots_per_block_ - 1) / shots_per_block_);
  parallel.for_blocks(beams.size(), shots_per_block_, [&](std::size_t begin, std::size_t end) {
    const auto shots = beams.subspan(begin, end - begin);
    blocks[begin / shots_per_block_] =
        shoot(world, motion, shots, index * beams.size() + begin, truth != nullptr);
  });

  Scan scan;
  scan.stamp = stamp(index);
  scan.timed = has_times(config_.mode);
  scan.points = join(blocks, &Block::points);
  if (truth != nullptr) *truth = join(blocks, &Block::truth);
  return scan;
}

}  // namespace lidarena
