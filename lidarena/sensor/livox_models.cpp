// SPDX-License-Identifier: BSD-3-Clause
// Design constants of the Livox patterns, found by fitting optical models to the tables published
// by the manufacturer (the tables are not part of this repository). Residuals: Mid-360, 800,000
// rows, none beyond the table's rounding to 0.01 deg; Mid-40 and Mid-70, 400,000 rows each, 1.4e-5
// deg. Only the Avia was not fitted here: it is taken from HELIOS++ and approximate.
#include <cmath>

#include "lidarena/sensor/livox.hpp"

namespace lidarena::sensor {
namespace {

/// Four emitters in a row along y whose tangents are equally spaced.
std::vector<Eigen::Vector3d> mid360_fan() {
  constexpr double kTanSpacing = 0.48 / 19.4;  // fitted; perhaps emitter pitch / focal length
  std::vector<Eigen::Vector3d> fan;
  for (int beam = 0; beam < 4; ++beam) {
    fan.push_back(Eigen::Vector3d(0.0, (beam - 1.5) * kTanSpacing, 1.0).normalized());
  }
  return fan;
}

/// Two wedges rotating at 7294 and -4664 rpm, optical axis along +x.
LivoxModel two_wedges(double glass_index, double tilt_1, double tilt_2, double tilt_3,
                      double tilt_4) {
  LivoxModel model;
  model.row_rate_hz = 100'000.0;
  model.emitters = {Eigen::Vector3d::UnitZ()};
  model.rotors = {{180.0, 0.43764, 1.0}, {180.0, -0.27984, 1.0}};
  model.surfaces = {make_surface(SurfaceKind::kIntoGlass, 0, tilt_1),
                    make_surface(SurfaceKind::kIntoAir, 0, tilt_2),
                    make_surface(SurfaceKind::kIntoGlass, 1, tilt_3),
                    make_surface(SurfaceKind::kIntoAir, 1, tilt_4)};
  model.glass_index = glass_index;
  model.repeat_groups = 3'000'000;  // 30 s: greatest common divisor of the speeds 2 rpm
  model.lidar_from_chain << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return model;
}

}  // namespace

LivoxModel livox_mid360() {
  constexpr int kA = 0;  // thin wedge and mirror, 10,945 rpm
  constexpr int kB = 1;  // thick wedge, 10,345 rpm: 10 rev/s slower than A, the vertical sweep
  LivoxModel model;
  model.row_rate_hz = 200'000.0;
  model.emitters = mid360_fan();
  model.rotors = {{90.0, -1.3134, 0.5}, {90.0, -1.2414, 1.0, 0.15, 0.072}};
  model.surfaces = {
      make_surface(SurfaceKind::kIntoGlass, kB, 10.0),
      make_surface(SurfaceKind::kIntoAir, kB, 29.0), make_surface(SurfaceKind::kIntoGlass, kA, 0.0),
      make_surface(SurfaceKind::kIntoAir, kA, 10.0), make_surface(SurfaceKind::kMirror, kA, 50.0)};
  model.glass_index = 1.9682;
  model.repeat_groups = 600'000;  // 12 s: 2189, 2069 and 120 whole revolutions (A, B, modulation)
  model.lidar_from_chain.setIdentity();
  return model;
}

LivoxModel livox_mid40() { return two_wedges(1.5089, 0.0, 18.0, -18.0, 0.0); }

LivoxModel livox_avia() {
  // Values from HELIOS++ (its scanner "livox-avia"), fitted there to data of one unit.
  constexpr double kGroupRate = 40'000.0;                                // Hz
  constexpr double kRotorRates[] = {-131.5463, 40.8032, 213.1611};       // Hz
  constexpr double kWedges[] = {30.8856, 29.7735, 3.1351};               // deg
  constexpr double kFanSines[] = {-0.0521607, -0.03237635, -0.01079672,  // along the vertical
                                  0.01079672, 0.03237635,  0.05300785};
  LivoxModel model;
  model.row_rate_hz = 6 * kGroupRate;
  for (const double sine : kFanSines) {
    model.emitters.emplace_back(0.0, sine, std::sqrt(1.0 - sine * sine));
  }
  for (int wedge = 0; wedge < 3; ++wedge) {  // tilted face first, then the perpendicular face
    model.rotors.push_back({180.0, 360.0 * kRotorRates[wedge] / kGroupRate, 0.0});
    model.surfaces.push_back(make_surface(SurfaceKind::kIntoGlass, wedge, kWedges[wedge]));
    model.surfaces.push_back(make_surface(SurfaceKind::kIntoAir, wedge, 0.0));
  }
  model.glass_index = 1.51;
  model.repeat_groups = 400'000'000;  // 10,000 s: greatest common divisor of the rates 0.0001 Hz
  model.lidar_from_chain << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return model;
}

LivoxModel livox_mid70() { return two_wedges(1.8144, 18.0, 0.0, 0.0, -18.0); }

}  // namespace lidarena::sensor
