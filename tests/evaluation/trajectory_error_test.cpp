// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flights.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::mapped;
using flights::sample;
using flights::tour;
using flights::with_gap;
using std::numbers::pi;

constexpr double kRounding = 1e-9;  // of lengths ~ 10 m, and of times in whole nanoseconds at 1 m/s

/// 1 m/s along x.
Pose line(double t) { return level({t, 0, 0}); }

TEST(RelativePoseError, OfATrajectoryWithItselfIsZero) {
  const Trajectory truth = sample(tour, 10ms, 30s);
  const RelativePoseError rpe = relative_pose_error(truth, truth);
  EXPECT_EQ(rpe.used, rpe.total);
  EXPECT_EQ(rpe.total, static_cast<std::size_t>(truth.path_length()));
  EXPECT_LT(rpe.translation_m.max, 1e-12);
  EXPECT_LT(rpe.rotation_rad.max, 1e-12);
}

TEST(RelativePoseError, OfASlowlySampledCopyIsTheInterpolationError) {
  // Linear interpolation over T is off by at most a T^2 / 8 at each end; a <= 1.3 m/s^2 here.
  const RelativePoseError rpe =
      relative_pose_error(sample(tour, 100ms, 30s), sample(tour, 1ms, 30s));
  EXPECT_LT(rpe.translation_m.max, 2.0 * 1.3 * 0.01 / 8.0);
  EXPECT_GT(rpe.translation_m.max, 0.0);
}

TEST(RelativePoseError, BetweenPosesASlowlySampledCopyHasNone) {
  const Trajectory truth = sample(tour, 1ms, 30s);
  for (const Time period : {Time(100ms), Time(300ms), Time(700ms)}) {
    const RelativePoseError rpe = relative_pose_error_at_poses(sample(tour, period, 30s), truth);
    EXPECT_GT(rpe.used, 10U);
    EXPECT_LT(rpe.translation_m.max, 1e-9) << period.count();
    EXPECT_LT(rpe.rotation_rad.max, 1e-9) << period.count();
  }
}

TEST(RelativePoseError, BetweenPosesOnePercentOfScaleIsOneCentimeterPerMeter) {
  const Trajectory truth = sample(line, 10ms, 20s);
  const auto scaled = [](double t) { return level({1.01 * t, 0, 0}); };
  for (const Time period : {Time(100ms), Time(300ms), Time(800ms)}) {
    const RelativePoseError rpe = relative_pose_error_at_poses(sample(scaled, period, 20s), truth);
    EXPECT_NEAR(rpe.translation_m.max, 0.01, kRounding);
    EXPECT_NEAR(rpe.translation_m.mean, 0.01, kRounding);
    for (const SegmentError& piece : rpe.segments) {
      EXPECT_EQ(piece.begin % period, Time{0});
      EXPECT_EQ(piece.end % period, Time{0});
    }
  }
}

TEST(RelativePoseError, BetweenPosesTooSeldomForAMeterThePiecesAreLonger) {
  // At 1 m/s with a pose every 3 s: of three pieces only one has ends at different poses.
  const Trajectory truth = sample(line, 10ms, 30s);
  const RelativePoseError rpe = relative_pose_error_at_poses(sample(line, 3s, 30s), truth);
  EXPECT_EQ(rpe.total, 30U);
  EXPECT_EQ(rpe.used, 10U);
  for (const SegmentError& piece : rpe.segments) EXPECT_EQ(piece.end - piece.begin, Time(3s));
}

TEST(RelativePoseError, BetweenPosesNothingIsTakenAcrossAGap) {
  const Trajectory truth = sample(line, 10ms, 20s);
  const Trajectory estimate = with_gap(sample(line, 100ms, 20s), 5500ms, 8250ms);
  const RelativePoseError rpe = relative_pose_error_at_poses(estimate, truth);
  EXPECT_EQ(rpe.total, 20U);
  EXPECT_EQ(rpe.used, 16U);  // those that begin or end between 5.5 and 8.25 m are dropped
  EXPECT_LT(rpe.translation_m.max, kRounding);
}

TEST(RelativePoseError, OnePercentOfScaleIsOneCentimeterPerMeter) {
  const Trajectory truth = sample(line, 10ms, 20s);
  const Trajectory estimate = sample([](double t) { return level({1.01 * t, 0, 0}); }, 100ms, 20s);
  for (const double length : kRpeLengths_m) {
    const RelativePoseError rpe = relative_pose_error(estimate, truth, length, length);
    EXPECT_EQ(rpe.total, static_cast<std::size_t>(20.0 / length));
    EXPECT_EQ(rpe.used, rpe.total);
    if (rpe.total == 0) continue;
    EXPECT_NEAR(rpe.translation_m.rmse, 0.01 * length, kRounding);
    EXPECT_NEAR(rpe.translation_m.max, 0.01 * length, kRounding);
    EXPECT_LT(rpe.rotation_rad.max, kRounding);
  }
}

TEST(RelativePoseError, SlidingSegmentsStartEveryStep) {
  const Trajectory truth = sample(line, 10ms, 20s);
  const RelativePoseError rpe = relative_pose_error(truth, truth, 1.0, 0.1);
  EXPECT_EQ(rpe.total, 191U);
  EXPECT_EQ(rpe.segments.at(7).begin, Time(700ms));
  EXPECT_EQ(rpe.segments.at(7).end, Time(1700ms));
}

TEST(RelativePoseError, AHeadingThatDriftsTurnsTheChordSeenFromTheStart) {
  // The estimate yaws w rad per meter more than the truth: over [s, s + 1] the rotation error is w,
  // and the chord, seen from the start frame, is rotated by w s: 2 sin(w s / 2).
  const double w = 0.03;
  const Trajectory truth = sample(line, 10ms, 20s);
  const Trajectory estimate = mapped(sample(line, 100ms, 20s), [&](const StampedPose& pose) {
    const double s = pose.world_from_body.translation().x();
    return make_pose(so3::exp({0, 0, w * s}), pose.world_from_body.translation());
  });
  const RelativePoseError rpe = relative_pose_error(estimate, truth);
  ASSERT_EQ(rpe.used, 20U);
  for (std::size_t k = 0; k < rpe.used; ++k) {
    EXPECT_NEAR(rpe.segments[k].rotation_rad, w, kRounding);
    EXPECT_NEAR(rpe.segments[k].translation_m, 2.0 * std::sin(w * static_cast<double>(k) / 2.0),
                kRounding);
  }
}

TEST(RelativePoseError, ALeverArmShowsOnlyWhereTheBodyTurns) {
  // Q flies a line yawing at w; P = Q * lever: error 2 |lever| sin(w / 2) per second and meter.
  const double w = 0.5;
  const double lever = 0.3;
  const auto turning = [&](double t) {
    return make_pose(so3::exp({0, 0, w * t}), Vector3d(t, 0, 0));
  };
  const Trajectory truth = sample(turning, 10ms, 20s);
  const auto with_lever = [&](const StampedPose& pose) {
    return pose.world_from_body * level({0.0, lever, 0.7});  // 0.7 m along the axis have no effect
  };
  const RelativePoseError turned =
      relative_pose_error(mapped(sample(turning, 100ms, 20s), with_lever), truth);
  EXPECT_NEAR(turned.translation_m.rmse, 2.0 * lever * std::sin(w / 2.0), kRounding);
  EXPECT_LT(turned.rotation_rad.max, kRounding);
  const Trajectory straight = sample(line, 10ms, 20s);
  EXPECT_LT(relative_pose_error(mapped(straight, with_lever), straight).translation_m.max,
            kRounding);
}

TEST(RelativePoseError, AMountingTurnedByAConstantAngleTurnsEveryChord) {
  const double angle = 0.2;
  const Trajectory truth = sample(line, 10ms, 20s);
  const Trajectory estimate = mapped(truth, [&](const StampedPose& pose) {
    return pose.world_from_body * make_pose(so3::exp({0, 0, angle}), Vector3d::Zero());
  });
  const RelativePoseError rpe = relative_pose_error(estimate, truth);
  EXPECT_NEAR(rpe.translation_m.rmse, 2.0 * std::sin(angle / 2.0), kRounding);
  EXPECT_LT(rpe.rotation_rad.max, kRounding);
}

TEST(RelativePoseError, DoesNotDependOnEitherWorldFrame) {
  SequentialRandom random(5);
  const Trajectory truth = sample(tour, 10ms, 30s);
  const Trajectory estimate = mapped(sample(tour, 100ms, 30s), [](const StampedPose& pose) {
    const double t = to_seconds(pose.stamp);
    return make_pose(so3::exp({0.01 * t, 0, 0.02 * t}), Vector3d(0.02 * t, 0, 0.01 * t)) *
           pose.world_from_body;
  });
  const RelativePoseError here = relative_pose_error(estimate, truth);
  const auto put = [](const Trajectory& trajectory, const Pose& a_from_b) {
    return mapped(trajectory, [&](const StampedPose& p) { return a_from_b * p.world_from_body; });
  };
  const RelativePoseError there = relative_pose_error(
      put(estimate, flights::random_pose(random, 9)), put(truth, flights::random_pose(random, 9)));
  ASSERT_EQ(here.used, there.used);
  ASSERT_GT(here.used, 20U);
  for (std::size_t k = 0; k < here.used; ++k) {
    // another frame rounds the arc length differently, so an end may move by a nanosecond
    EXPECT_NEAR(here.segments[k].translation_m, there.segments[k].translation_m, kRounding);
    EXPECT_NEAR(here.segments[k].rotation_rad, there.segments[k].rotation_rad, kRounding);
  }
}

TEST(RelativePoseError, NeverInterpolatesAcrossATrackingLoss) {
  // 1 m/s; estimates between 5.3 and 8.3 s are missing: pieces that start or end there are dropped.
  const Trajectory truth = sample(line, 10ms, 20s);
  const Trajectory whole = sample([](double t) { return level({1.01 * t, 0, 0}); }, 100ms, 20s);
  const Trajectory lost = mapped(with_gap(whole, 5300ms, 8300ms), [](const StampedPose& pose) {
    // after the gap it is 2 m off, which must not affect any piece
    const Vector3d jump(pose.stamp > 6s ? 2.0 : 0.0, 0, 0);
    return level(pose.world_from_body.translation() + jump);
  });
  const RelativePoseError rpe = relative_pose_error(lost, truth);
  EXPECT_EQ(rpe.total, 20U);
  EXPECT_EQ(rpe.used, 16U);  // not 5-6, 6-7, 7-8, 8-9
  EXPECT_NEAR(rpe.translation_m.max, 0.01, kRounding);
  const RelativePoseError truth_lost = relative_pose_error(whole, with_gap(truth, 5300ms, 8300ms));
  EXPECT_EQ(truth_lost.total, 20U);
  EXPECT_EQ(truth_lost.used, 16U);
}

TEST(RelativePoseError, AHoverHasNoMetersToScoreButHasSeconds) {
  const Trajectory truth = sample([](double) { return level({0, 0, 2}); }, 10ms, 10s);
  const Trajectory estimate = sample(
      [](double t) {
        return level({0.02 * std::sin(pi * t), 0, 2});
      },
      100ms, 10s);
  const RelativePoseError by_path = relative_pose_error(estimate, truth);
  EXPECT_EQ(by_path.total, 0U);
  EXPECT_EQ(by_path.used, 0U);
  EXPECT_EQ(by_path.translation_m.count, 0U);
  EXPECT_EQ(by_path.translation_m.rmse, 0.0);
  const RelativePoseError by_time = relative_pose_error_over_time(estimate, truth, 0.5, 0.5);
  EXPECT_EQ(by_time.used, 20U);
  // half a period of the jitter: from 0 to +-2 cm and back
  EXPECT_NEAR(by_time.translation_m.rmse, 0.02, kRounding);
}

TEST(RelativePoseError, LateStampsShowAsTheChangeOfVelocity) {
  // At acceleration a, an estimate that is late by dt is off by dt (v_end - v_begin) over each
  // piece.
  const double a = 0.6;
  const auto accelerating = [&](double t) { return level({0.5 * a * t * t, 0, 0}); };
  const Trajectory truth = sample(accelerating, 10ms, 10s);
  const Trajectory late = flights::shifted(sample(accelerating, 10ms, 10s), 50ms);
  const RelativePoseError rpe = relative_pose_error_over_time(late, truth, 1.0, 1.0);
  ASSERT_EQ(rpe.used, 9U);
  EXPECT_NEAR(rpe.translation_m.rmse, 0.05 * a * 1.0, kRounding);
}

TEST(RelativePoseError, OnACircleLateStampsTurnTheChord) {
  // Without rotation of the body: chord c = 2 r sin(w / 2) per second, rotated by w dt.
  const double w = 0.5;
  const double r = 2.0;
  const auto circle = [&](double t) {
    return level({r * std::cos(w * t), r * std::sin(w * t), 0});
  };
  const Trajectory truth = sample(circle, 10ms, 12s);
  const RelativePoseError rpe =
      relative_pose_error_over_time(flights::shifted(truth, 100ms), truth, 1.0, 1.0);
  ASSERT_EQ(rpe.used, 11U);
  const double chord = 2.0 * r * std::sin(w / 2.0);
  EXPECT_NEAR(rpe.translation_m.rmse, 2.0 * chord * std::sin(w * 0.1 / 2.0), kRounding);
}

TEST(RelativePoseError, LengthsThatAreNotPositiveAreRefused) {
  const Trajectory truth = sample(line, 100ms, 2s);
  EXPECT_THROW(relative_pose_error(truth, truth, 0.0, 1.0), InputError);
  EXPECT_THROW(relative_pose_error(truth, truth, 1.0, -1.0), InputError);
  EXPECT_THROW(relative_pose_error_over_time(truth, truth, std::nan(""), 1.0), InputError);
}

TEST(RelativePoseError, TrajectoriesThatDoNotMeetHaveNoSegments) {
  const Trajectory truth = sample(line, 100ms, 5s);
  EXPECT_EQ(relative_pose_error(flights::shifted(truth, 9s), truth).total, 0U);
  EXPECT_EQ(relative_pose_error(Trajectory(), truth).total, 0U);
  EXPECT_EQ(relative_pose_error_over_time(truth, Trajectory()).total, 0U);
}

TEST(AbsoluteTrajectoryError, DoesNotDependOnTheEstimatesWorldFrame) {
  SequentialRandom random(6);
  const Trajectory truth = sample(tour, 10ms, 30s);
  const Trajectory estimate = mapped(sample(tour, 100ms, 30s), [](const StampedPose& pose) {
    const double t = to_seconds(pose.stamp);
    return level({0.02 * t, 0.03 * std::sin(t), 0}) * pose.world_from_body;
  });
  const Pose elsewhere = flights::random_pose(random, 9);
  const Trajectory moved =
      mapped(estimate, [&](const StampedPose& pose) { return elsewhere * pose.world_from_body; });
  for (const AlignmentKind kind : {AlignmentKind::kFirstPose, AlignmentKind::kSe3}) {
    const AbsoluteTrajectoryError a = absolute_trajectory_error(estimate, truth, kind);
    const AbsoluteTrajectoryError b = absolute_trajectory_error(moved, truth, kind);
    EXPECT_NEAR(a.translation_m.rmse, b.translation_m.rmse, 1e-12);
    EXPECT_NEAR(a.rotation_rad.rmse, b.rotation_rad.rmse, 1e-12);
    EXPECT_GT(a.translation_m.rmse, 0.01);
  }
}

TEST(AbsoluteTrajectoryError, LateStampsOfASteadyFlightAreSpeedTimesDelay) {
  // 2 s of hover define the alignment, then 3 m/s along x; the estimate is 40 ms late.
  const auto start = [](double t) { return level({std::max(0.0, 3.0 * (t - 2.0)), 0, 0}); };
  const Trajectory truth = sample(start, 10ms, 12s);
  const Trajectory late = flights::shifted(truth, 40ms);
  const auto ate = absolute_trajectory_error(late, truth, AlignmentKind::kFirstPose);
  EXPECT_NEAR(ate.translation_m.max, 3.0 * 0.04, kRounding);
  EXPECT_NEAR(ate.translation_m.median, 3.0 * 0.04, kRounding);
  EXPECT_LT(ate.poses.front().translation_m, kRounding);
}

TEST(AbsoluteTrajectoryError, ARotationErrorFoldsBackBeyondHalfATurn) {
  const Trajectory truth = sample(tour, 100ms, 35s);
  const Trajectory estimate = mapped(truth, [](const StampedPose& pose) {
    const Pose turn = make_pose(so3::exp({0, 0, 0.1 * to_seconds(pose.stamp)}), Vector3d::Zero());
    return pose.world_from_body * turn;
  });
  const auto ate = absolute_trajectory_error(estimate, truth, AlignmentKind::kFirstPose);
  for (std::size_t i = 0; i < ate.poses.size(); ++i) {
    const double turned = 0.1 * to_seconds(ate.poses[i].stamp);
    EXPECT_NEAR(ate.poses[i].rotation_rad, std::min(turned, 2.0 * pi - turned), 1e-9);
  }
  EXPECT_GT(ate.rotation_rad.max, 3.13);
}

TEST(RelativePoseError, OfATurnInPlaceIsSeenByTheSecondAlone) {
  // zero path length; the estimate rotates 2 % too fast
  const auto spin = [](double rate) {
    return [rate](double t) { return make_pose(so3::exp({0, 0, rate * t}), Vector3d(1, 2, 3)); };
  };
  const Trajectory truth = sample(spin(1.0), 10ms, 20s);
  const Trajectory estimate = sample(spin(1.02), 100ms, 20s);
  EXPECT_EQ(relative_pose_error(estimate, truth).total, 0U);
  const RelativePoseError rpe = relative_pose_error_over_time(estimate, truth);
  EXPECT_EQ(rpe.used, 20U);
  EXPECT_NEAR(rpe.rotation_rad.rmse, 0.02, kRounding);
  EXPECT_NEAR(rpe.rotation_rad.max, 0.02, kRounding);
  EXPECT_LT(rpe.translation_m.max, kRounding);
  EXPECT_FALSE(
      absolute_trajectory_error(estimate, truth, AlignmentKind::kSe3).alignment.determined());
  const auto ate = absolute_trajectory_error(estimate, truth, AlignmentKind::kFirstPose);
  EXPECT_NEAR(ate.rotation_rad.max, 0.4, kRounding);
  EXPECT_LT(ate.translation_m.max, kRounding);
}

TEST(RelativePoseError, MotionsOfMoreThanHalfATurnAreComparedTheShortWay) {
  // 3.0 and 3.4 rad per second, below and above pi: they differ by 0.4 rad, not by 2 pi - 6.4
  const auto spin = [](double rate) {
    return [rate](double t) { return make_pose(so3::exp({0, rate * t, 0}), Vector3d::Zero()); };
  };
  const RelativePoseError rpe =
      relative_pose_error_over_time(sample(spin(3.4), 100ms, 10s), sample(spin(3.0), 10ms, 10s));
  EXPECT_EQ(rpe.used, 10U);
  EXPECT_NEAR(rpe.rotation_rad.max, 0.4, kRounding);
  EXPECT_NEAR(rpe.rotation_rad.rmse, 0.4, kRounding);
}

TEST(RelativePoseError, ADriftThatGrowsWithTheSquareOfTimeGrowsAlongTheLadder) {
  // x is too large by a t^2 / 2 at 1 m/s: over [s, s + L] by a (s L + L^2 / 2)
  const double a = 1e-3;
  const Trajectory truth = sample(line, 10ms, 100s);
  const Trajectory estimate = sample(
      [&](double t) {
        return level({t + 0.5 * a * t * t, 0, 0});
      },
      100ms, 100s);
  for (const double length : kRpeLengths_m) {
    const RelativePoseError rpe = relative_pose_error(estimate, truth, length, length);
    EXPECT_EQ(rpe.used, static_cast<std::size_t>(100.0 / length));
    const double last = 100.0 - length;
    EXPECT_NEAR(rpe.translation_m.max, a * (last * length + 0.5 * length * length), 1e-8);
    EXPECT_NEAR(rpe.translation_m.mean, a * 50.0 * length, 1e-8);
  }
}

TEST(AbsoluteTrajectoryError, OfARefusedAlignmentIsNoNumber) {
  const Trajectory flight = sample(line, 100ms, 10s);
  const auto ate = absolute_trajectory_error(flight, flight, AlignmentKind::kSe3);
  EXPECT_FALSE(ate.alignment.determined());
  EXPECT_EQ(ate.translation_m.count, 0U);
  EXPECT_TRUE(ate.poses.empty());
}

TEST(RpeAtBestOffset, OfAShiftedTrajectoryIsThatOfTheTrajectoryItself) {
  const Trajectory truth = flights::sample(flights::tour, 5ms, 30s);
  const Trajectory exact = flights::sample(flights::tour, 100ms, 30s);
  for (const Time late : {Time(50ms), Time(-37ms), Time(0ms)}) {
    const Trajectory estimate = flights::shifted(exact, late);
    const auto best = relative_pose_error_at_best_offset(estimate, truth);
    ASSERT_TRUE(best);
    EXPECT_NEAR(best->late_s, to_seconds(late), 1e-4);
    EXPECT_LT(best->rpe.translation_m.rmse, 1e-6);
    EXPECT_GE(best->rpe.used, 10U);
    const double as_stamped = relative_pose_error_at_poses(estimate, truth).translation_m.rmse;
    EXPECT_EQ(as_stamped > 1e-3, late != Time(0));
  }
}

TEST(RpeAtBestOffset, IsNotSearchedBeyondItsRange) {
  const Trajectory truth = flights::sample(flights::tour, 5ms, 30s);
  const Trajectory estimate = flights::shifted(flights::sample(flights::tour, 100ms, 30s), 150ms);
  const auto best = relative_pose_error_at_best_offset(estimate, truth);
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->late_s, 0.1, 1e-9);
  EXPECT_FALSE(relative_pose_error_at_best_offset(Trajectory(), truth));
}

}  // namespace
}  // namespace lidarena::evaluation
