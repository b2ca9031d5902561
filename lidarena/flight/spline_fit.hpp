// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace lidarena::flight {

/// Number of samples on either side of a control point that controls_through() uses.
inline constexpr std::size_t kFitReach = 3;

/// Control points of a uniform B-spline of degree D (at most 6) that approximates samples taken at
/// the centers of its control points: control point j belongs to sample j + kFitReach. A local
/// quasi-interpolant (de Boor, "A Practical Guide to Splines", ch. XII): polynomials up to degree D
/// are reproduced, other smooth functions with an error of order D + 1 in the knot spacing.
///
/// The spline's weights attenuate the frequency w (rad per knot) by sinc(w/2)^(D+1). The series of
/// the inverse in s = 4 sin^2(w/2), which as a filter is the negative second difference, is
/// truncated after s^3.
template <int D, class Value>
std::vector<Value> controls_through(const std::vector<Value>& samples) {
  static_assert(D <= 6);
  // sinc(w/2)^-(D+1) = 1 + a w^2 + b w^4 + c w^6 + ..., from the series of -log(sinc)
  constexpr double n = D + 1;
  constexpr double a = n / 24.0;
  constexpr double b = n / 2880.0 + a * a / 2.0;
  constexpr double c = n / 181440.0 + a * n / 2880.0 + a * a * a / 6.0;
  // w^2 = s + s^2/12 + s^3/90 + ...
  constexpr double s1 = a;
  constexpr double s2 = a / 12.0 + b;
  constexpr double s3 = a / 90.0 + b / 6.0 + c;
  // s, s^2 and s^3 applied to the samples are weighted sums of the samples at distances 0, 1, 2, 3
  constexpr double w0 = 1.0 + 2.0 * s1 + 6.0 * s2 + 20.0 * s3;
  constexpr double w1 = -s1 - 4.0 * s2 - 15.0 * s3;
  constexpr double w2 = s2 + 6.0 * s3;
  constexpr double w3 = -s3;
  std::vector<Value> controls;
  for (std::size_t i = kFitReach; i + kFitReach < samples.size(); ++i) {
    controls.push_back(w0 * samples[i] + w1 * (samples[i - 1] + samples[i + 1]) +
                       w2 * (samples[i - 2] + samples[i + 2]) +
                       w3 * (samples[i - 3] + samples[i + 3]));
  }
  return controls;
}

}  // namespace lidarena::flight
