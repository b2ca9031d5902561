// SPDX-License-Identifier: BSD-3-Clause
// Results of other tools on the same trajectories, where their definitions agree with ours.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "flights.hpp"
#include "lidarena/base/angle.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"
#include "lidarena/evaluation/diagnosis/suspicion.hpp"
#include "lidarena/evaluation/diagnosis/time_offset.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"
#include "tum_text.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;

using tum_text::shared;
using tum_text::test_data;

/// Small synthetic trajectories and the results of evo v1.36.5 for them.
class EvoFigures : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream in(test_data("evo/evo_figures.json"));
    document_ = Json::parse(in);
  }
  Trajectory trajectory(const std::string& name) const {
    return tum_text::parse(document_["files"][name].get<std::string>());
  }
  /// RMSE that evo printed for `command`; fails the test if it is missing.
  double rmse(const std::string& command) const {
    for (const Json& run : document_["runs"]) {
      if (run["command"] == command) return run["stats"]["rmse"];
    }
    ADD_FAILURE() << "evo_figures.json has no result for " << command;
    return std::nan("");
  }
  /// evo pairs each pose of the estimate with the nearest stamp of the reference, 13 ms earlier;
  /// with equal stamps the nearest and the interpolated reference poses are the same.
  Trajectory uav_estimate_on_reference_stamps() const {
    return flights::shifted(trajectory("uav_est.tum"), -13ms);
  }

  Json document_;
};

/// Frobenius norm of R - I for a rotation by `angle`.
double frobenius(double angle) { return 2.0 * std::sqrt(2.0) * std::sin(0.5 * angle); }

template <class Errors, class Value>
double rms_of(const Errors& errors, Value value) {
  double sum = 0.0;
  for (const auto& error : errors) sum += std::pow(value(error), 2);
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

// The inputs have 6 decimals (quaternions 9), which both tools read as the same numbers; 1e-7
// covers evo's quaternions, which it does not normalize (1e-9 off).
constexpr double kSame = 1e-7;

TEST_F(EvoFigures, RotationErrorAfterSe3AlignmentAndFromTheOriginIsTheSame) {
  const Trajectory truth = trajectory("uav_ref.tum");
  const Trajectory estimate = uav_estimate_on_reference_stamps();
  const auto se3 = absolute_trajectory_error(estimate, truth, AlignmentKind::kSe3);
  const auto origin = absolute_trajectory_error(estimate, truth, AlignmentKind::kFirstPose);
  EXPECT_EQ(se3.translation_m.count, 299U);
  EXPECT_NEAR(se3.rotation_rad.rmse,
              rmse("evo_ape tum uav_ref.tum uav_est.tum -r angle_rad -a --t_max_diff 0.02"), kSame);
  EXPECT_NEAR(
      origin.rotation_rad.rmse,
      rmse("evo_ape tum uav_ref.tum uav_est.tum -r angle_rad --align_origin --t_max_diff 0.02"),
      kSame);
  EXPECT_NEAR(rms_of(se3.poses, [](const PoseError& e) { return frobenius(e.rotation_rad); }),
              rmse("evo_ape tum uav_ref.tum uav_est.tum -r rot_part -a --t_max_diff 0.02"), kSame);
}

TEST_F(EvoFigures, ASimilarityFitLeavesTheSameTranslationError) {
  const std::vector<PosePair> pairs =
      matched_poses(uav_estimate_on_reference_stamps(), trajectory("uav_ref.tum"));
  const Similarity fit = umeyama(pairs, true);
  const double left = rms_of(pairs, [&](const PosePair& pair) {
    const Eigen::Vector3d p = fit.scale * fit.rotation * pair.estimate.translation();
    return (pair.truth.translation() - p - fit.translation).norm();
  });
  EXPECT_NEAR(left, rmse("evo_ape tum uav_ref.tum uav_est.tum -r trans_part -as --t_max_diff 0.02"),
              kSame);
}

TEST_F(EvoFigures, AStraightLineIsRefusedByBothAndUnalignedTheSame) {
  const Trajectory truth = trajectory("line_ref.tum");
  const Trajectory estimate = trajectory("line_est.tum");
  EXPECT_FALSE(align(estimate, truth, AlignmentKind::kSe3).determined());
  EXPECT_FALSE(
      align(trajectory("quarter_est.tum"), trajectory("quarter_ref.tum"), AlignmentKind::kSe3)
          .determined());
  // first poses are equal, so the first-pose alignment changes nothing
  const auto ate = absolute_trajectory_error(estimate, truth, AlignmentKind::kFirstPose);
  EXPECT_NEAR(ate.translation_m.rmse, rmse("evo_ape tum line_ref.tum line_est.tum -r trans_part"),
              kSame);
}

TEST_F(EvoFigures, OnFlightsThatTakeNoAlignmentTranslationAndRotationAreTheSame) {
  const auto quarter = absolute_trajectory_error(
      trajectory("quarter_est.tum"), trajectory("quarter_ref.tum"), AlignmentKind::kFirstPose);
  EXPECT_NEAR(quarter.translation_m.rmse,
              rmse("evo_ape tum quarter_ref.tum quarter_est.tum -r trans_part"), kSame);
  EXPECT_NEAR(quarter.rotation_rad.rmse,
              rmse("evo_ape tum quarter_ref.tum quarter_est.tum -r angle_rad --align_origin"),
              kSame);
  const auto flip = absolute_trajectory_error(trajectory("flip_est.tum"),
                                              trajectory("flip_ref.tum"), AlignmentKind::kSe3);
  EXPECT_NEAR(flip.rotation_rad.rmse, rmse("evo_ape tum flip_ref.tum flip_est.tum -r angle_rad -a"),
              kSame);
  EXPECT_LT(flip.translation_m.max, 1e-12);
}

TEST_F(EvoFigures, WhereSegmentsEndOnPosesTheRelativeErrorsAreTheSame) {
  // Steps of exactly 0.25 m: evo's all pairs 1 m apart are our segments starting every 0.25 m.
  const Trajectory truth = trajectory("quarter_ref.tum");
  const Trajectory estimate = trajectory("quarter_est.tum");
  // (Not for 5 m: within its tolerance of 10 % evo adds shorter pairs at the end.)
  const RelativePoseError rpe = relative_pose_error(estimate, truth, 1.0, 0.25);
  EXPECT_EQ(rpe.used, 45U);  // 48 steps
  const double full = rms_of(rpe.segments, [](const SegmentError& e) {
    return std::hypot(e.translation_m, frobenius(e.rotation_rad));
  });
  const std::string tail = " -d 1 -u m --all_pairs --pairs_from_reference";
  const std::string evo_rpe = "evo_rpe tum quarter_ref.tum quarter_est.tum -r ";
  EXPECT_NEAR(full, rmse(evo_rpe + "full" + tail), kSame);
  EXPECT_NEAR(rpe.rotation_rad.rmse / kDegree, rmse(evo_rpe + "angle_deg" + tail + " -t 0.02"),
              kSame / kDegree);
}

// Results (cm, 6 decimals) and counts of tests/oracle/relative_pose_error.py, which was written
// independently of the library.
TEST_F(EvoFigures, TheDefinitionGivesWhatAnIndependentScriptOfItGave) {
  const Trajectory truth = trajectory("uav_ref.tum");
  const RelativePoseError whole = relative_pose_error(trajectory("uav_est.tum"), truth);
  EXPECT_EQ(whole.used, 53U);
  EXPECT_NEAR(100.0 * whole.translation_m.rmse, 0.561919, 1e-6);
  const RelativePoseError gap = relative_pose_error(trajectory("uav_est_gap.tum"), truth);
  EXPECT_EQ(gap.used, 38U);
  EXPECT_EQ(gap.total, 45U);
  EXPECT_NEAR(100.0 * gap.translation_m.rmse, 0.541948, 1e-6);
  const RelativePoseError hover =
      relative_pose_error(trajectory("hover_est.tum"), trajectory("hover_ref.tum"));
  EXPECT_EQ(hover.used, 15U);
  EXPECT_NEAR(100.0 * hover.translation_m.rmse, 2.923887, 1e-6);
}

TEST_F(EvoFigures, StampsMadeLateBy237MillisecondsAreFoundToBe) {
  const Trajectory truth = trajectory("uav_ref.tum");
  const auto right = time_offset(trajectory("uav_est.tum"), truth);
  const auto late = time_offset(trajectory("uav_est_off.tum"), truth);
  ASSERT_TRUE(right && late);
  EXPECT_NEAR(right->late_s, 0.0, 4.0 * right->sigma_s);
  EXPECT_NEAR(late->late_s, 0.237, 4.0 * late->sigma_s);
  EXPECT_LT(late->sigma_s, 0.005);
}

// 0.01347 m was computed by a script that used the nearest stamp of the truth (100 Hz, so up to 5
// ms away) instead of interpolating it. At the 0.2 .. 0.4 m/s of this sequence that is a random
// error of about 1 mm per pose: in RMSE, sqrt(13.47^2 +- 1^2) - 13.47 = 0.04 mm.
TEST(TumFreiburg1, AlignedErrorIsThePublishedOne) {
  std::ifstream truth_file(test_data("tum_rgbd/freiburg1_xyz-groundtruth.txt"));
  std::ifstream estimate_file(test_data("tum_rgbd/freiburg1_xyz-rgbdslam.txt"));
  const auto ate = absolute_trajectory_error(tum_text::parse(estimate_file),
                                             tum_text::parse(truth_file), AlignmentKind::kSe3);
  EXPECT_NEAR(ate.translation_m.rmse, 0.01347, 5e-5);
  RecordProperty("ate_rmse_m", std::to_string(ate.translation_m.rmse));
}

/// Public trajectories of other programs, with various rates, frames and clocks.
class RealTrajectories : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(shared("trajectories"))) {
      GTEST_SKIP() << "folder of real trajectories not found";
    }
  }
  static Trajectory read(const std::string& name) {
    return dataset::read_trajectory(shared("trajectories/" + name));
  }
};

TEST_F(RealTrajectories, EurocsTwoEstimatesAreOfTheTruthsBodyAndLateByTheSameTime) {
  const Trajectory truth = read("euroc_V1_02/stamped_groundtruth.txt");
  std::vector<TimeOffset> late;
  for (const char* name : {"stamped_traj_estimate0.txt", "stamped_traj_estimate1.txt"}) {
    const Trajectory estimate = read(std::string("euroc_V1_02/") + name);
    const Association found = associate(estimate, truth);
    EXPECT_EQ(found.matched, estimate.size());
    EXPECT_NEAR(found.estimate_rate_hz, 20.0, 0.01);
    EXPECT_EQ(suspect_times(estimate, truth), "");
    EXPECT_EQ(suspect_quaternion_order(estimate, truth), "");
    const auto arm = find_lever_arm(estimate, truth);
    ASSERT_TRUE(arm);
    // both are of the IMU: what remains are errors of the estimators and of the clocks
    EXPECT_LT(arm->body_from_estimate.translation().norm(), 0.05);
    EXPECT_EQ(warning_of(*arm), "");
    late.push_back(*time_offset(estimate, truth));
  }
  // two runs of one program on one recording share its clocks
  EXPECT_NEAR(late[0].late_s, late[1].late_s, 3.0 * std::hypot(late[0].sigma_s, late[1].sigma_s));
}

TEST(TumFreiburg1, AKeyframeTrajectorySaysHowLittleItCovers) {
  const Trajectory truth =
      dataset::read_trajectory(test_data("tum_rgbd/freiburg1_xyz-groundtruth.txt"));
  const Trajectory keyframes =
      dataset::read_trajectory(test_data("tum_rgbd/freiburg1_xyz-ORB_kf_mono.txt"));
  EXPECT_LT(associate(keyframes, truth).coverage, 0.1);
  // the camera's z axis points forward: a heading-only fit causes a warning
  EXPECT_NE(align(keyframes, truth, AlignmentKind::kPosYaw).warning, "");
}

TEST_F(RealTrajectories, ClocksOfDifferentEpochsAreNamed) {
  const std::string said =
      suspect_times(read("tiers/indoor04_fastlio_os128.tum"), read("tiers/indoor01_optitrack.tum"));
  EXPECT_NE(said.find("clocks count from different instants"), std::string::npos) << said;
}

TEST_F(RealTrajectories, ATableOfAnotherLayoutIsRefusedInWords) {
  EXPECT_THROW(read("boreas/boreas-2021-08-05-13-34_lidar_poses.csv"), InputError);
}

}  // namespace
}  // namespace lidarena::evaluation
