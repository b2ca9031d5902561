// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/pose_csv.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class TrajectoryFile : public testing::Test {
 protected:
  std::filesystem::path put(std::string_view text, const char* name = "t.tum") const {
    return folder_.write(name, text);
  }
  std::string tum_error(std::string_view text) const {
    return input_error([&] { read_tum(put(text)); });
  }
  TemporaryFolder folder_;
};

using Tum = TrajectoryFile;
using Kitti = TrajectoryFile;
using Euroc = TrajectoryFile;

TEST_F(Tum, ReadsTimesToTheNanosecondAndQuaternionsAsXyzw) {
  const auto t = read_tum(put("1690309709.285305601 1 2 3 0 0 0.6 0.8\n"));
  ASSERT_EQ(t.size(), 1U);
  EXPECT_EQ(t.begin_time(), Time{1690309709285305601});
  const Pose pose = t.poses()[0].world_from_body;
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(1, 2, 3));
  // a rotation by 2 atan2(0.6, 0.8) about z maps x to (0.28, 0.96)
  EXPECT_LT((pose.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0.28, 0.96, 0)).norm(),
            1e-15);
}

TEST_F(Tum, BlankLinesTabsCommentsMarksAndCarriageReturnsDoNoHarm) {
  const auto t =
      read_tum(put("\xEF\xBB\xBF# time x y z\r\n\r\n1\t0 0 0\t0 0 0 1  \r\n"
                   "   # note\n\n 2 0  0 1 0 0 0 -1\t\r\n"));
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t.end_time(), Time{2'000'000'000});
  EXPECT_EQ(t.poses()[1].world_from_body.translation().z(), 1.0);
}

TEST_F(Tum, ARoundTripKeepsNineDigits) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 200; ++i) {
    const double a = 0.1 * i;
    const Eigen::Vector3d rotation = 3.1 * std::sin(a) * Eigen::Vector3d(1, 2, -2) / 3.0;
    poses.push_back({Time{1690309709285305601 + i * 10'000'001L},
                     make_pose(so3::exp(rotation), Eigen::Vector3d(1e3 * std::cos(a), a, -a * a))});
  }
  const auto file = folder_.path() / "t.tum";
  write_tum(file, Trajectory(poses), "frame world\nbody");
  EXPECT_THAT(file_text(file), testing::StartsWith("# frame world\n# body\n1690309709.285305601 "));
  const auto back = read_tum(file);
  ASSERT_EQ(back.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose a = poses[i].world_from_body;
    const Pose b = back.poses()[i].world_from_body;
    EXPECT_EQ(back.poses()[i].stamp, poses[i].stamp);
    // half a unit in the 9th digit of at most 1e3 m, per axis
    EXPECT_LT((a.translation() - b.translation()).cwiseAbs().maxCoeff(), 5.1e-7);
    // errors of up to 5e-10 in four components change the rotation by at most 2 * 2 * 5e-10 rad
    EXPECT_LT(so3::angle(a.linear().transpose() * b.linear()), 2.1e-9);
  }
}

TEST_F(Tum, WritesTheQuaternionWithItsRealPartPositive) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 64; ++i) {
    poses.push_back({Time{i}, make_pose(so3::exp(Eigen::Vector3d(0, 0, 0.2 * i)),
                                        Eigen::Vector3d(-0.0, 0, 0))});
  }
  const auto file = folder_.path() / "t.tum";
  write_tum(file, Trajectory(poses), "");
  TextRows rows(file);
  while (const auto row = rows.next()) {
    const auto words = split_words(*row);
    ASSERT_EQ(words.size(), 8U);
    EXPECT_GE(*parse_double(words[7]), 0.0);
    EXPECT_EQ(words[1], "0");
  }
}

TEST_F(Tum, BrokenRowsAreNamedByFileAndLine) {
  EXPECT_THAT(tum_error("# c\n1 0 0 0 0 0 0\n"), AllOf(HasSubstr("t.tum:2: holds 7 columns, not 8"),
                                                       HasSubstr("t x y z qx qy qz qw")));
  EXPECT_THAT(tum_error("1 0 0 0 0 0 0 1 9\n"), HasSubstr("t.tum:1: holds 9 columns"));
  EXPECT_THAT(tum_error("1 0 a 0 0 0 0 1\n"), HasSubstr("t.tum:1: 'a' is not a number"));
  EXPECT_THAT(tum_error("x 0 0 0 0 0 0 1\n"), HasSubstr("'x' is not a time in seconds"));
  EXPECT_THAT(tum_error("nan 0 0 0 0 0 0 1\n"), HasSubstr("'nan' is not a time"));
  EXPECT_THAT(tum_error("1 0 0 0 0 0 0 1\n2 0 nan 0 0 0 0 1\n"),
              HasSubstr("t.tum:2: 'nan' is not finite"));
  EXPECT_THAT(tum_error("1 0 inf 0 0 0 0 1\n"), HasSubstr("not finite"));
}

TEST_F(Tum, TimesMustIncrease) {
  EXPECT_THAT(
      tum_error("1 0 0 0 0 0 0 1\n\n1 0 0 0 0 0 0 1\n"),
      AllOf(HasSubstr("t.tum:3: the time 1.000000000 repeats"), HasSubstr("sort the rows")));
  EXPECT_THAT(tum_error("1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n"),
              HasSubstr("t.tum:2: the time 0.500000000 is earlier"));
}

TEST_F(Tum, QuaternionsMustBeOfUnitLengthWithinRounding) {
  EXPECT_THAT(tum_error("1 0 0 0 0 0 0 0\n"), HasSubstr("t.tum:1: the quaternion's norm is 0"));
  EXPECT_THAT(tum_error("1 0 0 0 0 0 0 1.002\n"), HasSubstr("norm is 1.002"));
  EXPECT_THAT(tum_error("1 0 0 0 1 1 1 1\n"), HasSubstr("norm is 2"));
  const auto t = read_tum(put("1 0 0 0 0 0 0 0.9995\n"));
  EXPECT_EQ(t.poses()[0].world_from_body.linear(), Eigen::Matrix3d::Identity());
}

TEST_F(Tum, AFileWithoutPosesIsRefusedUnlessAllowed) {
  EXPECT_THAT(tum_error(""), HasSubstr("holds no pose"));
  EXPECT_THAT(tum_error("# only\n#comments\n"), HasSubstr("holds no pose"));
  EXPECT_TRUE(read_tum(put("# none\n"), EmptyTrajectory::kAllowed).empty());
  EXPECT_THAT(input_error([&] { read_tum(folder_.path() / "none.tum"); }),
              HasSubstr("no such file"));
}

TEST_F(Tum, RowsThatRepeatATimeAreCollectedWhereTheyAreAskedFor) {
  const std::string text =
      "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n1 3 0 0 0 0 0 1\n2 4 0 0 0 0 0 1\n";
  const FramedTrajectory read = read_framed_trajectory(put(text));
  ASSERT_EQ(read.trajectory.size(), 3U);
  EXPECT_EQ(read.trajectory.poses()[1].world_from_body.translation().x(), 1.0) << "the first one";
  ASSERT_EQ(read.repeated.size(), 2U);
  const std::vector<StampedPose> rows = read.rows();
  ASSERT_EQ(rows.size(), 5U);
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].world_from_body.translation().x(), static_cast<double>(i)) << "their order";
  EXPECT_THAT(
      input_error([&] { read_framed_trajectory(put("1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n")); }),
      HasSubstr("is earlier than"));
}

TEST_F(Tum, OnePoseIsATrajectory) { EXPECT_EQ(read_tum(put("1 0 0 0 0 0 0 1")).size(), 1U); }

TEST_F(Kitti, RowsAreMatricesAndFramesAreTimed) {
  const auto file = put("1 0 0 5 0 1 0 6 0 0 1 7\n0 -1 0 1 1 0 0 2 0 0 1 3\n", "p.txt");
  const auto t = read_kitti_poses(file, 20.0);
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t.end_time(), Time{50'000'000});
  EXPECT_EQ(t.poses()[0].world_from_body.translation(), Eigen::Vector3d(5, 6, 7));
  const Eigen::Vector3d x = t.poses()[1].world_from_body.linear() * Eigen::Vector3d::UnitX();
  EXPECT_LT((x - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  const auto timed = read_kitti_poses(file, {Time{5}, Time{17}});
  EXPECT_EQ(timed.end_time(), Time{17});
  EXPECT_THAT(input_error([&] { read_kitti_poses(file, std::vector<Time>{Time{5}}); }),
              HasSubstr("p.txt:2: frame 1 has no time"));
}

TEST_F(Kitti, ALeadingFrameNumberPicksTheTime) {
  const auto t = read_kitti_poses(
      put("2 1 0 0 0 0 1 0 0 0 0 1 0\n5 1 0 0 1 0 1 0 0 0 0 1 0\n", "p.txt"), 10.0);
  EXPECT_EQ(t.begin_time(), Time{200'000'000});
  EXPECT_EQ(t.end_time(), Time{500'000'000});
}

TEST_F(Kitti, RowsThatAreNoRotationAreRefused) {
  const auto error = [&](std::string_view text) {
    return input_error([&] { read_kitti_poses(put(text, "p.txt")); });
  };
  EXPECT_THAT(error("2 0 0 0 0 2 0 0 0 0 2 0\n"), HasSubstr("p.txt:1: the 3x3 part is not a rot"));
  EXPECT_THAT(error("1 0 0 0 0 1 0 0 0 0 -1 0\n"), HasSubstr("determinant -1"));  // a reflection
  EXPECT_THAT(error("0 0 0 0 0 0 0 0 0 0 0 0\n"), HasSubstr("not a rotation"));
  EXPECT_THAT(error("1 0 0 0 0 1 0 0 0 0 1\n"), HasSubstr("holds 11 columns"));
  EXPECT_THAT(error("1 0 0 nan 0 1 0 0 0 0 1 0\n"), HasSubstr("not finite"));
  EXPECT_THAT(error("1.5 1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("'1.5' is not a frame number"));
  EXPECT_THAT(error("3 1 0 0 0 0 1 0 0 0 0 1 0\n3 1 0 0 0 0 1 0 0 0 0 1 0\n"),
              HasSubstr("p.txt:2: the time"));
}

TEST_F(Kitti, RoundedRotationsComeOutOrthonormal) {
  // 4 digits of a rotation by 0.5 rad about (1,2,2)/3
  const Eigen::Matrix3d truth = so3::exp(Eigen::Vector3d(1, 2, 2) / 6.0);
  std::string row;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) row += fmt::format("{:.4f} ", c < 3 ? truth(r, c) : 0.0);
  }
  const auto t = read_kitti_poses(put(row + "\n", "p.txt"));
  const Eigen::Matrix3d r = t.poses()[0].world_from_body.linear();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT(so3::angle(truth.transpose() * r), 2e-4);  // nine entries with errors of at most 5e-5
}

TEST_F(Kitti, TimesMustIncrease) {
  EXPECT_EQ(read_times(put("0.000000e+00\n1.037359e-01\n", "times.txt")).back(), Time{103'735'900});
  EXPECT_THAT(input_error([&] { read_times(put("1\n1\n", "times.txt")); }),
              HasSubstr("times.txt:2: the time is not later"));
  EXPECT_THAT(input_error([&] { read_times(put("1\nx\n", "times.txt")); }),
              HasSubstr("times.txt:2: 'x' is not a time"));
}

constexpr const char* kEurocHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
    "q_RS_z [], v_RS_R_x [m s^-1]\r\n";

TEST_F(Euroc, QuaternionsStartWithTheirRealPart) {
  const auto t = read_pose_csv(
      put(std::string(kEurocHeader) + "1403715274302142976,1,2,3,0.8,0,0,0.6,9\r\n", "d.csv"));
  EXPECT_EQ(t.begin_time(), Time{1403715274302142976});
  const Eigen::Vector3d x = t.poses()[0].world_from_body.linear() * Eigen::Vector3d::UnitX();
  EXPECT_LT((x - Eigen::Vector3d(0.28, 0.96, 0)).norm(), 1e-15);
}

TEST_F(Euroc, ColumnsAreFoundByTheirNamesInAnyOrder) {
  const Eigen::Quaterniond rotation(0.8, 0.0, 0.0, 0.6);
  for (const char* text :
       {"#timestamp, p_wb_x, p_wb_y, p_wb_z, q_wb_x, q_wb_y, q_wb_z, q_wb_w\n"
        "1700000000500000000,1,2,3,0,0,0.6,0.8\n",
        "timestamp,qw,qx,qy,qz,x,y,z\n1700000000.5,0.8,0,0,0.6,1,2,3\n",
        "\xEF\xBB\xBF#timestamp [ms],world_p_x,world_p_y,world_p_z,world_qx,world_qy,world_qz,"
        "world_qw\n1700000000500,1,2,3,0,0,0.6,0.8\n",
        "%time,field.header.seq,field.pose.pose.position.x,field.pose.pose.position.y,"
        "field.pose.pose.position.z,field.pose.pose.orientation.x,field.pose.pose.orientation.y,"
        "field.pose.pose.orientation.z,field.pose.pose.orientation.w,field.pose.covariance.x,"
        "field.twist.twist.linear.x\n1700000000500000000,7,1,2,3,0,0,0.6,0.8,9,9\n"}) {
    const auto read = read_pose_csv(put(text, "p.csv"));
    const StampedPose& pose = read.poses()[0];
    EXPECT_EQ(pose.stamp, Time{1'700'000'000'500'000'000}) << text;
    EXPECT_TRUE(pose.world_from_body.isApprox(make_pose(rotation, {1.0, 2.0, 3.0}), 1e-12)) << text;
  }
}

TEST_F(Euroc, BrokenRowsAreNamed) {
  const auto error = [&](const std::string& rows) {
    return input_error([&] { read_pose_csv(put(rows, "d.csv")); });
  };
  EXPECT_THAT(error("1403715274302142976,1,2,3,0.8,0,0,0.6\n"),
              HasSubstr("d.csv:1: begins with numbers"));
  EXPECT_THAT(error("1,5 2,0 3,0 4,0 0,0 0,0 0,0 1,0\n"), HasSubstr("write decimals with points"));
  EXPECT_THAT(error("time,x,y,z,roll,pitch,yaw\n1,0,0,0,0,0,0\n"), HasSubstr("no column is 'qw'"));
  EXPECT_THAT(error("time,x,y,z,x,qx,qy,qz,qw\n"), HasSubstr("two columns are 'x'"));
  EXPECT_THAT(error("frame,x,y,z,qx,qy,qz,qw\n"), HasSubstr("no column is a time"));
  EXPECT_THAT(error(kEurocHeader), HasSubstr("holds no pose"));
  EXPECT_THAT(error(""), HasSubstr("not the header"));
  EXPECT_THAT(error(std::string(kEurocHeader) + "1,2,3\n"), HasSubstr("d.csv:2: holds 3 columns"));
  EXPECT_THAT(error(std::string(kEurocHeader) + "1.5,0,0,0,1,0,0,0\n"),
              HasSubstr("'1.5' is not a time in nanoseconds"));
  EXPECT_THAT(error(std::string(kEurocHeader) + "1,0,0,0,0,0,0,0\n"), HasSubstr("norm is 0"));
  EXPECT_THAT(error(std::string(kEurocHeader) + "1,0,0,,1,0,0,0\n"), HasSubstr("'' is not a numb"));
}

TEST_F(TrajectoryFile, TheFormatIsToldByTheContent) {
  EXPECT_EQ(read_trajectory(put("7 0 0 0 0 0 0 1\n", "a.txt")).begin_time(), Time{7'000'000'000});
  const auto kitti = put("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n", "b.txt");
  EXPECT_EQ(read_trajectory(kitti, 5.0).end_time(), Time{200'000'000});
  put("3\n4\n", "times.txt");
  EXPECT_EQ(read_trajectory(kitti).end_time(), Time{4'000'000'000});
  EXPECT_EQ(
      read_trajectory(put(std::string(kEurocHeader) + "9,0,0,0,1,0,0,0\n", "c.csv")).begin_time(),
      Time{9});
  EXPECT_THAT(input_error([&] { read_trajectory(put("", "d.txt")); }), HasSubstr("no pose"));
}

TEST_F(TrajectoryFile, TimesThatLostTheirDigitsAreNamedAsThat) {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += "1.7e+09 " + std::to_string(i) + " 0 0 0 0 0 1\n";
  EXPECT_THAT(input_error([&] { read_framed_trajectory(put(rows)); }),
              AllOf(HasSubstr("19 of 20 rows have the time"), HasSubstr("lost their digits")));
}

TEST_F(TrajectoryFile, TimesThatAreAssumedAreSaid) {
  const auto kitti = put("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n", "b.txt");
  EXPECT_THAT(read_framed_trajectory(kitti).note, HasSubstr("taken to come at 10 Hz"));
}

TEST_F(TrajectoryFile, CutAnywhereItIsReadInPartOrRefused) {
  const std::string texts[] = {"# h\n1.5 1 2 3 0 0 0.6 0.8\n2.5 1 2 3 0 0 0 1\n",
                               "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n",
                               std::string(kEurocHeader) + "9,0,0,0,1,0,0,0\n11,0,0,0,1,0,0,0\n"};
  for (const std::string& text : texts) {
    std::size_t refused = 0;
    for (std::size_t n = 0; n < text.size(); ++n) {
      try {
        EXPECT_LE(read_trajectory(put(text.substr(0, n), "x.txt")).size(), 2U);
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, text.size() / 3);
    EXPECT_EQ(read_trajectory(put(text, "x.txt")).size(), 2U);
  }
}

struct RealFile {
  const char* name;
  std::size_t poses;
  double length_m;  ///< path length, computed independently; 0 if it was not
};

class RealTrajectory : public testing::TestWithParam<RealFile> {};

TEST_P(RealTrajectory, HasThePosesThatItsDescriptionCountsAndTheRightLength) {
  const auto file = shared_data(GetParam().name);
  LIDARENA_NEEDS(file);
  const Trajectory t = read_trajectory(file);
  EXPECT_EQ(t.size(), GetParam().poses);
  if (GetParam().length_m > 0) {
    EXPECT_NEAR(t.path_length(), GetParam().length_m, 5e-4);  // given with 3 decimals
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shared, RealTrajectory,
    testing::Values(RealFile{"trajectories/tiers/indoor01_optitrack.tum", 6471, 33.890},
                    RealFile{"trajectories/tiers/forest01_optitrack.tum", 9664, 21.324},
                    RealFile{"trajectories/tiers/indoor04_fastlio_os128.tum", 2480, 304.545},
                    RealFile{"trajectories/euroc_V1_02/stamped_groundtruth.txt", 3341, 0},
                    RealFile{"trajectories/euroc_V1_02/stamped_traj_estimate0.txt", 1355, 0},
                    RealFile{"trajectories/euroc_V1_02/stamped_traj_estimate1.txt", 1367, 0},
                    RealFile{"trajectories/kitti_odometry/09_groundtruth.txt", 1591, 1705.051},
                    RealFile{"trajectories/kitti_odometry/09_estimate_a.txt", 1589, 0},
                    RealFile{"trajectories/kitti_odometry/09_estimate_b.txt", 1591, 0},
                    RealFile{"trajectories/tum_rgbd/freiburg1_xyz-groundtruth.txt", 3000, 0},
                    RealFile{"trajectories/tum_rgbd/freiburg1_xyz-rgbdslam.txt", 788, 0},
                    RealFile{"trajectories/tum_rgbd/freiburg1_xyz-ORB_kf_mono.txt", 32, 0},
                    RealFile{"lidar/gtsam_points/continuous/traj.txt", 2380, 0}));

TEST(RealTrajectoryTimes, ScientificStampsOfEurocKeepTheirNanoseconds) {
  const auto file = shared_data("trajectories/euroc_V1_02/stamped_groundtruth.txt");
  LIDARENA_NEEDS(file);
  EXPECT_EQ(read_trajectory(file).begin_time(), Time{1403715524907143116});
}

TEST(RealTrajectoryTimes, ASpreadsheetIsRefusedWithAReason) {
  const auto file = shared_data("trajectories/boreas/boreas-2021-08-05-13-34_lidar_poses.csv");
  LIDARENA_NEEDS(file);
  EXPECT_THAT(input_error([&] { read_trajectory(file); }), HasSubstr("no column is 'x'"));
}

}  // namespace
}  // namespace lidarena::dataset
