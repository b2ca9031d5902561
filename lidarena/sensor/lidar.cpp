// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/lidar_motion.hpp"
#include "lidarena/sensor/lidar_shake.hpp"
#include "lidarena/sensor/normal_pairs.hpp"

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

/// Purposes of a ray's random numbers; each further echo uses the next kDraws values.
enum LidarDraw : std::uint32_t { kRange, kDetection, kAngle, kSpin, kDraws };

std::uint32_t draw_of(LidarDraw draw, std::size_t echo) {
  return draw + kDraws * static_cast<std::uint32_t>(echo);
}

/// Distance from a beam's origin at which its ray starts: 0, except in kOfficial. That mode
/// reproduces a fault of the official plugin: rays start at the minimum range, and the range is
/// measured from there.
double start_offset(const SensorConfig& config) {
  return config.mode == ScanMode::kOfficial ? config.min_range_m : 0.0;
}

bool has_times(ScanMode mode) { return mode == ScanMode::kRolling || mode == ScanMode::kFrozen; }

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

/// Working data of a block of shots of a scan.
struct Lidar::Block {
  Time begin{0};  ///< of the scan
  std::span<const Beam> shots;
  std::uint64_t first_ray = 0;  ///< number of the first shot since the sensor's start
  Point* points = nullptr;      ///< space for the maximum number of points
  PointTruth* truth = nullptr;  ///< same size, or nullptr
  std::size_t count = 0;        ///< number of points so far
  // Reused from block to block to avoid reallocation.
  std::vector<std::uint32_t> places;  ///< index in `rays` of each shot's first sub-ray
  std::vector<world::Ray> rays;       ///< in casting order
  std::vector<world::Hit> hits;
  NormalPairs range_noise;      ///< of the first echoes; two consecutive shots share a pair
  NormalPairs direction_noise;  ///< to the left and upwards, by shot
  // Of the current shot.
  double axis_to_origin = 0.0;  ///< m; ranges are measured from the sensor's axis
  std::vector<Echo> parts;
  std::vector<Echo> echoes;
};

Lidar::Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern,
             const std::string& id, std::uint64_t seed, bool noise)
    : config_(noise ? config : without_noise(config)),
      pattern_(std::move(pattern)),
      random_(seed, stream_of((id + "/range").c_str())),
      clock_(lidar_clock(config_.noise.clock, pattern_->period(), id, seed)),
      bias_(config_.noise.bias, id, seed, channels_of(*pattern_)),
      signal_(config.noise.signal),
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
  needs_signal_ = sub_rays_.size() > 1 || config_.noise.dropouts ||
                  config_.noise.weak_signal_noise ||
                  config_.returns.intensity == IntensityKind::kSignal;
}

Time Lidar::begin(std::uint64_t index) const {
  return static_cast<std::int64_t>(index) * pattern_->period();
}

Time Lidar::last_firing(std::uint64_t index) const {
  return stamp(index) + Time{clock_.elapsed(last_dt_ns_)};
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

/// Return of sub-ray `k` of a shot, if there is one within the range limits.
std::optional<Echo> Lidar::receive_ray(const world::Surfaces& world, std::size_t shot,
                                       std::size_t k, const Block& block) const {
  const std::size_t place = block.places[shot] + k;
  const world::Hit& hit = block.hits[place];
  if (!hit.valid()) return std::nullopt;
  const double range = block.axis_to_origin + static_cast<double>(hit.range);
  if (range < config_.min_range_m || range > config_.max_range_m) return std::nullopt;
  const double cosine = -static_cast<double>(hit.normal.dot(block.rays[place].direction));
  const double energy = energy_of_ray_ * world::backscatter(world.material(hit.triangle), cosine);
  const double signal = needs_signal_ ? signal_.signal(energy, range) : 0.0;
  return Echo{range, energy, signal, static_cast<std::uint32_t>(k)};
}

/// Fills block.echoes with the detected echoes of a shot of several sub-rays, in reporting order.
void Lidar::receive(const world::Surfaces& world, std::size_t shot, Block& block) const {
  block.echoes.clear();
  block.parts.clear();
  for (std::size_t k = 0; k < sub_rays_.size(); ++k) {
    const auto part = receive_ray(world, shot, k, block);
    if (part) block.parts.push_back(*part);
  }
  if (block.parts.empty()) return;
  merge_echoes(block.parts, config_.noise.beam.pulse_length_m, block.echoes);
  std::size_t number = 0;
  std::erase_if(block.echoes, [&](const Echo& echo) {
    return !is_detected(echo, block.first_ray + shot, number++);
  });
  choose_echoes(config_.returns, block.echoes);
}

bool Lidar::is_detected(const Echo& echo, std::uint64_t ray, std::size_t number) const {
  if (!config_.noise.dropouts) return true;
  const double probability = signal_.detection_probability(echo.signal);
  return probability >= 1.0 || random_.uniform(ray, draw_of(kDetection, number)) < probability;
}

/// Range noise of an echo, in sigmas.
double Lidar::range_noise(std::size_t shot, std::size_t number, const Block& block) const {
  const std::uint64_t ray = block.first_ray + shot;
  if (number > 0) return random_.normals(ray / 2, draw_of(kRange, number))[ray % 2];
  const std::uint64_t pair = ray / 2 - block.first_ray / 2;
  return static_cast<double>(ray % 2 == 0 ? block.range_noise.first(pair)
                                          : block.range_noise.second(pair));
}

/// Bias of an echo by its channel and by the surface of its strongest part.
double Lidar::range_bias(const world::Surfaces& world, std::size_t shot, const Echo& echo,
                         const Block& block) const {
  const std::size_t place = block.places[shot] + echo.sub_ray;
  const world::Hit& hit = block.hits[place];
  const double cosine = -static_cast<double>(hit.normal.dot(block.rays[place].direction));
  return bias_.range(block.shots[shot].ring, cosine, world.material(hit.triangle).reflectivity);
}

double Lidar::measured_range(const Echo& echo, std::size_t shot, std::size_t number, double bias,
                             const Block& block) const {
  const double sigma = range_sigma(config_.range_noise_m, config_.noise, echo.range, echo.signal);
  double range = echo.range + bias;
  if (sigma > 0.0) range += sigma * range_noise(shot, number, block);
  const double step = config_.noise.range_step_m;
  return step > 0.0 ? step * std::nearbyint(range / step) : range;
}

Vector3f Lidar::reported_direction(std::size_t shot, const Block& block) const {
  Vector3f direction = block.shots[shot].direction;
  if (bias_.has_directions()) {
    const Eigen::Vector2f& off = bias_.direction(block.shots[shot].ring);
    direction = slightly_deflected(direction, off.x(), off.y());
  }
  if (angle_sigma_ == 0.0F) return direction;
  return slightly_deflected(direction, angle_sigma_ * block.direction_noise.first(shot),
                            angle_sigma_ * block.direction_noise.second(shot));
}

/// Appends the point, and its truth, of the shot's echo `number`.
void Lidar::report(const world::Surfaces& world, std::size_t shot, const Echo& echo,
                   std::size_t number, Block& block) const {
  const Beam& beam = block.shots[shot];
  const double bias = bias_.has_ranges() ? range_bias(world, shot, echo, block) : 0.0;
  const double distance = measured_range(echo, shot, number, bias, block) - block.axis_to_origin;
  const bool raw = config_.returns.intensity == IntensityKind::kSignal;
  Point point;
  point.position = beam.origin + static_cast<float>(distance) * reported_direction(shot, block);
  point.intensity = static_cast<float>(raw ? echo.signal : std::min(255.0, 255.0 * echo.energy));
  point.dt_ns = has_times(config_.mode) ? clock_.elapsed(beam.dt_ns) : 0;
  point.ring = beam.ring;
  point.echo = static_cast<std::uint8_t>(number);
  block.points[block.count++] = point;
  if (block.truth == nullptr) return;
  const std::size_t place = block.places[shot] + echo.sub_ray;
  const world::Hit& hit = block.hits[place];
  const double distance_to_surface = static_cast<double>(hit.range);
  const Vector3d to_surface = distance_to_surface * block.rays[place].direction.cast<double>();
  block.truth[block.count - 1] = {
      .position = (block.rays[place].origin + to_surface).cast<float>(),
      .range =
          static_cast<float>(block.axis_to_origin + distance_to_surface + start_offset(config_)),
      .normal = hit.normal,
      .triangle = hit.triangle};
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
  for (std::size_t shot = 0; shot < block.shots.size(); ++shot) {
    block.axis_to_origin = static_cast<double>(block.shots[shot].origin.norm());
    if (sub_rays_.size() == 1) {
      const auto echo = receive_ray(world, shot, 0, block);
      if (echo && is_detected(*echo, block.first_ray + shot, 0))
        report(world, shot, *echo, 0, block);
      continue;
    }
    receive(world, shot, block);
    for (std::size_t k = 0; k < block.echoes.size(); ++k)
      report(world, shot, block.echoes[k], k, block);
  }
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
  const LidarMotion motion(flight, config_.body_from_lidar, begin(index), last_dt_ns_, rolling);
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
  return scan;
}

Scan Lidar::empty_scan(std::uint64_t index) const {
  Scan scan;
  scan.stamp = stamp(index);
  scan.timed = has_times(config_.mode);
  return scan;
}

void Lidar::measure_part(const world::Surfaces& world, const PoseAt& world_from_lidar,
                         std::span<const Beam> shots, std::uint64_t first_ray,
                         std::vector<Point>& points, std::vector<PointTruth>* truth) const {
  std::vector<Point> more;
  std::vector<PointTruth> more_truth;
  shoot_all(world, world_from_lidar, Time{0}, shots, first_ray, Parallel(1), more,
            truth == nullptr ? nullptr : &more_truth);
  points.insert(points.end(), more.begin(), more.end());
  if (truth != nullptr) truth->insert(truth->end(), more_truth.begin(), more_truth.end());
}

}  // namespace lidarena::sensor
