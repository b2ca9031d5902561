// SPDX-License-Identifier: BSD-3-Clause
// From the hits of a block of rays to points.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/sensor/coverage.hpp"
#include "lidarena/sensor/lidar_block.hpp"

namespace lidarena::sensor {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kWidestGlare = 1.0;  // rad; no light comes from farther beside a beam
enum GlareDraw : std::uint32_t { kGlareSpin, kGlareShift, kGlareDetection };

}  // namespace

/// Return of sub-ray `k` of a shot, if there is one within the range limits.
std::optional<Echo> Lidar::receive_ray(const world::Surfaces& world, std::size_t shot,
                                       std::size_t k, const Block& block) const {
  const std::size_t place = block.places[shot] + k;
  const world::Hit& hit = block.hits[place];
  if (!hit.valid()) return std::nullopt;
  const double range = block.axis_to_origin + static_cast<double>(hit.range);
  if (range < config_.min_range_m || range > config_.max_range_m) return std::nullopt;
  const double cosine = -static_cast<double>(hit.normal.dot(block.rays[place].direction));
  const world::Material& material = world.material(hit.triangle);
  double energy = energy_of_ray_ * world::backscatter(material, cosine);
  if (!is_simple_) energy *= share_on_the_way(material, cosine, range);
  const double signal = needs_signal_ ? signal_.signal(energy, range) : 0.0;
  return Echo{range, energy, signal, static_cast<std::uint32_t>(k)};
}

/// Share of the light that enters the surface at `range` and comes back through the air.
double Lidar::share_on_the_way(const world::Material& material, double cosine, double range) const {
  const double enters = config_.noise.bounces > 0 ? entering_share(material, cosine) : 1.0;
  return enters * enters * (air_ ? air_->passed(range) : 1.0);
}

/// The part of a sub-ray's light that comes back from a surface, `share` of it on the way.
Echo Lidar::echo_of(const world::Material& material, double cosine, double share, double range,
                    std::uint32_t source) const {
  const double energy = share * energy_of_ray_ * world::backscatter(material, cosine) *
                        share_on_the_way(material, cosine, range);
  return {range, energy, signal_.signal(energy, range), source};
}

/// Adds to block.parts what sub-ray `k` of a shot sees through panes and in mirrors.
void Lidar::look_beyond(const world::Surfaces& world, std::size_t shot, std::size_t k,
                        Block& block) const {
  const std::size_t place = block.places[shot] + k;
  const world::Ray& ray = block.rays[place];
  const world::Hit& first = block.hits[place];
  if (!first.valid()) return;
  const world::Material& surface = world.material(first.triangle);
  if (surface.transmission == 0.0 && surface.specular == 0.0) return;
  const double farthest = config_.max_range_m - block.axis_to_origin;
  block.ends.clear();
  follow_light(world, time_of(shot, block), ray, first, config_.noise.bounces, farthest,
               block.ends);
  for (const PathEnd& end : block.ends) {
    const double range = block.axis_to_origin + end.length;
    if (range < config_.min_range_m || range > config_.max_range_m) continue;
    const world::Material& material = world.material(end.hit.triangle);
    const auto source = static_cast<std::uint32_t>(sub_rays_.size() + block.beyond.size());
    block.parts.push_back(echo_of(material, end.cosine, end.share, range, source));
    block.beyond.push_back({.direction = ray.direction,
                            .distance = end.length,
                            .normal = end.mirrored ? Vector3f(-ray.direction) : end.hit.normal,
                            .triangle = end.mirrored ? kGhost : end.hit.triangle,
                            .cosine = end.cosine,
                            .reflectivity = material.reflectivity});
  }
}

/// Instant of a shot, of a world that moves.
Time Lidar::time_of(std::size_t shot, const Block& block) const {
  const bool rolling = config_.mode == ScanMode::kRolling;
  return block.begin + Time{rolling ? block.shots[shot].dt_ns : 0};
}

/// Fills block.echoes with the detected echoes of a shot, in reporting order.
void Lidar::receive(const world::Surfaces& world, std::size_t shot, Block& block) const {
  block.echoes.clear();
  block.parts.clear();
  block.beyond.clear();
  for (std::size_t k = 0; k < sub_rays_.size(); ++k) {
    const auto part = receive_ray(world, shot, k, block);
    if (part) block.parts.push_back(*part);
    if (config_.noise.bounces > 0) look_beyond(world, shot, k, block);
  }
  if (sub_rays_.size() == 1 && block.parts.size() == 1) {
    block.echoes = block.parts;  // to the last bit what is_simple_ gives
  } else {
    merge_echoes(block.parts, config_.noise.beam.pulse_length_m, block.echoes);
  }
  std::size_t number = 0;
  std::erase_if(block.echoes, [&](const Echo& echo) {
    return !is_detected(echo, block.first_ray + shot, number++);
  });
  if (air_) add_air(shot, block);
  if (config_.noise.blooming.share > 0.0 && world.has_retroreflectors())
    add_halo(world, shot, block);
  choose_echoes(config_.returns, block.echoes);
}

/// Adds a return from nowhere in the world to the echoes, in the order of ranges, unless the pulse
/// of a stronger one covers it.
void Lidar::add_stray(std::size_t shot, double range, double energy, std::uint32_t kind,
                      Block& block) const {
  if (range < config_.min_range_m || range > config_.max_range_m) return;
  const double signal = signal_.signal(energy, range);
  const double pulse = config_.noise.beam.pulse_length_m;
  for (const Echo& echo : block.echoes) {
    if (std::abs(echo.range - range) <= pulse && echo.signal >= signal) return;
  }
  const Vector3f direction = block.rays[block.places[shot]].direction;
  const auto source = static_cast<std::uint32_t>(sub_rays_.size() + block.beyond.size());
  block.beyond.push_back({.direction = direction,
                          .distance = range - block.axis_to_origin,
                          .normal = -direction,
                          .triangle = kind});
  const auto behind = std::ranges::upper_bound(block.echoes, range, {}, &Echo::range);
  block.echoes.insert(behind, {range, energy, signal, source, true});
}

/// Adds the returns of the air before the farthest surface that the beam meets.
void Lidar::add_air(std::size_t shot, Block& block) const {
  double farthest = 0.0;
  for (std::size_t k = 0; k < sub_rays_.size(); ++k) {
    const world::Hit& hit = block.hits[block.places[shot] + k];
    const double range = static_cast<double>(hit.range) + block.axis_to_origin;
    farthest = std::max(farthest, hit.valid() ? range : config_.max_range_m);
  }
  block.air.clear();
  air_->add_returns(block.first_ray + shot, farthest, block.air);
  for (const Air::Return& found : block.air)
    add_stray(shot, found.range, found.energy, kAir, block);
}

/// Rays that sample the light which scatters beside a shot's beam.
void Lidar::aim_glare(std::size_t shot, Block& block) const {
  const BloomingConfig& blooming = config_.noise.blooming;
  const world::Ray& beam = block.rays[block.places[shot]];
  const std::uint64_t ray = block.first_ray + shot;
  const double spin = 2.0 * std::numbers::pi * glare_random_.uniform(ray, kGlareSpin);
  const double shift = glare_random_.uniform(ray, kGlareShift);
  block.glare.clear();
  for (int i = 0; i < blooming.rays; ++i) {
    const double angle =
        glare_angle(kDegree * blooming.half_angle_deg, (i + shift) / blooming.rays);
    if (angle > kWidestGlare) continue;
    const double turn = spin + i * kGoldenAngle;
    const Eigen::Vector2d offset =
        std::tan(angle) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
    const Vector3d direction = deflected(beam.direction.cast<double>(), offset);
    block.glare.push_back({beam.origin, direction.cast<float>()});
  }
  block.glare_hits.resize(block.glare.size());
}

/// Adds what retroreflectors beside a shot's beam return.
void Lidar::add_halo(const world::Surfaces& world, std::size_t shot, Block& block) const {
  const BloomingConfig& blooming = config_.noise.blooming;
  aim_glare(shot, block);
  world.cast_at(time_of(shot, block), block.glare, config_.max_range_m, block.glare_hits);
  block.parts.clear();
  for (std::size_t i = 0; i < block.glare.size(); ++i) {
    const world::Hit& hit = block.glare_hits[i];
    if (!hit.valid() || world.material(hit.triangle).retro == 0.0) continue;
    const double cosine = -static_cast<double>(hit.normal.dot(block.glare[i].direction));
    const double range = block.axis_to_origin + static_cast<double>(hit.range);
    const double share = blooming.share / blooming.rays / energy_of_ray_;
    block.parts.push_back(echo_of(world.material(hit.triangle), cosine, share, range, 0));
  }
  merge_echoes(block.parts, config_.noise.beam.pulse_length_m, block.halo);
  for (std::uint32_t i = 0; i < block.halo.size(); ++i) {
    const double probability = signal_.detection_probability(block.halo[i].signal);
    if (glare_random_.uniform(block.first_ray + shot, kGlareDetection + i) >= probability) continue;
    add_stray(shot, block.halo[i].range, block.halo[i].energy, kGhost, block);
  }
}

bool Lidar::is_detected(const Echo& echo, std::uint64_t ray, std::size_t number) const {
  if (!config_.noise.dropouts) return true;
  const double probability = signal_.detection_probability(echo.signal);
  return probability >= 1.0 || random_.uniform(ray, draw_of(kDetection, number)) < probability;
}

/// Range noise of an echo, in sigmas.
double Lidar::range_noise(const Echo& echo, std::size_t shot, std::size_t number,
                          const Block& block) const {
  const std::uint64_t ray = block.first_ray + shot;
  if (echo.is_stray) return stray_random_.normals(ray, echo.sub_ray)[0];
  if (number > 0) return random_.normals(ray / 2, draw_of(kRange, number))[ray % 2];
  const std::uint64_t pair = ray / 2 - block.first_ray / 2;
  return static_cast<double>(ray % 2 == 0 ? block.range_noise.first(pair)
                                          : block.range_noise.second(pair));
}

/// Bias of an echo by its channel and by the surface of its strongest part.
double Lidar::range_bias(const world::Surfaces& world, std::size_t shot, const Echo& echo,
                         const Block& block) const {
  const std::uint16_t ring = block.shots[shot].ring;
  if (echo.sub_ray >= sub_rays_.size()) {
    const Seen& beyond = block.beyond[echo.sub_ray - sub_rays_.size()];
    return bias_.range(ring, beyond.cosine, beyond.reflectivity);
  }
  const std::size_t place = block.places[shot] + echo.sub_ray;
  const world::Hit& hit = block.hits[place];
  const double cosine = -static_cast<double>(hit.normal.dot(block.rays[place].direction));
  return bias_.range(ring, cosine, world.material(hit.triangle).reflectivity);
}

double Lidar::measured_range(const Echo& echo, std::size_t shot, std::size_t number, double bias,
                             const Block& block) const {
  const double sigma = range_sigma(config_.range_noise_m, config_.noise, echo.range, echo.signal);
  double range = echo.range + bias;
  if (sigma > 0.0) range += sigma * range_noise(echo, shot, number, block);
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

/// Appends the point, and its truth, of the shot's echo `number`, whose range noise is `draw`.
void Lidar::report(const world::Surfaces& world, std::size_t shot, const Echo& echo,
                   std::size_t number, std::size_t draw, Block& block) const {
  const Beam& beam = block.shots[shot];
  const double bias =
      block.drift + (bias_.has_ranges() ? range_bias(world, shot, echo, block) : 0.0);
  const double distance = measured_range(echo, shot, draw, bias, block) - block.axis_to_origin;
  const bool raw = config_.returns.intensity == IntensityKind::kSignal;
  Point point;
  point.position = beam.origin + static_cast<float>(distance) * reported_direction(shot, block);
  point.intensity = static_cast<float>(raw ? echo.signal : std::min(255.0, 255.0 * echo.energy));
  point.dt_ns = has_own_times(config_.mode) ? clock_.elapsed(beam.dt_ns) : 0;
  point.ring = beam.ring;
  point.echo = static_cast<std::uint8_t>(number);
  block.points[block.count++] = point;
  if (block.truth != nullptr) block.truth[block.count - 1] = truth_of(shot, echo, block);
}

/// Appends a point at the origin for a shot without a return. Its truth is that of a ghost.
void Lidar::report_miss(std::size_t shot, Block& block) const {
  constexpr float kNearly = 1e-6F;  // m; readers take zeros for no return
  const Beam& beam = block.shots[shot];
  Point point;
  point.position = kNearly * beam.direction;
  point.dt_ns = has_own_times(config_.mode) ? clock_.elapsed(beam.dt_ns) : 0;
  point.ring = beam.ring;
  block.points[block.count++] = point;
  if (block.truth == nullptr) return;
  const world::Ray& ray = block.rays[block.places[shot]];
  block.truth[block.count - 1] = {.position = ray.origin.cast<float>(),
                                  .range = 0.0F,
                                  .normal = -ray.direction,
                                  .triangle = kGhost};
}

/// What the strongest part of an echo is of.
PointTruth Lidar::truth_of(std::size_t shot, const Echo& echo, const Block& block) const {
  const bool is_direct = echo.sub_ray < sub_rays_.size();
  const std::size_t place = block.places[shot] + (is_direct ? echo.sub_ray : 0);
  const world::Ray& ray = block.rays[place];
  const world::Hit& hit = block.hits[place];
  const Seen surface =
      is_direct ? Seen{ray.direction, static_cast<double>(hit.range), hit.normal, hit.triangle}
                : block.beyond[echo.sub_ray - sub_rays_.size()];
  const Vector3d to_surface = surface.distance * surface.direction.cast<double>();
  return {
      .position = (ray.origin + to_surface).cast<float>(),
      .range = static_cast<float>(block.axis_to_origin + surface.distance + start_offset(config_)),
      .normal = surface.normal,
      .triangle = surface.triangle};
}

/// Makes points of the hits of the block.
void Lidar::collect(const world::Surfaces& world, Block& block) const {
  for (std::size_t shot = 0; shot < block.shots.size(); ++shot) {
    if (config_.shape.clip && !contains(*config_.shape.clip, block.shots[shot].direction)) continue;
    block.axis_to_origin = static_cast<double>(block.shots[shot].origin.norm());
    if (is_simple_) {
      const auto echo = receive_ray(world, shot, 0, block);
      if (echo && is_detected(*echo, block.first_ray + shot, 0))
        report(world, shot, *echo, 0, 0, block);
      else if (config_.returns.misses == MissedShots::kOrigin)
        report_miss(shot, block);
      continue;
    }
    receive(world, shot, block);
    if (block.echoes.empty() && config_.returns.misses == MissedShots::kOrigin)
      report_miss(shot, block);
    std::size_t of_world = 0;
    for (std::size_t k = 0; k < block.echoes.size(); ++k) {
      const Echo& echo = block.echoes[k];
      report(world, shot, echo, k, echo.is_stray ? 0 : of_world++, block);
    }
  }
}

}  // namespace lidarena::sensor
