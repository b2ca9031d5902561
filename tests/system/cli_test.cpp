// SPDX-License-Identifier: BSD-3-Clause
// The command-line program: exit codes, error messages, and all steps from a mesh to a report.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Cli, HelpTeachesAndTheVersionIsTold) {
  const Outcome help = call("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("lidarena study --world house"), HasSubstr("evaluate"),
                              HasSubstr("study")));
  for (const char* verb : {"list", "info", "simulate", "run", "evaluate", "study", "status",
                           "report", "convert", "view"}) {
    const Outcome verb_help = call(std::string(verb) + " --help");
    EXPECT_EQ(verb_help.exit_code, 0) << verb;
    EXPECT_THAT(verb_help.out, HasSubstr("--json")) << verb;
  }
  EXPECT_EQ(call("--version").exit_code, 0);
  EXPECT_THAT(call("--version").out, AllOf(HasSubstr("lidarena 0."),
                                           HasSubstr("from the build in /"), HasSubstr("commit ")));
  EXPECT_EQ(call("fly").exit_code, 2);
}

TEST_F(Cli, AloneItSaysWhatItIsForAndHowToBegin) {
  const Outcome outcome = call("");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("which LiDAR, and which SLAM"), HasSubstr("lidarena list sensors"),
                    HasSubstr("lidarena study"), HasSubstr("lidarena run"), HasSubstr("convert")));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Cli, AWrongNameIsToldBeforeWhatIsMissing) {
  EXPECT_THAT(refusal("run fastlio2"), HasSubstr("did you mean 'fast_lio2'?"));
  EXPECT_THAT(refusal("run kiss_icp --preset indor"), HasSubstr("published"));
  EXPECT_THAT(refusal("run fastlio2 nowhere --config none.yaml"), HasSubstr("fast_lio2"));
  EXPECT_THAT(refusal("run kiss_icp"), HasSubstr("needs a dataset"));
  EXPECT_THAT(refusal("run"), HasSubstr("lidarena list algorithms"));
  EXPECT_THAT(refusal("simulate --sensor livox_mid306"), HasSubstr("livox_mid360"));
  EXPECT_THAT(refusal("simulate --world hosue"), HasSubstr("did you mean 'house'?"));
  EXPECT_THAT(refusal("simulate --world house"),
              AllOf(HasSubstr("--flight, --sensor"), HasSubstr("list flights, lidarena list sen")));
  EXPECT_THAT(refusal("study --sensors livox_mid306"), HasSubstr("livox_mid360"));
  EXPECT_THAT(refusal("study --algorithms fastlio2"), HasSubstr("fast_lio2"));
  EXPECT_THAT(refusal("study --world house --auto --sensors livox_mid360"), HasSubstr("--out"));
  EXPECT_THAT(refusal("study quick"), HasSubstr("--out"));
  EXPECT_THAT(call("study quick --dry").out, HasSubstr("24 runs"));
}

TEST_F(Cli, OutputsAreNamedAfterWhatIsInThem) {
  write("room.obj", room_obj());
  write("round.yaml", kRoomFlight);
  const std::string simulate =
      "simulate --json --world room.obj --flight round.yaml --sensor livox_mid360 --seconds 1";
  for (const char* name : {"room-round-livox_mid360", "room-round-livox_mid360-2"}) {
    const Outcome flown = call(simulate);
    ASSERT_EQ(flown.exit_code, 0) << flown.err;
    EXPECT_EQ(nlohmann::json::parse(flown.out).at("dataset"), name);
    EXPECT_THAT(flown.err, HasSubstr(std::string("writes to ") + name));
    EXPECT_TRUE(fs::exists(path(name) + "/manifest.json"));
  }
  for (const char* name : {"room-round-livox_mid360-kiss_icp-published",
                           "room-round-livox_mid360-kiss_icp-published-2"}) {
    const Outcome ran = call("run kiss_icp room-round-livox_mid360/ --preset published");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr(std::string("run: ") + name + "\n"));
    EXPECT_TRUE(fs::exists(path(name) + "/manifest.json"));
  }
}

TEST_F(Cli, InfoTellsWhatAYamlFileDescribesFromItsKeys) {
  const auto info = [&](const std::string& thing) {
    const Outcome outcome = call("info --json " + thing);
    EXPECT_EQ(outcome.exit_code, 0) << thing << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const std::string configs = std::string(LIDARENA_SOURCE_DIR) + "/configs/";
  EXPECT_EQ(info(configs + "worlds/house.yaml").at("kind"), "world");
  EXPECT_GT(info(configs + "worlds/house.yaml").at("triangles"), 1000);
  EXPECT_EQ(info(configs + "flights/house.yaml").at("/flight/duration_s"_json_pointer), 60);
  EXPECT_EQ(info("auto").at("kind"), "flight");
  EXPECT_EQ(info(configs + "sensors/velodyne_vlp16.yaml").at("beams_per_scan"), 16 * 1808);
  EXPECT_EQ(info(configs + "sensors/beams/velodyne_vlp16.yaml").at("beams"), 16);
  EXPECT_EQ(info("quick").at("runs"), 2 * 2 * 6);
  EXPECT_THAT(info(configs + "odometry/ct_icp_subt.yaml").at("algorithms"),
              ::testing::Contains("ct_icp"));
  EXPECT_EQ(info(write("slam.yaml", "name: mine\ncommand: ./mine {input} {output}\n")).at("kind"),
            "external program");
  for (const auto& entry : fs::recursive_directory_iterator(configs)) {
    if (entry.path().extension() == ".yaml") info(entry.path().string());
  }
}

TEST_F(Cli, InfoSaysWhatItTriedWhereTheKeysTellNothing) {
  EXPECT_THAT(refusal("info " + write("a.yaml", "foo: 1\nbar: 2\n")),
              AllOf(HasSubstr("a.yaml"), HasSubstr("foo, bar"), HasSubstr("world, flight, sensor"),
                    HasSubstr("lidarena schema")));
  EXPECT_THAT(refusal("info " + write("b.yaml", "seed: 1\nduration_s: 2\n")),
              AllOf(HasSubstr("b.yaml"), HasSubstr("flight"), HasSubstr("world")));
  EXPECT_THAT(refusal("info " + write("c.yaml", "kind: cave\nsed: 2\n")),
              AllOf(HasSubstr("c.yaml:2"), HasSubstr("seed")));
  EXPECT_THAT(refusal("info " + write("d.yaml", "[1, 2]\n")), HasSubstr("d.yaml"));
  EXPECT_THAT(refusal("info " + write("e.doc", "text")), HasSubstr(".mcap"));
  EXPECT_THAT(refusal("info hause"), HasSubstr("did you mean 'house'?"));
}

TEST_F(Cli, EveryVerbThatTakesAWorldGoesOnWithoutMissingModels) {
#if !LIDARENA_TEST_SDF
  GTEST_SKIP() << "this build cannot read SDF worlds";
#endif
  const std::string box =
      "<model name='m'><link name='l'><visual name='v'><geometry><box><size>20 20 8</size></box>"
      "</geometry></visual></link></model>";
  write("hall.world",
        "<?xml version='1.0'?><sdf version='1.6'><world name='w'><include><uri>model://no_chair"
        "</uri></include><include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun</uri>"
        "</include>" +
            box + "</world></sdf>");
  write("flight.yaml", "kind: waypoints\nwaypoints: [[-3, 0, 0], [3, 0, 0]]\n");
  for (const char* arguments :
       {"info hall.world", "convert hall.world hall.ply", "view hall.world --out view.html",
        "simulate --world hall.world --flight flight.yaml --sensor livox_mid360 --seconds 0.5"}) {
    EXPECT_THAT(refusal(arguments), AllOf(HasSubstr("no_chair"), HasSubstr("--allow-missing")));
    const Outcome outcome = call(std::string(arguments) + " --allow-missing");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no_chair"));
  }
  const Outcome study = call(
      "study --world hall.world --sensors livox_mid360 --algorithms kiss_icp --auto --seconds 1 "
      "--out study --json --allow-missing");
  EXPECT_EQ(study.exit_code, 0) << study.err;
  EXPECT_EQ(nlohmann::json::parse(study.out).at("failed"), 0) << study.out;
}

TEST_F(Cli, SensorsAreListedWithinLimits) {
  const auto names = [&](const std::string& limits) {
    const Outcome list = call("list sensors --json " + limits);
    EXPECT_EQ(list.exit_code, 0) << list.err;
    std::vector<std::string> found;
    for (const auto& entry : nlohmann::json::parse(list.out)) found.push_back(entry.at("name"));
    return found;
  };
  using ::testing::Contains;
  EXPECT_THAT(names("--weight-max 0.3"),
              AllOf(Contains("livox_mid360"), Not(Contains("ouster_os0_128"))));
  EXPECT_THAT(names("--fov-min 59"), AllOf(Contains("livox_mid360"), Contains("ouster_os0_128"),
                                           Not(Contains("velodyne_vlp16"))));
  EXPECT_THAT(names("--fov-min 60 --weight-max 0.5 --points-min 100000"),
              AllOf(Contains("ouster_os0_128"), Not(Contains("livox_mid360"))));
  EXPECT_THAT(names("--points-min 1e6 --range-min 45"),
              AllOf(Contains("ouster_os0_128"), Not(Contains("ouster_os0_128_512"))));
  EXPECT_THAT(names("--power-max 15"),
              AllOf(Contains("livox_mid360"), Not(Contains("ouster_os0_128"))));
  EXPECT_THAT(call("list sensors --weight-max 0.3").err, HasSubstr("livox_avia"));
  EXPECT_THAT(refusal("list worlds --weight-max 0.3"), HasSubstr("list sensors"));
}

TEST_F(Cli, EveryListedNameIsUsable) {
  for (const char* kind : {"worlds", "flights", "sensors", "algorithms", "studies"}) {
    const Outcome list = call(std::string("list --json ") + kind);
    ASSERT_EQ(list.exit_code, 0) << list.err;
    const auto json = nlohmann::json::parse(list.out);
    EXPECT_FALSE(json.empty()) << kind;
    if (std::string(kind) != "sensors") continue;
    for (const auto& entry : json) {
      const std::string name = entry.at("name");
      const Outcome info = call("info --json " + name);
      EXPECT_EQ(info.exit_code, 0) << name << info.err;
      EXPECT_GT(nlohmann::json::parse(info.out).at("points_per_second").get<double>(), 1000.0);
    }
  }
}

TEST_F(Cli, TheFirstRaysOfASensorComeAsCsv) {
  const Outcome rays = call("info livox_mid360 --rays 8");
  ASSERT_EQ(rays.exit_code, 0) << rays.err;
  EXPECT_THAT(rays.out, HasSubstr("index,dt_ns,x,y,z,ring\n0,0,-0.0108079"));
  EXPECT_EQ(std::count(rays.out.begin(), rays.out.end(), '\n'), 9);
}

TEST_F(Cli, NumPyReadsTheShotsOfAPattern) {
  const std::string npy = path("p.npy");
  const Outcome written = call("info --json livox_mid360 --pattern --seconds 0.2 --out " + npy);
  ASSERT_EQ(written.exit_code, 0) << written.err;
  EXPECT_EQ(nlohmann::json::parse(written.out).at("shots"), 40'000);
  EXPECT_EQ(nlohmann::json::parse(written.out).at("repeats_after_scans"), 120);
  EXPECT_THAT(refusal("info livox_mid360 --pattern --out " + path("p.mat")),
              HasSubstr(".mat3x4f (RobotecGPULidar)"));
  EXPECT_THAT(refusal("info livox_mid360 --pattern --seconds 1"), HasSubstr("--out FILE.npy"));
  EXPECT_THAT(refusal("info livox_mid360 --seconds 1"), HasSubstr("add --pattern"));
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)
    GTEST_SKIP() << "no NumPy";
  const std::string check =
      "import numpy as n; a = n.load(\"" + npy +
      "\"); assert a.shape == (40000, 8) and a.dtype == n.float64;"
      "assert abs(n.linalg.norm(a[:, 1:4], axis=1) - 1).max() < 1e-6;"
      "assert n.allclose(n.diff(a[:, 0]), 5e-6, atol=1e-12);"
      "assert abs(a[0, 1] + 0.0108079) < 1e-7 and set(a[:, 4]) == {0, 1, 2, 3}";
  EXPECT_EQ(std::system(("/usr/bin/python3 -c '" + check + "'").c_str()), 0);
}

TEST_F(Cli, BadInputIsOneClearErrorWithExitCode2) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string rest = " --sensor livox_mid360 --out " + path("data");

  const std::string no_faces = write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_THAT(refusal("simulate --world " + no_faces + " --flight " + flight + rest),
              AllOf(HasSubstr("points.obj"), HasSubstr("no faces")));

  const std::string sdf = write("bad.sdf",
                                "<?xml version='1.0'?><sdf version='1.6'><world name='w'>"
                                "<include><uri>model://no_such_chair</uri></include>"
                                "</world></sdf>");
  EXPECT_THAT(refusal("simulate --world " + sdf + " --flight " + flight + rest),
              AllOf(HasSubstr("bad.sdf"),
                    HasSubstr(LIDARENA_TEST_SDF ? "no_such_chair" : "cannot read SDF worlds")));

  const std::string through = write(
      "through.yaml", "kind: waypoints\nwaypoints: [[2, 2, 1.5], [14, 2, 1.5], [2, 2, 1.5]]\n");
  EXPECT_THAT(refusal("simulate --world " + room + " --flight " + through + rest),
              AllOf(HasSubstr("through.yaml"), HasSubstr(" m")));

  EXPECT_THAT(refusal("simulate --world " + room + " --flight " + flight +
                      " --sensor livox_mid306 --out " + path("data")),
              HasSubstr("did you mean 'livox_mid360"));
  EXPECT_THAT(refusal("simulate --world hosue --flight " + flight + rest),
              HasSubstr("did you mean 'house'?"));
  EXPECT_THAT(refusal("simulate --mode frosen --world " + room + " --flight " + flight + rest),
              HasSubstr("use one of rolling, frozen"));
  EXPECT_FALSE(fs::exists(path("data") + "/manifest.json"))
      << "a failed call must not leave a complete dataset";
  EXPECT_THAT(refusal("run kiss_icp " + path("nowhere") + " --out " + path("run")),
              HasSubstr("nowhere"));
}

TEST_F(Cli, FromAMeshToAScoredMap) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string data = path("data");
  const std::string run = path("run");
  const Outcome simulated = call("simulate --world " + room + " --flight " + flight +
                                 " --sensor livox_mid360 --seconds 8 --out " + data);
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  for (const char* file :
       {"data.mcap", "truth.tum", "world.ply", "manifest.json", "metadata.yaml"}) {
    EXPECT_TRUE(fs::exists(fs::path(data) / file)) << file;
  }
  const Outcome ran = call("run --json kiss_icp " + data + " --out " + run);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out).at("scans"), 80);

  const Outcome scored = call("evaluate --json " + run);
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto metrics = nlohmann::json::parse(scored.out);
  EXPECT_EQ(metrics.at("status"), "ok");
  // In this easy room, a working odometry has an RPE below 10 % of the path, and most of its map is
  // within a few standard deviations of the range noise from the mesh.
  EXPECT_LT(metrics.at("/final/rpe/1m/translation/rmse_m"_json_pointer).get<double>(), 0.10);
  EXPECT_LT(metrics.at("/maps/reprojected/se3/distance/median_m"_json_pointer).get<double>(), 0.10);
  EXPECT_GT(metrics.at("/final/association/coverage"_json_pointer).get<double>(), 0.95);

  const Outcome paged = call("report " + run);
  ASSERT_EQ(paged.exit_code, 0) << paged.err;
  if (!LIDARENA_TEST_VIEWER) return;  // without it, a report is data and tables
  const std::string page = content(fs::path(run) / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<!doctype html>"), HasSubstr("base64,"),
                          HasSubstr("point-to-mesh distance")));
  for (const char* reach :
       {"src='http", "src=\"http", "href='http", "href=\"http", "<script src"}) {
    EXPECT_THAT(page, Not(HasSubstr(reach))) << "the page must not need the network";
  }
  for (const char* picture : {"world-data", "map-data-livox_mid360-kiss_icp-indoor"}) {
    const std::string svg = content(fs::path(run) / "figures" / (std::string(picture) + ".svg"));
    EXPECT_THAT(svg, AllOf(HasSubstr("<svg xmlns="), HasSubstr("data:image/png;base64,")))
        << picture;
  }
}

TEST_F(Cli, ADivergedRunIsWrittenWholeWithExitCode1) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  ASSERT_EQ(call("simulate --world " + room + " --flight " + flight +
                 " --sensor livox_mid360 --seconds 1 --out " + path("data"))
                .exit_code,
            0);
  // With a mounting near the largest double, the body's poses are not finite.
  const Outcome ran = call("run kiss_icp " + path("data") + " --out " + path("run") +
                           " --extrinsics body_from_lidar=1.7e308,1.7e308,0,0,0,0.6,0.8");
  EXPECT_EQ(ran.exit_code, 1) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("the run diverged"));
  const auto manifest = nlohmann::json::parse(content(path("run") + "/manifest.json"));
  EXPECT_EQ(manifest.at("status"), "diverged");
  for (const char* file :
       {"trajectory.tum", "live.tum", "map.ply", "resources.csv", "events.csv"}) {
    EXPECT_TRUE(fs::exists(fs::path(path("run")) / file)) << file;
  }
}

TEST_F(Cli, AManifestAloneIsFlownWithTheSamePoints) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string call_simulate = "simulate --world " + room + " --flight " + flight +
                                    " --sensor livox_mid360 --seconds 3 --out ";
  ASSERT_EQ(call(call_simulate + path("full")).exit_code, 0);
  ASSERT_EQ(call(call_simulate + path("bare") + " --no-data").exit_code, 0);
  EXPECT_FALSE(fs::exists(path("bare") + "/data.mcap"));
  ASSERT_EQ(call("run kiss_icp " + path("full") + " --threads 1 --out " + path("a")).exit_code, 0);
  ASSERT_EQ(call("run kiss_icp " + path("bare") + " --threads 2 --out " + path("b")).exit_code, 0);
  EXPECT_TRUE(same(path("a") + "/trajectory.tum", path("b") + "/trajectory.tum"));
  EXPECT_TRUE(same(path("a") + "/map.ply", path("b") + "/map.ply"));
  EXPECT_TRUE(same(path("a") + "/events.csv", path("b") + "/events.csv"));
  EXPECT_TRUE(same(path("full") + "/truth.tum", path("bare") + "/truth.tum"));
}

TEST_F(Cli, AManifestAloneLeavesNoOlderMeasurementsToBeTakenForItsOwn) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string call_simulate = "simulate --world " + room + " --flight " + flight +
                                    " --sensor livox_mid360 --out " + path("data");
  ASSERT_EQ(call(call_simulate + " --seconds 3").exit_code, 0);
  ASSERT_EQ(call(call_simulate + " --seconds 1 --no-data").exit_code, 0);
  EXPECT_FALSE(fs::exists(path("data") + "/data.mcap"));
  const Outcome ran = call("run --json kiss_icp " + path("data") + " --out " + path("run"));
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out).at("scans"), 10)
      << "scans of the second call (1 s), not the first";
}

TEST_F(Cli, ARecordedFlightIsFlownAnewFromTheDatasetItself) {
  const std::string room = write("room.obj", room_obj());
  const std::string rest = " --sensor livox_mid360 --seconds 2 --no-data --out ";
  ASSERT_EQ(call("simulate --world " + room + " --flight " + write("flight.yaml", kRoomFlight) +
                 rest + path("first"))
                .exit_code,
            0);
  fs::copy_file(path("first") + "/truth.tum", path("recording.tum"));
  const std::string replay = write("replay.yaml", "kind: replay\nreplay: recording.tum\n");
  const Outcome flown =
      call("simulate --world " + room + " --flight " + replay + rest + path("re"));
  ASSERT_EQ(flown.exit_code, 0) << flown.err;
  fs::remove(path("recording.tum"));
  const Outcome ran = call("run kiss_icp " + path("re") + " --out " + path("run"));
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

TEST_F(Cli, TheTimingModesDifferInMotionAndStampsAlone) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const auto counts = [&](const std::string& mode) {
    EXPECT_EQ(call("simulate --noise off --seconds 2 --mode " + mode + " --world " + room +
                   " --flight " + flight + " --sensor livox_mid360 --out " + path(mode))
                  .exit_code,
              0);
    const Outcome info = call("info --json " + path(mode));
    return nlohmann::json::parse(info.out).at("topics").at("livox_mid360/points");
  };
  EXPECT_EQ(counts("rolling").at("untimed_scans"), 0);
  EXPECT_EQ(counts("frozen").at("untimed_scans"), 0);
  EXPECT_EQ(counts("frozen_unstamped").at("untimed_scans"), 20);
  EXPECT_EQ(counts("frozen_ramp").at("untimed_scans"), 0);
}

TEST_F(Cli, PointsAtTheOriginForShotsWithoutAReturnAreStoredAndReadAgain) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const auto points = [&](const std::string& misses) {
    const Outcome made = call("simulate --seconds 1 --world " + room + " --flight " + flight +
                              " --sensor livox_mid360 --set sensor.max_range_m=4" +
                              " --set sensor.returns.misses=" + misses + " --out " + path(misses));
    EXPECT_EQ(made.exit_code, 0) << made.err;
    const Outcome info = call("info --json " + path(misses));
    return nlohmann::json::parse(info.out)["topics"]["livox_mid360/points"]["points"].get<int>();
  };
  const int returns = points("left_out");
  EXPECT_GT(returns, 0);
  EXPECT_LT(returns, 190'000);
  EXPECT_EQ(points("origin"), 10 * 20'000);
}

TEST_F(Cli, SameSeedSameBytesAndATruncatedDatasetIsNeverTakenForWhole) {
  const std::string room = write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string call_simulate = "simulate --world " + room + " --flight " + flight +
                                    " --sensor livox_mid360 --seconds 2 --out ";
  ASSERT_EQ(call(call_simulate + path("one") + " --threads 1").exit_code, 0);
  ASSERT_EQ(call(call_simulate + path("two") + " --threads 3").exit_code, 0);
  const fs::path mcap = path("one") + "/data.mcap";
  EXPECT_TRUE(same(mcap, path("two") + "/data.mcap"));
  ASSERT_EQ(call(call_simulate + path("three") + " --seed 2").exit_code, 0);
  EXPECT_FALSE(same(mcap, path("three") + "/data.mcap"));

  fs::resize_file(mcap, fs::file_size(mcap) / 2);
  const Outcome cut = call("run kiss_icp " + path("one") + " --out " + path("run"));
  EXPECT_EQ(cut.exit_code, 1) << "what is whole is used";
  EXPECT_THAT(cut.err, AllOf(HasSubstr("data.mcap"), HasSubstr("cut off")));
  const auto manifest = nlohmann::json::parse(content(path("run") + "/manifest.json"));
  EXPECT_THAT(manifest.at("recording_ended").get<std::string>(), HasSubstr("cut off"));
}

}  // namespace
}  // namespace lidarena::testing
