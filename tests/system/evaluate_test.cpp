// SPDX-License-Identifier: BSD-3-Clause
// Calls `lidarena evaluate` on trajectory files of any program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Position = std::array<double, 3>;

/// Position at time `t` of a closed tour with climbs; write_tum() adds a yaw rate of 0.3 rad/s.
Position tour(double t) {
  return {4.0 * std::sin(0.35 * t), 3.0 * std::sin(0.5 * t + 0.4), 1.5 + 0.8 * std::sin(0.3 * t)};
}

class Evaluate : public Cli {
 protected:
  Outcome call(const std::string& arguments) const { return Cli::call("evaluate " + arguments); }
  /// Calls with bad input; expects exit code 2, nothing on standard output, and one error line.
  std::string refusal(const std::string& arguments) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  }
  /// Writes `comment`, then 30 s of `position` at `rate` Hz as TUM rows.
  void write_tum(const std::string& name, const std::function<Position(double)>& position,
                 double rate, const std::string& comment = "") const {
    std::string text = comment;
    for (int i = 0; i <= static_cast<int>(30 * rate); ++i) {
      const double t = i / rate;
      const Position p = position(t);
      std::array<char, 200> row{};
      std::snprintf(row.data(), row.size(), "%.6f %.9f %.9f %.9f 0 0 %.9f %.9f\n", t, p[0], p[1],
                    p[2], std::sin(0.15 * t), std::cos(0.15 * t));
      text += row.data();
    }
    write(name, text);
  }
};

TEST_F(Evaluate, AnyonesTrajectoryIsScoredDiagnosisFirst) {
  write_tum("truth.tum", tour, 100);
  write_tum(
      "slam.tum",
      [](double t) {
        const Position p = tour(t);
        return Position{p[0] + 0.001 * t, p[1], p[2]};
      },
      10);
  const Outcome outcome = call("--trajectory slam.tum --truth truth.tum");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("301 of 301 poses matched, coverage 100.0 %"),
                                 HasSubstr("RPE per meter"), HasSubstr("coverage 100 %")));
  EXPECT_LT(outcome.out.find("poses matched"), outcome.out.find("RPE per meter"));
  const json metrics = json::parse(call("--json --trajectory slam.tum --truth truth.tum").out);
  EXPECT_EQ(metrics["status"], "ok");
  EXPECT_NEAR(metrics["final"]["ate"]["first_pose"]["translation"]["max_m"], 0.030, 1e-6);
}

TEST_F(Evaluate, SeveralTrajectoriesBecomeRowsAndAFailureOneOfThem) {
  write_tum("truth.tum", tour, 100);
  write_tum("good.tum", tour, 10);
  write_tum(
      "bad_one.tum",
      [](double t) {
        return Position{t > 20 ? 1e5 * (t - 20) : 0.0, 0.0, 0.0};
      },
      10);
  const std::string files = "--trajectory good.tum --trajectory bad_one.tum --truth truth.tum";
  const Outcome csv = call("--csv " + files);
  EXPECT_EQ(csv.exit_code, 1);  // one of them diverged
  EXPECT_THAT(csv.out, AllOf(HasSubstr("good.tum,,,,ok,,100.000,rpe_1m_at_poses_translation,"),
                             HasSubstr("bad_one.tum,,,,diverged,")));
  EXPECT_THAT(call("--markdown " + files).out,
              AllOf(HasSubstr("| good.tum | 100 |"), HasSubstr("| bad_one.tum | - | - |")));
  EXPECT_THAT(call("--latex " + files).out,
              AllOf(HasSubstr("\\toprule"), HasSubstr("bad\\_one.tum & -- & "),
                    HasSubstr(" & diverged: ")));
  const json document = json::parse(call("--json " + files).out);
  EXPECT_EQ(document["runs"].size(), 2U);
  const json& spread = document["statistics"]["algorithms"][""]["rpe_1m_at_poses_translation"];
  EXPECT_EQ(spread["runs"], 2);
  EXPECT_EQ(spread["failures"].size(), 1U);
  EXPECT_THAT(call(files).out, HasSubstr("no value: "));
}

TEST_F(Evaluate, ARunThatFailedInAStudyIsARowWithItsReason) {
  write("crashed/manifest.json",
        R"({"kind": "run", "algorithm": "x", "preset": "y", "sensor": "z",
            "dataset": "nowhere", "status": "failed", "reason": "killed by SIGSEGV"})");
  const Outcome alone = call("crashed");
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.out, HasSubstr("status: failed: killed by SIGSEGV"));
  const Outcome both = call("--csv crashed nothing_here");
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_THAT(both.out, AllOf(HasSubstr("crashed,x:y on z,nowhere,,failed,killed by SIGSEGV,"),
                              HasSubstr("nothing_here,,,,failed,")));
  EXPECT_THAT(refusal("nothing_here"), HasSubstr("not a finished run"));
}

TEST_F(Evaluate, AnotherBodyFrameIsRefusedUntilItsLeverIsGiven) {
  write_tum("truth.tum", tour, 100, "# world_from_body: time[s] x y z[m] qx qy qz qw\n");
  // 0.5 m along x from a body with yaw 0.3 t
  write_tum(
      "lidar.tum",
      [](double t) {
        const Position p = tour(t);
        return Position{p[0] + 0.5 * std::cos(0.3 * t), p[1] + 0.5 * std::sin(0.3 * t), p[2]};
      },
      10, "# map_from_lidar: time[s] x y z[m] qx qy qz qw\n");
  const std::string files = " --trajectory lidar.tum --truth truth.tum";
  EXPECT_THAT(refusal(files), AllOf(HasSubstr("lidar.tum: contains poses of 'lidar'"),
                                    HasSubstr("those of 'body'; give --lever body_from_lidar=")));
  const json metrics = json::parse(call("--json --lever 0.5,0,0,0,0,0,1" + files).out);
  EXPECT_LT(metrics["final"]["ate"]["se3"]["translation"]["max_m"], 1e-6);
  EXPECT_EQ(call("--lever body_from_lidar=0.5,0,0,0,0,0,1" + files).exit_code, 0);
  EXPECT_THAT(refusal("--lever 0.5,0,0" + files), HasSubstr("--lever"));
  // without frame names, the offset is detected and reported, and the file is scored unchanged
  const std::string rows = content(path("lidar.tum"));
  write("silent.tum", rows.substr(rows.find('\n') + 1));
  const Outcome warned = call("--trajectory silent.tum --truth truth.tum");
  EXPECT_THAT(warned.out, HasSubstr("another frame of the body, 0.5 m away"));
}

TEST_F(Evaluate, CompatEvoGivesItsFiguresAndItsRefusals) {
  const auto line = [](double scale) {
    return [scale](double t) { return Position{scale * t, 0.0, 0.0}; };
  };
  write_tum("ref.tum", line(1.0), 10);
  write_tum("est.tum", line(1.01), 10);
  const std::string files = " --compat evo --trajectory est.tum --truth ref.tum";
  const json ape = json::parse(call("--json" + files).out);
  EXPECT_EQ(ape["matched"], 301);
  EXPECT_NEAR(ape["statistics"]["max"], 0.3, 1e-9);
  EXPECT_NEAR(ape["statistics"]["mean"], 0.15, 1e-9);
  const json rpe = json::parse(
      call("--json --metric rpe --relation point_distance_error_ratio --delta 10" + files).out);
  EXPECT_EQ(rpe["errors"], 30);
  EXPECT_NEAR(rpe["statistics"]["rmse"], 1.0, 1e-9);
  EXPECT_EQ(rpe["unit"], "%");
  EXPECT_THAT(call("--metric rpe --unit m --delta 1" + files).out, HasSubstr("evo's rpe"));
  EXPECT_THAT(refusal("--align" + files), HasSubstr("lie on a line or a point"));
  EXPECT_THAT(refusal("--metric rpe --unit d --delta 400" + files), HasSubstr("180 degrees"));
  EXPECT_EQ(call("--metric rpe --trajectory est.tum --truth ref.tum").exit_code, 2);
  EXPECT_EQ(call("--relation nonsense" + files).exit_code, 2);
}

TEST_F(Evaluate, TimesThatRepeatAreCountedAndTheFirstRowIsUsed) {
  write_tum("once.tum", tour, 100);
  write_tum("slam.tum", tour, 10);
  std::istringstream rows(content(path("once.tum")));
  std::string text;
  int row = 0;
  for (std::string line; std::getline(rows, line); ++row) {
    text += line + "\n";
    if (row % 1000 == 10) text += line.substr(0, line.find(' ')) + " 900 0 0 0 0 0 1\n";
  }
  write("truth.tum", text);
  const Outcome plain = call("--trajectory slam.tum --truth once.tum");
  const Outcome scored = call("--trajectory slam.tum --truth truth.tum");
  EXPECT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_THAT(scored.out,
              HasSubstr("truth.tum: 3 rows repeat the time of the row before; the first "
                        "of equal times is used"));
  const auto figures = [](const std::string& out) { return out.substr(out.find("\n  ")); };
  EXPECT_EQ(figures(scored.out), figures(plain.out));
  const Outcome evo = call("--compat evo --trajectory slam.tum --truth truth.tum");
  EXPECT_EQ(evo.exit_code, 0) << evo.err;
  EXPECT_THAT(evo.out, HasSubstr("301 of 301 estimated and 3004 true poses matched"));
}

TEST_F(Evaluate, BadFilesAreOneClearMessageEach) {
  write_tum("truth.tum", tour, 100);
  const auto error_for = [&](const std::string& text) {
    write("bad.txt", text);
    return refusal("--trajectory bad.txt --truth truth.tum");
  };
  EXPECT_THAT(error_for(""), HasSubstr("bad.txt: holds no pose"));
  EXPECT_THAT(error_for("0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("bad.txt:2"), HasSubstr("not finite")));
  EXPECT_THAT(error_for("0 0 0 0 0 0 0 1\n1 0 inf 0 0 0 0 1\n"), HasSubstr("not finite"));
  EXPECT_THAT(error_for("0 0 0 0 0 0 0 0\n"), HasSubstr("norm is 0, not 1"));
  EXPECT_THAT(error_for("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr("earlier"));
  EXPECT_THAT(error_for("1700000000000000000 0 0 0 0 0 0 1\n"), HasSubstr("nanoseconds"));
  EXPECT_THAT(error_for("1 0 0 0 0 2 0 0 0 0 1 0\n"), HasSubstr("not a rotation"));
  EXPECT_THAT(error_for("1 2 3\n"), HasSubstr("columns"));
  EXPECT_THAT(refusal("--trajectory truth.tum --truth none.tum"), HasSubstr("no such file"));
  write("one.tum", "1 0 0 0 0 0 0 1\n");
  EXPECT_THAT(refusal("--trajectory truth.tum --truth one.tum"), HasSubstr("a single pose"));
  const Outcome one = call("--trajectory one.tum --truth truth.tum");
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_THAT(one.out, HasSubstr("no_output: the estimate has a single pose"));
  EXPECT_THAT(refusal("--trajectory truth.tum"), HasSubstr("needs --truth"));
  EXPECT_THAT(refusal("--csv --json --trajectory truth.tum --truth truth.tum"),
              HasSubstr("one of --json, --csv"));
}

}  // namespace
}  // namespace lidarena::testing
