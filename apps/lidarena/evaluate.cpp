// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/cloud.hpp"
#include "lidarena/dataset/trajectory_io.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena {
namespace {

struct EvaluateOptions {
  std::string run;
  std::string trajectory, truth, map, mesh;
};

/// Anyone's trajectory and map, with no RUN folder around them.
Json evaluate_files(const EvaluateOptions& o, const Parallel& parallel, LogSink& log) {
  if (o.truth.empty()) throw InputError("--trajectory", "needs --truth FILE beside it");
  if (o.map.empty() != o.mesh.empty()) throw InputError("--map, --mesh", "need each other");
  RunFiles run;
  run.trajectory = read_trajectory(o.trajectory);
  run.live = run.trajectory;
  std::unique_ptr<World> world;
  if (!o.map.empty()) {
    run.map = read_cloud(o.map);
    world = std::make_unique<World>(load_mesh(o.mesh), o.mesh);
  }
  return evaluate_run(run, read_trajectory(o.truth), world.get(), parallel, log);
}

std::string row_of(const Json& metrics, const std::string& name, const std::string& path,
                   double factor, const char* unit) {
  const Json::json_pointer pointer(path);
  if (!metrics.contains(pointer) || !metrics.at(pointer).is_number()) return "";
  return fmt::format("  {:<34}{:>10.3f} {}\n", name, metrics.at(pointer).get<double>() * factor,
                     unit);
}

/// The association first, then the main figures.
std::string summary_text(const Json& m) {
  std::string text = fmt::format("status: {}{}\n", m.value("status", ""),
                                 m.value("reason", "").empty() ? "" : ": " + m.value("reason", ""));
  for (const Json& warning : m.at("warnings")) {
    text += fmt::format("warning: {}\n", warning.get<std::string>());
  }
  if (m.at("final").is_null()) return text;
  const Json& found = m.at("final").at("association");
  text += fmt::format(
      "  {} of {} poses matched, longest gap {:.2f} s\n", found.at("matched").get<std::size_t>(),
      found.at("estimates").get<std::size_t>(), found.at("longest_gap_s").get<double>());
  constexpr double kDegrees = 57.29577951308232;
  text += row_of(m, "coverage", "/final/association/coverage", 100, "%");
  text += row_of(m, "RPE per metre", "/final/rpe/1m/translation/rmse_m", 100, "cm");
  text += row_of(m, "RPE per metre, rotation", "/final/rpe/1m/rotation/rmse_rad", kDegrees, "deg");
  text += row_of(m, "RPE per second", "/final/rpe/1s/translation/rmse_m", 100, "cm");
  text += row_of(m, "ATE, SE(3) gauge", "/final/ate/se3/translation/rmse_m", 100, "cm");
  text += row_of(m, "ATE, first-pose gauge", "/final/ate/first_pose/translation/rmse_m", 100, "cm");
  for (const char* map : {"own", "reprojected"}) {
    const std::string base = fmt::format("/maps/{}/se3", map);
    text += row_of(m, fmt::format("{} map, RMSE", map), base + "/distance/rmse_m", 100, "cm");
    text +=
        row_of(m, fmt::format("{} map, RMSE of inliers", map), base + "/rmse_inliers_m", 100, "cm");
    text += row_of(m, fmt::format("{} map, beyond 20 cm", map), base + "/outliers_percent", 1, "%");
  }
  return text;
}

int evaluate_verb(const Common& common, const EvaluateOptions& o) {
  if (o.run.empty() == o.trajectory.empty()) {
    throw InputError("evaluate", "needs either a RUN folder or --trajectory and --truth");
  }
  Console console(common.quiet);
  const Parallel parallel(common.threads);
  const Json metrics =
      o.run.empty() ? evaluate_files(o, parallel, console) : score_run(o.run, parallel, console);
  if (common.json) {
    print_json(metrics);
  } else {
    fmt::print("{}", summary_text(metrics));
  }
  return metrics.value("status", "") == "ok" ? kDone : kWorkFailed;
}

}  // namespace

void add_evaluate(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "evaluate", "Score a run, or anyone's trajectory and map, against truth and mesh");
  auto o = std::make_shared<EvaluateOptions>();
  verb->add_option("run", o->run, "A RUN folder; metrics.json is written into it");
  verb->add_option("--trajectory", o->trajectory, "Estimate: TUM, KITTI or EuRoC csv");
  verb->add_option("--truth", o->truth, "Truth, in any of these formats");
  verb->add_option("--map", o->map, "Point cloud in the estimate's frame: PLY or PCD");
  verb->add_option("--mesh", o->mesh, "Mesh to score the map against");
  set_verb(
      *verb, common, [&common, o] { return evaluate_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
