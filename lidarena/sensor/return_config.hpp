// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/sensor/error_config.hpp"

namespace lidarena::sensor {

/// Data-sheet figures that determine the received signal, see SignalModel. A range of 0 means
/// unknown: options that need it cannot be switched on.
struct SignalConfig {
  double range_at_10_m = 0.0;
  double range_at_80_m = 0.0;
  double detection = 0.9;
  double false_alarms = 1e-4;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("range_at_10_m", self.range_at_10_m, "m", "rated range of a 10 % target, 0 if unknown",
      at_least(0));
    v("range_at_80_m", self.range_at_80_m, "m", "rated range of an 80 % target, 0 if unknown",
      at_least(0));
    v("detection", self.detection, "", "detection probability at a rated range",
      between(0.01, 0.9999));
    v("false_alarms", self.false_alarms, "",
      "probability of a detection without an echo (sets the threshold)", between(1e-9, 0.1));
  }
};

/// A beam with a Gaussian profile, sampled by sub-rays of equal energy.
struct BeamConfig {
  int sub_rays = 1;
  double width_deg = 0.0;
  double height_deg = 0.0;
  double pulse_length_m = 0.5;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("sub_rays", self.sub_rays, "", "number of rays that sample a beam; 1 = a beam without width",
      between(1, 64));
    v("width_deg", self.width_deg, "deg", "full width at half maximum, horizontally",
      between(0, 10));
    v("height_deg", self.height_deg, "deg", "full width at half maximum, vertically",
      between(0, 10));
    v("pulse_length_m", self.pulse_length_m, "m",
      "echoes closer together than this merge into one mixed echo", above(0));
  }
};

/// Measurement errors besides range_noise_m. Each is off by default.
struct NoiseConfig {
  double near_range_noise_m = 0.0;
  double near_range_m = 0.2;
  double near_until_m = 1.0;
  double angle_noise_deg = 0.0;
  double range_step_m = 0.0;
  bool weak_signal_noise = false;
  bool dropouts = false;
  SignalConfig signal;
  BeamConfig beam;
  BiasConfig bias{};
  ClockConfig clock{};
  DriftConfig drift{};
  int bounces = 0;
  AirConfig air{};
  BloomingConfig blooming{};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("near_range_noise_m", self.near_range_noise_m, "m",
      "sigma of the range noise up to near_range_m, 0 = range_noise_m", at_least(0));
    v("near_range_m", self.near_range_m, "m", "range from which the sigma falls linearly",
      at_least(0));
    v("near_until_m", self.near_until_m, "m",
      "range at which the sigma has fallen to range_noise_m", above(0));
    v("angle_noise_deg", self.angle_noise_deg, "deg",
      "sigma of the error of a point's reported direction, horizontally and vertically",
      at_least(0));
    v("range_step_m", self.range_step_m, "m",
      "ranges are rounded to multiples of this, 0 = no rounding", at_least(0));
    v("weak_signal_noise", self.weak_signal_noise, "",
      "the range noise grows where the signal is weaker than at the rated range");
    v("dropouts", self.dropouts, "", "weak echoes may be missed; needs signal");
    v("signal", self.signal, "", "data-sheet figures about weak signals");
    v("beam", self.beam, "", "width of the beam, for mixed pixels and multiple echoes");
    v("bias", self.bias, "", "errors of ranges and directions that do not average out");
    v("clock", self.clock, "", "errors of the LiDAR's clock; poses of the truth are at true time");
    v("drift", self.drift, "", "warm-up of the LiDAR, and its temperature");
    v("bounces", self.bounces, "",
      "surfaces that may mirror a ray or let it pass until it ends, 0 = it ends at the first one",
      between(0, 4));
    v("air", self.air, "", "fog, dust and rain; needs signal");
    v("blooming", self.blooming, "", "halos of retroreflectors; needs signal");
  }
};

enum class EchoChoice { kStrongest, kFirst, kLast };
constexpr auto enum_names(EchoChoice) {
  return std::array{std::pair{"strongest", EchoChoice::kStrongest},
                    std::pair{"first", EchoChoice::kFirst}, std::pair{"last", EchoChoice::kLast}};
}

/// What becomes of a shot without a return.
enum class MissedShots { kLeftOut, kOrigin };
constexpr auto enum_names(MissedShots) {
  return std::array{std::pair{"left_out", MissedShots::kLeftOut},
                    std::pair{"origin", MissedShots::kOrigin}};
}

enum class IntensityKind { kReflectivity, kSignal };
constexpr auto enum_names(IntensityKind) {
  return std::array{std::pair{"reflectivity", IntensityKind::kReflectivity},
                    std::pair{"signal", IntensityKind::kSignal}};
}

/// Which of a shot's echoes are reported. More than one requires a beam of several sub-rays.
struct ReturnConfig {
  EchoChoice choice = EchoChoice::kStrongest;
  int count = 1;
  IntensityKind intensity = IntensityKind::kReflectivity;
  MissedShots misses = MissedShots::kLeftOut;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("choice", self.choice, "", "which echoes are reported first: strongest, first or last");
    v("count", self.count, "", "maximum number of echoes reported per shot", between(1, 5));
    v("intensity", self.intensity, "",
      "reflectivity: 255 for white, independent of range; signal: as received, 1 for a 10 % target "
      "at its rated range");
    v("misses", self.misses, "",
      "left_out, or origin: a shot without a return is a point at the sensor's origin, as in an "
      "earlier simulator (to 1 um, since readers drop points of exactly zero)");
  }
};

/// Whether there is anything in the air.
inline bool has_particles(const AirConfig& air) {
  return air.visibility_m > 0.0 || air.rain_mm_h > 0.0;
}

/// Throws InputError (place `place`) if the settings contradict each other.
void check_returns(const NoiseConfig& noise, const ReturnConfig& returns, const std::string& place);

}  // namespace lidarena::sensor
