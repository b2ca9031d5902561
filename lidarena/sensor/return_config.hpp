// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>

#include "lidarena/base/config.hpp"

namespace lidarena {

/// What a data sheet says of the light that comes back, see SignalModel. Ranges of zero: nothing is
/// known, and nothing that needs it can be switched on.
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
    v("detection", self.detection, "", "share of shots that return at a rated range",
      between(0.01, 0.9999));
    v("false_alarms", self.false_alarms, "", "share of shots that would return without an echo",
      between(1e-9, 0.1));
  }
};

/// A beam with a Gaussian profile, followed by sub-rays of equal energy.
struct BeamConfig {
  int sub_rays = 1;
  double width_deg = 0.0;
  double height_deg = 0.0;
  double pulse_length_m = 0.5;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("sub_rays", self.sub_rays, "", "rays that a beam is split into; 1 = a line without width",
      between(1, 64));
    v("width_deg", self.width_deg, "deg", "full width at half maximum, horizontally",
      between(0, 10));
    v("height_deg", self.height_deg, "deg", "full width at half maximum, vertically",
      between(0, 10));
    v("pulse_length_m", self.pulse_length_m, "m",
      "surfaces nearer to one another than this make one mixed echo", above(0));
  }
};

/// How the measurements differ from the geometry, besides range_noise_m. Each part is off by
/// default.
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

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("near_range_noise_m", self.near_range_noise_m, "m",
      "sigma of the range noise up to near_range_m, 0 = as elsewhere", at_least(0));
    v("near_range_m", self.near_range_m, "m", "from here the sigma falls", at_least(0));
    v("near_until_m", self.near_until_m, "m", "to range_noise_m here", above(0));
    v("angle_noise_deg", self.angle_noise_deg, "deg",
      "sigma of the direction in which a point is reported, horizontally and vertically",
      at_least(0));
    v("range_step_m", self.range_step_m, "m", "ranges are rounded to this, 0 = not", at_least(0));
    v("weak_signal_noise", self.weak_signal_noise, "",
      "the range noise grows where the signal is weaker than at the rated range");
    v("dropouts", self.dropouts, "", "weak echoes are missed; needs signal");
    v("signal", self.signal, "", "what the data sheet says of weak signals");
    v("beam", self.beam, "", "width of the beam, for mixed pixels and further echoes");
  }
};

enum class EchoChoice { kStrongest, kFirst, kLast };
template <>
struct EnumNames<EchoChoice> {
  static constexpr std::array names{std::pair{"strongest", EchoChoice::kStrongest},
                                    std::pair{"first", EchoChoice::kFirst},
                                    std::pair{"last", EchoChoice::kLast}};
};

enum class IntensityKind { kReflectivity, kSignal };
template <>
struct EnumNames<IntensityKind> {
  static constexpr std::array names{std::pair{"reflectivity", IntensityKind::kReflectivity},
                                    std::pair{"signal", IntensityKind::kSignal}};
};

/// What is reported of a shot's echoes. More than one need a beam of several sub-rays.
struct ReturnConfig {
  EchoChoice choice = EchoChoice::kStrongest;
  int count = 1;
  IntensityKind intensity = IntensityKind::kReflectivity;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("choice", self.choice, "", "strongest, first or last: the echoes that come first");
    v("count", self.count, "", "most echoes reported of a shot", between(1, 5));
    v("intensity", self.intensity, "",
      "reflectivity: 255 for white, range taken out; signal: as received, 1 for a 10 % target at "
      "its rated range");
  }
};

/// Throws InputError (place `place`) when the parts do not fit together.
void check_returns(const NoiseConfig& noise, const ReturnConfig& returns, const std::string& place);

}  // namespace lidarena
