// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/compat_evo.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <sstream>

#include "flights.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "tum_text.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using flights::level;
using flights::sample;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

template <class E>
E named(const std::string& text) {
  for (const auto& [name, value] : enum_names(E{})) {
    if (text == name) return value;
  }
  throw std::runtime_error("no such name: " + text);
}

/// The command line "evo_rpe tum REF EST -r full -d 1 -u m ..." as options.
struct Command {
  std::string reference, estimate;
  EvoOptions options;
  bool aligned = false;

  explicit Command(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    words >> word;
    options.metric = word == "evo_ape" ? EvoMetric::kApe : EvoMetric::kRpe;
    words >> word >> reference >> estimate;
    while (words >> word) read_option(word, words);
  }
  void read_option(const std::string& word, std::istringstream& words) {
    EvoOptions& o = options;
    std::string value;
    if (word == "-a" || word == "-as") o.align = aligned = true;
    if (word == "-s" || word == "-as") o.scale = aligned = true;
    if (word == "--align_origin") o.align_origin = aligned = true;
    if (word == "--all_pairs") o.all_pairs = true;
    if (word == "--pairs_from_reference") o.pairs_from_reference = true;
    if (word == "-r" && words >> value) o.relation = named<EvoRelation>(value);
    if (word == "-u" && words >> value) o.unit = named<EvoUnit>(value);
    if (word == "-d") words >> o.delta;
    if (word == "-t") words >> o.delta_tolerance;
    if (word == "--t_max_diff") words >> o.max_difference_s;
    if (word == "--t_offset") words >> o.offset_s;
    if (word == "--n_to_align") words >> o.n_to_align;
  }
};

// Limit below which differences are ignored. Coordinates of about ten meters and angles of about
// ten degrees have a rounding error of 1/64 of this, so errors that consist only of rounding, and
// deviations of equal errors, are not known more accurately.
constexpr double kRounding = 1e-13;

/// Largest relative difference of the seven statistics.
double difference(const EvoStatistics& ours, const Json& theirs) {
  double largest = 0.0;
  const auto compare = [&](double a, const char* name) {
    const double b = theirs.at(name);
    if (std::abs(a - b) > kRounding) largest = std::max(largest, std::abs(a - b) / std::abs(b));
  };
  compare(ours.rmse, "rmse");
  compare(ours.mean, "mean");
  compare(ours.median, "median");
  compare(ours.std, "std");
  compare(ours.min, "min");
  compare(ours.max, "max");
  compare(ours.sse, "sse");
  return largest;
}

TEST(CompatEvo, GivesTheFiguresAndRefusalsOfEvoItself) {
  std::ifstream in(tum_text::test_data("evo/evo_figures.json"));
  const Json document = Json::parse(in);
  std::map<std::string, Trajectory> files;
  for (const auto& [name, text] : document["files"].items()) {
    files[name] = tum_text::parse(text.get<std::string>());
  }
  double worst_plain = 0.0;
  double worst_aligned = 0.0;
  std::size_t refused = 0;
  for (const Json& run : document["runs"]) {
    const Command command(run["command"]);
    SCOPED_TRACE(run["command"].get<std::string>());
    const auto score = [&] {
      return compat_evo(files.at(command.reference).poses(), files.at(command.estimate).poses(),
                        command.options);
    };
    if (!run.contains("stats")) {
      EXPECT_THROW(score(), InputError);
      ++refused;
      continue;
    }
    EvoResult result;
    ASSERT_NO_THROW(result = score());
    const double off = difference(result.statistics, run["stats"]);
    EXPECT_LT(off, command.aligned ? 1e-7 : 1e-9);
    (command.aligned ? worst_aligned : worst_plain) =
        std::max(command.aligned ? worst_aligned : worst_plain, off);
  }
  RecordProperty("largest_relative_difference", std::to_string(worst_plain * 1e12) + "e-12");
  RecordProperty("largest_relative_difference_aligned",
                 std::to_string(worst_aligned * 1e12) + "e-12");
  std::printf("%zu commands, %zu refused; largest relative difference %.2g, aligned %.2g\n",
              document["runs"].size(), refused, worst_plain, worst_aligned);
}

// --- behavior in closed form

TEST(CompatEvo, KeepsRowsThatRepeatATime) {
  // Nearest stamps, the first of equal ones: the second row at 1 s is never paired when the file
  // with it is the longer one, and is a pair of its own when that is the shorter one.
  const auto at = [](int seconds, double x) {
    return StampedPose{Time{seconds * 1'000'000'000LL},
                       make_pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0, 0))};
  };
  const std::vector<StampedPose> repeated{at(0, 0.0), at(1, 1.0), at(1, 1.5), at(2, 2.0)};
  const std::vector<StampedPose> once{at(0, 0.0), at(1, 1.0), at(2, 2.0)};
  EXPECT_EQ(compat_evo(repeated, once, {}).statistics.max, 0.0);
  EXPECT_EQ(compat_evo(repeated, once, {}).matched, 3U);
  const std::vector<StampedPose> longer{at(0, 0.0), at(1, 1.0), at(2, 2.0), at(3, 3.0), at(4, 4.0)};
  EXPECT_EQ(compat_evo(longer, repeated, {}).matched, 4U);
  EXPECT_EQ(compat_evo(longer, repeated, {}).statistics.max, 0.5);
  const std::vector<StampedPose> late{
      {Time{1'004'000'000}, make_pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 0, 0))}};
  EXPECT_EQ(compat_evo(repeated, late, {}).statistics.max, 0.0) << "the first row at 1 s";
}

std::vector<Pose> poses_along(const std::function<Pose(int)>& pose, int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) poses.push_back(pose(i));
  return poses;
}
std::vector<Pose> steps_of(double meters, int count) {
  return poses_along([&](int i) { return level({meters * i, 0, 0}); }, count);
}
std::vector<Pose> turns_of(double degrees, int count) {
  const double step = degrees * std::numbers::pi / 180.0;
  return poses_along(
      [&](int i) {
        return make_pose(so3::exp({0, 0, step * i}), Eigen::Vector3d::Zero());
      },
      count);
}
EvoOptions pieces(EvoUnit unit, double delta, bool all_pairs = false) {
  EvoOptions options;
  options.metric = EvoMetric::kRpe;
  options.unit = unit;
  options.delta = delta;
  options.all_pairs = all_pairs;
  return options;
}
EvoOptions absolute(EvoRelation relation) {
  EvoOptions options;
  options.relation = relation;
  return options;
}

TEST(EvoPieces, FramesFollowOneAnotherOrStartAtEveryPose) {
  const std::vector<Pose> poses = steps_of(0.1, 8);
  EXPECT_THAT(evo_pieces(poses, pieces(EvoUnit::kFrames, 3)), ElementsAre(Pair(0, 3), Pair(3, 6)));
  EXPECT_THAT(evo_pieces(poses, pieces(EvoUnit::kFrames, 5, true)),
              ElementsAre(Pair(0, 5), Pair(1, 6), Pair(2, 7)));
  EXPECT_TRUE(evo_pieces(poses, pieces(EvoUnit::kFrames, 8)).empty());
}

TEST(EvoPieces, OfMetersTheFirstIsLostAndNoneIsShorter) {
  // steps of 0.375 m are exact: 1 m is exceeded at 1.125 m, at every third pose
  EXPECT_THAT(evo_pieces(steps_of(0.375, 11), pieces(EvoUnit::kMeters, 1.0)),
              ElementsAre(Pair(3, 6), Pair(6, 9)));
  EXPECT_THAT(evo_pieces(steps_of(0.25, 13), pieces(EvoUnit::kMeters, 1.0)),
              ElementsAre(Pair(4, 8), Pair(8, 12)));
}

TEST(EvoPieces, AllPairsOfMetersTakeTheNearestPoseWithinTheTolerance) {
  const std::vector<Pose> poses = steps_of(0.375, 5);
  EXPECT_TRUE(evo_pieces(poses, pieces(EvoUnit::kMeters, 1.0, true)).empty());  // 12.5 % off
  EvoOptions wide = pieces(EvoUnit::kMeters, 1.0, true);
  wide.delta_tolerance = 0.125;
  EXPECT_THAT(evo_pieces(poses, wide), ElementsAre(Pair(0, 3), Pair(1, 4)));
}

TEST(EvoPieces, AnglesCountFromTheFirstPose) {
  const std::vector<Pose> poses = turns_of(4.0, 8);
  const double radians = 10.0 * std::numbers::pi / 180.0;
  EXPECT_THAT(evo_pieces(poses, pieces(EvoUnit::kDegrees, 10.0)),
              ElementsAre(Pair(0, 3), Pair(3, 6)));
  EXPECT_THAT(evo_pieces(poses, pieces(EvoUnit::kRadians, radians)),
              ElementsAre(Pair(0, 3), Pair(3, 6)));
  EvoOptions wide = pieces(EvoUnit::kDegrees, 20.0, true);
  wide.delta_tolerance = 0.01;
  EXPECT_THAT(evo_pieces(poses, wide), ElementsAre(Pair(0, 5), Pair(1, 6), Pair(2, 7)));
}

TEST(EvoAssociation, EveryStampOfTheShorterFindsTheNearestOfTheLongerEvenTwice) {
  const auto still = [](double) { return level({0, 0, 0}); };
  const Trajectory slow = sample(still, 400ms, 1200ms);
  const Trajectory fast = flights::shifted(sample(still, 100ms, 800ms), 10ms);
  // 1.2 s is paired with 0.81 s again, 0.39 s away
  EXPECT_THAT(evo_association(slow.poses(), fast.poses(), 0.4, 0.0),
              ElementsAre(Pair(0, 0), Pair(1, 4), Pair(2, 8), Pair(3, 8)));
  EXPECT_THAT(evo_association(fast.poses(), slow.poses(), 0.4, 0.0),
              ElementsAre(Pair(0, 0), Pair(4, 1), Pair(8, 2), Pair(8, 3)));
  EXPECT_TRUE(evo_association(slow.poses(), fast.poses(), 0.009, 0.0).empty());
}

TEST(EvoAssociation, TheOffsetIsAddedToTheEstimate) {
  const auto still = [](double) { return level({0, 0, 0}); };
  const Trajectory reference = sample(still, 100ms, 1s);
  const Trajectory late = flights::shifted(reference, 237ms);
  EXPECT_EQ(evo_association(reference.poses(), late.poses(), 0.001, -0.237).size(), 11U);
  EXPECT_EQ(evo_association(late.poses(), reference.poses(), 0.001, 0.237).size(), 11U);
  EXPECT_TRUE(evo_association(reference.poses(), late.poses(), 0.001, 0.237).empty());
}

/// 1 m/s along x, with the positions multiplied by `scale`.
Trajectory line(double scale) {
  return sample([&](double t) { return level({scale * t, 0, 0}); }, 100ms, 10s);
}

TEST(CompatEvo, OfALineOnePercentTooLongIsKnown) {
  EvoOptions ratio = pieces(EvoUnit::kMeters, 1.0);
  ratio.relation = EvoRelation::kPointDistanceRatio;
  const EvoResult relative = compat_evo(line(1.0).poses(), line(1.01).poses(), ratio);
  EXPECT_EQ(relative.matched, 101U);
  EXPECT_NEAR(relative.statistics.min, 1.0, 1e-9);
  EXPECT_NEAR(relative.statistics.max, 1.0, 1e-9);
  const EvoStatistics ape =
      compat_evo(line(1.0).poses(), line(1.01).poses(), absolute(EvoRelation::kTranslation))
          .statistics;
  // 0.001 i for i = 0 .. 100: sum of squares 338350e-6
  EXPECT_NEAR(ape.sse, 0.33835, 1e-12);
  EXPECT_NEAR(ape.rmse, std::sqrt(0.33835 / 101.0), 1e-12);
  EXPECT_NEAR(ape.mean, 0.05, 1e-12);
  EXPECT_NEAR(ape.median, 0.05, 1e-12);
  EXPECT_NEAR(ape.std, std::sqrt((101.0 * 101.0 - 1.0) / 12.0) * 0.001, 1e-12);
  EXPECT_NEAR(ape.max, 0.1, 1e-12);
}

TEST(CompatEvo, ChordsOfNoLengthHaveNoRatio) {
  const auto rests = [](double t) { return level({std::max(0.0, t - 1.0), 0, 0}); };
  EvoOptions ratio = pieces(EvoUnit::kFrames, 5);
  ratio.relation = EvoRelation::kPointDistanceRatio;
  const Trajectory flight = sample(rests, 100ms, 2s);
  EXPECT_EQ(compat_evo(flight.poses(), flight.poses(), ratio).errors.size(), 2U);  // of 4 pieces
}

TEST(CompatEvo, EveryRelationOfATurnAndAMoveIsKnown) {
  const double angle = 2.0;
  const Pose error = make_pose(so3::exp({0, angle, 0}), Eigen::Vector3d(3, 4, 0));
  const Trajectory flight = sample(flights::tour, 100ms, 5s);
  const Trajectory estimate = flights::mapped(
      flight, [&](const StampedPose& pose) { return pose.world_from_body * error; });
  const auto rmse = [&](EvoRelation relation) {
    return compat_evo(flight.poses(), estimate.poses(), absolute(relation)).statistics.rmse;
  };
  const double frobenius = 2.0 * std::sqrt(2.0) * std::sin(angle / 2.0);
  EXPECT_NEAR(rmse(EvoRelation::kTranslation), 5.0, 1e-12);
  EXPECT_NEAR(rmse(EvoRelation::kPointDistance), 5.0, 1e-12);
  EXPECT_NEAR(rmse(EvoRelation::kRotation), frobenius, 1e-12);
  EXPECT_NEAR(rmse(EvoRelation::kFull), std::hypot(5.0, frobenius), 1e-12);
  EXPECT_NEAR(rmse(EvoRelation::kAngleRadians), angle, 1e-12);
  EXPECT_NEAR(rmse(EvoRelation::kAngleDegrees), angle * 180.0 / std::numbers::pi, 1e-10);
}

TEST(CompatEvo, AlignmentsTakeAwayWhatTheySay) {
  const Trajectory flight = sample(flights::tour, 100ms, 20s);
  const Pose elsewhere = make_pose(so3::exp({0.3, -0.4, 1.0}), Eigen::Vector3d(3, -2, 1));
  const Trajectory estimate = flights::mapped(flight, [&](const StampedPose& pose) {
    Pose moved = elsewhere * pose.world_from_body;
    moved.translation() *= 2.0;
    return moved;
  });
  EvoOptions o;
  o.align = o.scale = true;
  EXPECT_LT(compat_evo(flight.poses(), estimate.poses(), o).statistics.max, 1e-12);
  EXPECT_NEAR(compat_evo(flight.poses(), estimate.poses(), o).reference_from_estimate.scale, 0.5,
              1e-12);
  o.n_to_align = 20;
  EXPECT_LT(compat_evo(flight.poses(), estimate.poses(), o).statistics.max, 1e-11);
  o.align = false;  // scale only: rotation and translation stay
  const EvoResult scaled = compat_evo(flight.poses(), estimate.poses(), o);
  EXPECT_NEAR(scaled.reference_from_estimate.scale, 0.5, 1e-12);
  EXPECT_TRUE(scaled.reference_from_estimate.rotation.isIdentity(0.0));
  EvoOptions origin;
  origin.align_origin = true;
  EXPECT_LT(compat_evo(flight.poses(), estimate.poses(), origin).errors.front(), 1e-12);
  origin.relation = EvoRelation::kAngleRadians;
  EXPECT_LT(compat_evo(flight.poses(), estimate.poses(), origin).statistics.max, 1e-12);
}

/// The message of the error; empty when there is none.
std::string refusal(const Trajectory& reference, const Trajectory& estimate,
                    const EvoOptions& options) {
  try {
    compat_evo(reference.poses(), estimate.poses(), options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(CompatEvo, RefusesInWords) {
  const Trajectory flight = line(1.0);
  const auto of = [&](const EvoOptions& o) { return refusal(flight, flight, o); };
  EXPECT_THAT(refusal(flight, flights::shifted(flight, 1h), {}), HasSubstr("no stamps are within"));
  EXPECT_THAT(refusal(flight, Trajectory(), {}), HasSubstr("no stamps are within"));
  EXPECT_THAT(of(pieces(EvoUnit::kMeters, 0.0)), HasSubstr("not a positive number"));
  EXPECT_THAT(of(pieces(EvoUnit::kMeters, std::nan(""))), HasSubstr("not a positive number"));
  EXPECT_THAT(of(pieces(EvoUnit::kFrames, 1.5)), HasSubstr("whole number of frames"));
  EXPECT_THAT(of(pieces(EvoUnit::kDegrees, 181.0)), HasSubstr("more than 180 degrees"));
  EXPECT_THAT(of(pieces(EvoUnit::kRadians, 3.2)), HasSubstr("more than 180 degrees"));
  EXPECT_THAT(of(pieces(EvoUnit::kMeters, 50.0)), HasSubstr("no two poses are as far apart"));
  EXPECT_THAT(of(pieces(EvoUnit::kDegrees, 10.0)), HasSubstr("no two poses are as far apart"));
  EXPECT_THAT(of(absolute(EvoRelation::kPointDistanceRatio)), HasSubstr("rpe only"));
  EvoOptions align;
  align.align = true;
  EXPECT_THAT(of(align), HasSubstr("lie on a line"));
  align.align_origin = true;
  EXPECT_THAT(of(align), HasSubstr("cannot be combined with --align"));
}

}  // namespace
}  // namespace lidarena::evaluation
