// SPDX-License-Identifier: BSD-3-Clause
// Define a sensor: eight lasers on a spinning head, in a cube of 6 m.
// usage: example_03_own_sensor
#include <cmath>
#include <cstdio>

#include "lidarena/sensor/lidar.hpp"
#include "lidarena/world/primitives.hpp"
#include "lidarena/world/world.hpp"

namespace {

/// A flight that stays at the origin.
class StaticFlight : public lidarena::flight::Flight {
 public:
  lidarena::flight::Motion at(lidarena::Time) const override { return {}; }
  lidarena::Time duration() const override { return std::chrono::seconds(1); }
};

}  // namespace

int main() {
  using namespace lidarena;
  sensor::SensorConfig sensor;  // or load_sensor("my_sensor.yaml"); the keys are the same
  sensor.name = "mine";
  sensor.model = sensor::LidarModel::kBeamTable;
  sensor.columns = 360;
  sensor.rate_hz = 10.0;
  sensor.max_range_m = 30.0;
  sensor.range_noise_m = 0.01;
  sensor.beam_table.emplace();
  for (int elevation = -14; elevation < 18; elevation += 4) {
    sensor.beam_table->beams.emplace_back().elevation_deg = elevation;
  }

  const world::World room(world::box_shape({6.0, 6.0, 6.0}), "room");
  const sensor::Lidar lidar(sensor, sensor::make_pattern(sensor), sensor.name, 1, true);
  std::vector<PointTruth> truth;
  const Scan scan = lidar.measure(room, StaticFlight(), 0, Parallel(), &truth);
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    squares += std::pow(static_cast<double>(scan.points[i].position.norm() - truth[i].range), 2);
  }
  const double rms = std::sqrt(squares / static_cast<double>(truth.size()));
  std::printf("%zu of %d shots gave a return, RMS range error %.2f cm\n", scan.points.size(),
              8 * 360, 100.0 * rms);
  return std::abs(rms - sensor.range_noise_m) < 0.001 ? 0 : 1;
}
