// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/air.hpp"
#include "lidarena/sensor/beam_table.hpp"
#include "lidarena/sensor/cast_order.hpp"
#include "lidarena/sensor/echoes.hpp"
#include "lidarena/sensor/lidar_bias.hpp"
#include "lidarena/sensor/scan_pattern.hpp"
#include "lidarena/sensor/sensor_clock.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/sensor/signal_model.hpp"
#include "lidarena/sensor/vibration.hpp"
#include "lidarena/world/surfaces.hpp"

namespace lidarena::sensor {

/// world_from_lidar at `dt_ns` after a scan's stamp.
using PoseAt = std::function<Pose(std::int32_t dt_ns)>;

/// Simulated LiDAR that moves through a world. measure() is const and its random numbers are keyed
/// by (seed, id, ray number), so scans are bit-identical in any order and on any number of threads.
class Lidar {
 public:
  /// Copies `config`; `id` is part of the noise's key. Without `noise`, ranges and directions are
  /// exact, beams have no width, and no echo is missed. Throws InputError (place: the sensor's
  /// name) when the noise settings contradict each other.
  Lidar(const SensorConfig& config, std::unique_ptr<ScanPattern> pattern, const std::string& id,
        std::uint64_t seed, bool noise);

  /// Scan `index`, which begins at index * period. The world is that of each shot's time, to 0.7 ms
  /// (1 mm of a person who walks). Each shot is cast from the pose at its own
  /// instant (see ScanMode), on which vibration acts if it moves the LiDAR; stamp and times are
  /// those of the LiDAR's clock. Shots without a return are left out (or see MissedShots). Ranges
  /// are measured from the sensor's axis (|beam origin| + distance along the beam); a return is
  /// kept if its true range is within the limits.
  ///
  /// The sub-rays of a beam are merged into echoes (merge_echoes). Each echo is detected or missed,
  /// depending on its signal; the detected ones are selected and numbered according to
  /// ReturnConfig. Then bias and range noise are added, the range is rounded, and the errors of
  /// the direction are added. `truth`, if given, receives what each point really hit, in point
  /// order; for a mixed echo, what the sub-ray with the strongest signal hit. Surfaces that are
  /// seen beyond others, the air and halos (NoiseConfig: bounces, air, blooming) give further
  /// echoes.
  Scan measure(const world::Surfaces& world, const flight::Flight& flight, std::uint64_t index,
               const Parallel& parallel, std::vector<PointTruth>* truth = nullptr) const;

  /// Appends the points of some shots of a scan to `points` (and `truth`). `first_ray` is the
  /// number of the first of `shots`, counted from the sensor's start. With this a scan can be
  /// simulated piece by piece while the world moves. Vibration is for the caller to add.
  void measure_part(const world::Surfaces& world, const PoseAt& world_from_lidar,
                    std::span<const Beam> shots, std::uint64_t first_ray,
                    std::vector<Point>& points, std::vector<PointTruth>* truth = nullptr) const;

  /// In mode frozen_ramp gives the points of scan `index`, of which there are N, the times
  /// i / N * length in their order; nothing in all other modes. The length is drawn for each scan,
  /// uniformly from 0.5 to 1.5 times `ramp_s`. Source: the Livox message of the plugin of Vultaggio
  /// et al. (fratopa/Mid360_simulation_plugin, commit 2a22a60), in which the length is ten times
  /// what a loop over the points took by the computer's clock, and so does not repeat.
  void put_ramp(std::uint64_t index, Scan& scan) const;

  /// Scan `index` with its stamp by the LiDAR's clock, without points.
  Scan empty_scan(std::uint64_t index) const;

  const ScanPattern& pattern() const { return *pattern_; }
  /// Beams of scan `index`; the span refers to `storage` or to the sensor's table.
  std::span<const Beam> beams(std::uint64_t index, std::vector<Beam>& storage) const {
    return table_.beams(index, storage);
  }
  const SensorConfig& config() const { return config_; }
  /// True instant at which scan `index` begins.
  Time begin(std::uint64_t index) const;
  /// The same by the LiDAR's clock: the scan's stamp.
  Time stamp(std::uint64_t index) const { return clock_.stamp(index, begin(index)); }
  /// Instant, by the LiDAR's clock, of the last firing of scan `index`, whether or not its points
  /// carry times; or of its last point, if that has a later time.
  Time last_firing(std::uint64_t index) const;

 private:
  struct Block;
  struct Seen;
  void place_rays(Block& block) const;
  void aim(const PoseAt& world_from_lidar, Block& block) const;
  std::optional<Echo> receive_ray(const world::Surfaces& world, std::size_t shot, std::size_t k,
                                  const Block& block) const;
  Echo echo_of(const world::Material& material, double cosine, double share, double range,
               std::uint32_t source) const;
  void look_beyond(const world::Surfaces& world, std::size_t shot, std::size_t k,
                   Block& block) const;
  Time time_of(std::size_t shot, const Block& block) const;
  double share_on_the_way(const world::Material& material, double cosine, double range) const;
  PointTruth truth_of(std::size_t shot, const Echo& echo, const Block& block) const;
  void receive(const world::Surfaces& world, std::size_t shot, Block& block) const;
  void report(const world::Surfaces& world, std::size_t shot, const Echo& echo, std::size_t number,
              std::size_t draw, Block& block) const;
  void report_miss(std::size_t shot, Block& block) const;
  double ramp(std::uint64_t index) const;
  void shoot(const world::Surfaces& world, const PoseAt& world_from_lidar, Block& block) const;
  void shoot_all(const world::Surfaces& world, const PoseAt& world_from_lidar, Time begin,
                 std::span<const Beam> shots, std::uint64_t first_ray, const Parallel& parallel,
                 std::vector<Point>& points, std::vector<PointTruth>* truth) const;
  void cast(const world::Surfaces& world, Block& block) const;
  void collect(const world::Surfaces& world, Block& block) const;
  bool is_detected(const Echo& echo, std::uint64_t ray, std::size_t number) const;
  void draw_noise(Block& block) const;
  void add_stray(std::size_t shot, double range, double energy, std::uint32_t kind,
                 Block& block) const;
  void add_air(std::size_t shot, Block& block) const;
  void add_halo(const world::Surfaces& world, std::size_t shot, Block& block) const;
  void aim_glare(std::size_t shot, Block& block) const;
  double range_noise(const Echo& echo, std::size_t shot, std::size_t number,
                     const Block& block) const;
  double measured_range(const Echo& echo, std::size_t shot, std::size_t number, double bias,
                        const Block& block) const;
  double range_bias(const world::Surfaces& world, std::size_t shot, const Echo& echo,
                    const Block& block) const;
  Eigen::Vector3f reported_direction(std::size_t shot, const Block& block) const;

  SensorConfig config_;
  std::unique_ptr<ScanPattern> pattern_;
  CounterRandom random_;
  SensorClock clock_;
  LidarBias bias_;
  std::optional<Vibration> vibration_;  ///< if it moves the LiDAR
  SignalModel signal_;
  CounterRandom stray_random_;  ///< noise of the ranges of strays
  std::optional<Air> air_;      ///< if there is anything in it
  CounterRandom glare_random_;
  CounterRandom ramp_random_;              ///< by scan
  std::vector<Eigen::Vector2d> sub_rays_;  ///< offsets in sigmas of the beam profile
  Eigen::Vector2d beam_sigma_;             ///< rad, horizontally and vertically
  double energy_of_ray_;                   ///< of a sub-ray, as share of the beam's energy
  float angle_sigma_;                      ///< rad
  bool has_range_noise_ = false;
  bool needs_signal_ = false;
  bool is_simple_ = true;  ///< a shot has one ray, which ends at the first surface
  BeamTable table_;
  CastOrder order_;
  std::size_t shots_per_block_;
  std::int32_t last_dt_ns_ = 0;
};

}  // namespace lidarena::sensor
