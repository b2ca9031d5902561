// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"

/// Errors that data sheets do not state, and what a recording says where it differs from what is
/// so. Each is off by default and draws from a random stream of its own.
namespace lidarena::sensor {

/// Errors of a LiDAR's ranges and directions that do not average out, see LidarBias. Sources:
/// Glennie, Lichti, "Static calibration and analysis of the Velodyne HDL-64E S2" (Remote Sensing
/// 2010) for those of unit and channel; Laconte et al., "Lidar measurement bias estimation via
/// return waveform modelling" (ICRA 2019) for incidence; Pomerleau et al., "Noise characterization
/// of depth sensors for surface inspections" (CARPI 2012) for reflectivity.
struct BiasConfig {
  double unit_m = 0.0;
  double channel_m = 0.0;
  double incidence_m = 0.0;
  double reflectivity_m = 0.0;
  double direction_deg = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("unit_m", self.unit_m, "m", "sigma of the bias of all ranges, drawn once from the seed",
      at_least(0));
    v("channel_m", self.channel_m, "m",
      "sigma of the bias of each channel's ranges, drawn once from the seed", at_least(0));
    v("incidence_m", self.incidence_m, "m",
      "bias of a range at 60 deg incidence; 0 at normal incidence, growing as 1 / cos - 1");
    v("reflectivity_m", self.reflectivity_m, "m",
      "bias of a 5 % target against a 50 % one, proportional to the logarithm of reflectivity");
    v("direction_deg", self.direction_deg, "deg",
      "sigma of the error of each channel's direction, horizontally and vertically, drawn once",
      between(0, 1));
  }
};

/// Drift of all ranges while the sensor's temperature changes, see range_drift(). Sources: Ye,
/// Borenstein, "Characterization of a 2-D laser scanner" (ICRA 2002), Kneip et al.,
/// "Characterization of the compact Hokuyo URG-04LX" (ICRA 2009): ranges settle within an hour or
/// more from switching on; Glennie, Lichti, "Temporal stability of the Velodyne HDL-64E S2" (Remote
/// Sensing 2011) for the temperature.
struct DriftConfig {
  double warm_up_m = 0.0;
  double on_for_s = 0.0;
  double per_kelvin_m = 0.0;
  double change_k = 0.0;
  double time_constant_s = 1200.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("warm_up_m", self.warm_up_m, "m", "bias of all ranges when the LiDAR is switched on");
    v("on_for_s", self.on_for_s, "s", "time from switching on to the start of the flight",
      at_least(0));
    v("per_kelvin_m", self.per_kelvin_m, "m/K", "change of all ranges with temperature");
    v("change_k", self.change_k, "K",
      "step of the air's temperature at the start of the flight, which the LiDAR follows");
    v("time_constant_s", self.time_constant_s, "s", "of the LiDAR's temperature", above(0));
  }
};

/// What is in the air, see Air. Fog, dust: Rasshofer et al. 2011, Hahner et al. 2021; rain:
/// Marshall, Palmer 1948. The lidar ratio of fog is theirs (ln(20) / 0.046); dust has 40 to 60 sr
/// (Tesche et al., "Vertically resolved separation of dust and smoke", 2009).
struct AirConfig {
  double visibility_m = 0.0;
  double lidar_ratio_sr = 65.0;
  double rain_mm_h = 0.0;
  double overlap_m = 1.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("visibility_m", self.visibility_m, "m",
      "meteorological optical range in fog or dust, 0 = clear; dense fog: 50", at_least(0));
    v("lidar_ratio_sr", self.lidar_ratio_sr, "sr",
      "extinction / backscatter of the particles; fog 65, dust 50", between(5, 200));
    v("rain_mm_h", self.rain_mm_h, "mm/h", "rain; heavy rain: 25", between(0, 200));
    v("overlap_m", self.overlap_m, "m",
      "range from which the receiver sees all of the beam; nothing of the air below 0.9 of it",
      between(0, 20));
  }
};

/// Light that scatters within the LiDAR: a small share of each beam goes to directions beside it,
/// and comes back from there. Retroreflectors return enough of it to be seen (blooming, glare). See
/// glare_angle().
struct BloomingConfig {
  double share = 0.0;
  double half_angle_deg = 1.5;
  int rays = 8;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("share", self.share, "", "share of the light that scatters, e.g. 0.005", between(0, 0.5));
    v("half_angle_deg", self.half_angle_deg, "deg", "half of that light is within this angle",
      between(0.01, 20));
    v("rays", self.rays, "", "number of rays per shot that sample it", between(1, 64));
  }
};

/// The clock of a LiDAR against true time, see SensorClock.
struct ClockConfig {
  double offset_s = 0.0;
  double drift = 0.0;
  double stamp_jitter_s = 0.0;
  bool imu_shares = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("offset_s", self.offset_s, "s", "reading of the LiDAR's clock at the start of the flight",
      between(0, 1));
    v("drift", self.drift, "", "how much faster than true time the clock runs, e.g. 2.0e-5",
      between(-0.01, 0.01));
    v("stamp_jitter_s", self.stamp_jitter_s, "s",
      "sigma of the error of each scan's stamp, limited to 0.45 of the scan's period", at_least(0));
    v("imu_shares", self.imu_shares, "",
      "true: the IMU's stamps have the same offset and drift; false: they are in true time");
  }
};

/// Vibration with a continuous spectrum that follows the rotors' speed, see Vibration. The
/// amplitudes grow with thrust; the rotors' frequency grows with its square root.
struct BroadbandConfig {
  Eigen::Vector3d accel_rms = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_rms = Eigen::Vector3d::Zero();
  double rotor_hz = 126.3;
  int blades = 2;
  double spread = 0.05;
  double floor_share = 0.3;
  double low_hz = 10.0;
  double high_hz = 500.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("accel_rms", self.accel_rms, "m/s^2", "RMS x y z in hover", at_least(0));
    v("gyro_rms", self.gyro_rms, "rad/s", "RMS x y z in hover", at_least(0));
    v("rotor_hz", self.rotor_hz, "Hz", "revolutions per second of the rotors in hover", above(0));
    v("blades", self.blades, "", "blades of a rotor", between(1, 12));
    v("spread", self.spread, "",
      "relative width (sigma) of the peaks at the rotors' and the blades' frequency",
      between(0.01, 1));
    v("floor_share", self.floor_share, "",
      "share of the variance that is spread evenly over the band; each peak has half of the rest",
      between(0, 1));
    v("low_hz", self.low_hz, "Hz", "lower end of the band", above(0));
    v("high_hz", self.high_hz, "Hz", "upper end of the band", between(1, 2000));
  }
};

/// What the recording and its rig tell the methods, where it differs from what is so.
struct ToldConfig {
  std::optional<Pose> lidar_from_imu;
  double noise_factor = 1.0;
  double bias_walk_factor = 1.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("lidar_from_imu", self.lidar_from_imu, "m, quaternion",
      "mounting of the IMU that methods get, x y z qx qy qz qw; they get the LiDAR's true one");
    v("noise_factor", self.noise_factor, "",
      "noise densities of the IMU that methods get / true ones", above(0));
    v("bias_walk_factor", self.bias_walk_factor, "",
      "random walks of the biases that methods get / true ones", above(0));
  }
};

}  // namespace lidarena::sensor
