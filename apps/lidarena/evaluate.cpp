// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/evaluate_cloud.hpp"
#include "apps/lidarena/evaluate_evo.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/results/metrics_table.hpp"
#include "lidarena/results/run_statistics.hpp"
#include "lidarena/stages/score_run.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
  std::vector<std::string> score;  ///< parts
  std::vector<std::string> runs;
  std::vector<std::string> trajectories;
  std::string truth, map, mesh, reference;
  std::string topic, truth_topic, lever;
  double rate_hz = 10.0;
  bool csv = false, markdown = false, latex = false;
  EvoArguments evo;
};

/// Reads a file of poses, or the truth of a dataset folder.
dataset::FramedTrajectory read_poses(const std::string& path, const std::string& topic,
                                     double rate_hz) {
  if (!fs::is_directory(path)) return dataset::read_framed_trajectory(path, topic, rate_hz);
  const auto truth = dataset::load_truth(path);
  if (!truth) throw InputError(path, "contains no truth", "give a file of poses");
  return {*truth, "world", "body"};
}

Pose parse_lever(const std::string& text) {
  const std::string place = "--lever " + text;
  const std::string numbers =
      text.substr(text.find('=') == std::string::npos ? 0 : text.find('=') + 1);
  Pose pose;
  read_value(ConfigNode::parse("[" + numbers + "]", place), pose, {});
  return pose;
}

/// The estimate as poses of the truth's body frame. Throws InputError if no `lever` is given and
/// both files name their body frame, with different names.
dataset::FramedTrajectory in_body_of_truth(dataset::FramedTrajectory estimate,
                                           const dataset::FramedTrajectory& truth,
                                           const std::string& name, const std::string& lever) {
  if (!lever.empty()) {
    const Pose body_from_estimate = parse_lever(lever);
    estimate.trajectory = evaluation::moved_to_body(estimate.trajectory, body_from_estimate);
    for (StampedPose& pose : estimate.repeated)
      pose.world_from_body = pose.world_from_body * body_from_estimate.inverse();
    return estimate;
  }
  if (!estimate.body.empty() && !truth.body.empty() && estimate.body != truth.body) {
    throw InputError(
        name,
        fmt::format("contains poses of '{}', the truth those of '{}'", estimate.body, truth.body),
        fmt::format("give --lever {}_from_{}=x,y,z,qx,qy,qz,qw", truth.body, estimate.body));
  }
  return estimate;
}

/// Says what was assumed about poses, and where their file ended too early.
void warn_of_reading(const dataset::FramedTrajectory& poses, results::RunMetrics& metrics,
                     LogSink& log) {
  for (const std::string& text : {poses.note, poses.ended}) {
    if (text.empty()) continue;
    metrics.warnings.push_back(text);
    log.warn(text);
  }
}

/// Says of how many rows the first of equal times is used; nothing if no time is repeated.
void warn_of_repeats(const dataset::FramedTrajectory& poses, const std::string& name,
                     results::RunMetrics& metrics, LogSink& log) {
  if (poses.repeated.empty()) return;
  metrics.warnings.push_back(
      fmt::format("{}: {} rows repeat the time of the row before; the first of equal times is used",
                  name, poses.repeated.size()));
  log.warn(metrics.warnings.back());
}

/// Trajectories and a map given as files, without a RUN folder.
class Files {
 public:
  explicit Files(const EvaluateOptions& o) : o_(o) {
    if (o.truth.empty()) throw InputError("--trajectory", "needs --truth FILE");
    if (o.map.empty() && !(o.mesh + o.reference).empty())
      throw InputError("--mesh, --reference", "need a map to score", "add --map CLOUD");
    if (!o.map.empty() && o.trajectories.size() > 1) {
      throw InputError("--map", "needs exactly one --trajectory, in whose frame the map is");
    }
    truth_ = read_poses(o.truth, o.truth_topic, o.rate_hz);
    if (truth_.trajectory.size() < 2) {
      throw InputError(o.truth, "contains a single pose; a truth needs at least two");
    }
    if (o.map.empty()) return;
    map_ = dataset::read_cloud(o.map, true);
    if (!o.mesh.empty()) world_ = std::make_unique<world::World>(world::load_mesh(o.mesh), o.mesh);
  }
  const dataset::FramedTrajectory& truth() const { return truth_; }
  dataset::FramedTrajectory estimate(const std::string& file) const {
    return in_body_of_truth(read_poses(file, o_.topic, o_.rate_hz), truth_, file, o_.lever);
  }
  const dataset::Cloud& map() const { return map_; }
  results::ScoredRun score(const std::string& file, const Parallel& parallel, LogSink& log) const {
    dataset::RunFiles run;
    const dataset::FramedTrajectory read = estimate(file);
    run.trajectory = evaluation::moved_by(read.trajectory, -map_.origin);
    run.live = run.trajectory;
    run.map = map_;
    results::ScoredRun scored;
    scored.name = file;
    scored.metrics = evaluation::evaluate_run(run, truth_.trajectory, world_.get(), parallel, log);
    scored.metrics.frames = {truth_.body, o_.lever};
    warn_of_repeats(truth_, o_.truth, scored.metrics, log);
    warn_of_repeats(read, file, scored.metrics, log);
    warn_of_reading(truth_, scored.metrics, log);
    warn_of_reading(read, scored.metrics, log);
    scored.is_cut = !truth_.ended.empty() || !read.ended.empty();
    return scored;
  }

 private:
  const EvaluateOptions& o_;
  dataset::FramedTrajectory truth_;
  dataset::Cloud map_;
  std::unique_ptr<world::World> world_;
};

/// Fills in algorithm, flight and seed from the manifests of the run and of its dataset.
void describe(const fs::path& folder, results::ScoredRun& run) {
  if (!dataset::is_run(folder)) return;
  const dataset::RunManifest manifest = dataset::read_run_manifest(folder);
  run.algorithm = fmt::format("{}{}{} on {}", manifest.algorithm,
                              manifest.preset.empty() ? "" : ":", manifest.preset, manifest.sensor);
  const fs::path dataset = folder / manifest.dataset;
  run.flight = dataset.filename().string();
  const auto flown = dataset::read_dataset_manifest(dataset);
  if (!flown || !flown->simulation) return;
  run.seed = std::to_string(flown->simulation->seed);
  run.flight = fmt::format("{} {}", fs::path(flown->simulation->world).stem().string(),
                           fs::path(flown->simulation->flight_source).stem().string());
}

/// Why a run of a study failed; empty if it did not.
std::string failure_of(const fs::path& folder) {
  if (!dataset::is_run(folder)) return {};
  const dataset::RunManifest manifest = dataset::read_run_manifest(folder);
  return manifest.status == dataset::RunStatus::kFailed ? manifest.reason : std::string();
}

/// Scores a RUN folder. If that is impossible, throws if it is the only folder (`alone`), else
/// returns the status "failed" with the reason.
results::ScoredRun score_folder(const fs::path& folder, const stages::ScoreParts& parts, bool alone,
                                const stages::GivenTruth* truth, const Parallel& parallel,
                                LogSink& log) {
  results::ScoredRun run;
  const bool ends_with_slash = folder.filename().empty();  // "run/"
  run.name = (ends_with_slash ? folder.parent_path() : folder).filename().string();
  try {
    describe(folder, run);
    const std::string failure = failure_of(folder);
    run.metrics = failure.empty() ? stages::score_run(folder, parts, parallel, log, truth)
                                  : results::failed_metrics(failure);
  } catch (const InputError& error) {
    if (alone) throw;
    run.metrics = results::failed_metrics(error.what());
  }
  return run;
}

/// The truth for RUN folders, if one is given.
std::optional<stages::GivenTruth> given_truth(const EvaluateOptions& o, LogSink& log) {
  if (o.runs.empty() || o.truth.empty()) return std::nullopt;
  stages::GivenTruth given{read_poses(o.truth, o.truth_topic, o.rate_hz), o.lever, {}};
  if (!o.lever.empty()) given.truth_from_body = parse_lever(o.lever);
  for (const std::string& text : {given.poses.note, given.poses.ended})
    if (!text.empty()) log.warn(text);
  return given;
}

stages::ScoreParts score_parts_of(const std::vector<std::string>& names) {
  stages::ScoreParts parts;
  for (const std::string& name : names)
    read_value(ConfigNode::parse(name, "--score"), parts.emplace_back(), {});
  return parts;
}

/// Scores a map without a mesh, in the frame that the alignment of the poses gives it.
Json score_map_alone(const EvaluateOptions& o, const Parallel& parallel, LogSink& log) {
  if (o.trajectories.empty())
    return cloud_scores(dataset::read_cloud(o.map, true), o.reference, Pose::Identity(), parallel);
  const Files files(o);
  const results::ScoredRun run = files.score(o.trajectories.front(), parallel, log);
  const auto truth_from_map = results::truth_from_estimate(run.metrics);
  if (!o.reference.empty() && !truth_from_map)
    throw InputError(o.trajectories.front(), "cannot be aligned with the truth",
                     "leave out both, with map and reference in one frame");
  return cloud_scores(
      files.map(), o.reference,
      truth_from_map.value_or(Pose::Identity()) * Eigen::Translation3d(-files.map().origin),
      parallel);
}

std::vector<results::ScoredRun> score_all(const EvaluateOptions& o, const Parallel& parallel,
                                          LogSink& log) {
  std::vector<results::ScoredRun> runs;
  const stages::ScoreParts parts = score_parts_of(o.score);
  const std::optional<stages::GivenTruth> truth = given_truth(o, log);
  for (const std::string& folder : o.runs) {
    runs.push_back(
        score_folder(folder, parts, o.runs.size() == 1, truth ? &*truth : nullptr, parallel, log));
  }
  if (o.trajectories.empty()) return runs;
  const Files files(o);
  for (const std::string& file : o.trajectories) runs.push_back(files.score(file, parallel, log));
  return runs;
}

void print_runs_json(const std::vector<results::ScoredRun>& runs) {
  if (runs.size() == 1) return print_json(to_json(runs[0].metrics));
  Json list = Json::array();
  for (const results::ScoredRun& run : runs) {
    list.push_back({{"run", run.name},
                    {"algorithm", run.algorithm},
                    {"flight", run.flight},
                    {"seed", run.seed},
                    {"metrics", to_json(run.metrics)}});
  }
  print_json({{"runs", list}, {"statistics", to_json(results::statistics_of(runs))}});
}

void print_runs(const Common& common, const EvaluateOptions& o,
                const std::vector<results::ScoredRun>& runs) {
  if (common.json) return print_runs_json(runs);
  if (o.csv) return fmt::print("{}", results::metrics_csv(runs));
  if (o.markdown) return fmt::print("{}", results::metrics_markdown(runs));
  if (o.latex) return fmt::print("{}", results::metrics_latex(runs));
  for (const results::ScoredRun& run : runs) fmt::print("{}\n", results::metrics_text(run));
  if (runs.size() > 1) fmt::print("{}", results::statistics_text(results::statistics_of(runs)));
}

int evaluate_as_evo(const Common& common, const EvaluateOptions& o) {
  if (o.trajectories.size() != 1 || !o.map.empty()) {
    throw InputError("--compat evo", "needs exactly one --trajectory with --truth, and no map");
  }
  const Files files(o);
  const Json result =
      evo_json(files.truth().rows(), files.estimate(o.trajectories[0]).rows(), o.evo);
  if (common.json) {
    print_json(result);
  } else {
    fmt::print("{}", evo_text(result));
  }
  return kDone;
}

/// A map without a mesh: against a reference cloud, or by itself.
int evaluate_map_alone(const Common& common, const EvaluateOptions& o) {
  Console console(common.quiet);
  const Json scores = score_map_alone(o, Parallel(common.threads), console);
  if (common.json) {
    print_json(scores);
  } else {
    fmt::print("{}\n{}", o.map, cloud_text(scores));
  }
  return kDone;
}

int evaluate_verb(const Common& common, const EvaluateOptions& o) {
  if (o.runs.empty() && !o.map.empty() && o.mesh.empty()) return evaluate_map_alone(common, o);
  if (o.runs.empty() == o.trajectories.empty()) {
    throw InputError("evaluate", "needs either RUN folders or --trajectory and --truth");
  }
  if (o.trajectories.empty() && !(o.map + o.mesh).empty())
    throw InputError("evaluate", "--map and --mesh need --trajectory");
  if (o.truth.empty() && !o.lever.empty())
    throw InputError("evaluate", "--lever needs --truth", "add --truth FILE");
  if (int{common.json} + int{o.csv} + int{o.markdown} + int{o.latex} > 1) {
    throw InputError("evaluate", "takes at most one of --json, --csv, --markdown, --latex");
  }
  if (!o.evo.tool.empty()) return evaluate_as_evo(common, o);
  Console console(common.quiet);
  const std::vector<results::ScoredRun> runs = score_all(o, Parallel(common.threads), console);
  print_runs(common, o, runs);
  for (const results::ScoredRun& run : runs) {
    if (!run.metrics.is_ok() || run.is_cut) return kWorkFailed;
  }
  return kDone;
}

}  // namespace

void add_evaluate(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "evaluate", "Score runs, or trajectories and a map of any program, against truth and mesh");
  auto o = std::make_shared<EvaluateOptions>();
  verb->add_option("runs", o->runs, "RUN folders; metrics.json is written into each");
  verb->add_option("--score", o->score,
                   "What of a RUN is scored: trajectory, map, vertices (the distance to the mesh's "
                   "vertices, too); default: trajectory,map. A map takes most of the time")
      ->delimiter(',')
      ->check(CLI::IsMember({"trajectory", "map", "vertices"}));
  verb->add_option("--trajectory", o->trajectories,
                   "Estimate: TUM, KITTI or EuRoC csv, .mcap or .bag; several may be given");
  verb->add_option("--truth", o->truth,
                   "Truth: a file in any of these formats, or a dataset folder; of RUN folders the "
                   "default is that of their dataset");
  verb->add_option("--topic", o->topic, "Topic of the estimate's poses in a bag");
  verb->add_option("--truth-topic", o->truth_topic, "Topic of the truth's poses in a bag");
  verb->add_option("--rate", o->rate_hz, "Poses per second of KITTI files without times.txt")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--lever", o->lever,
                   "Pose of the estimate's body frame in the truth's: x,y,z,qx,qy,qz,qw");
  verb->add_option("--map", o->map, "Point cloud in the estimate's frame: PLY or PCD");
  verb->add_option("--mesh", o->mesh, "Mesh to score the map against");
  verb->add_option("--reference", o->reference,
                   "Point cloud to score the map against, in the truth's frame (without "
                   "--trajectory: in the map's); without mesh and reference, the map's agreement "
                   "with itself");
  verb->add_flag("--csv", o->csv, "Print CSV, one row per metric");
  verb->add_flag("--markdown", o->markdown, "Print a Markdown table, one row per run");
  verb->add_flag("--latex", o->latex, "Print that table for LaTeX (booktabs)");
  add_evo_options(*verb, o->evo);
  set_verb(
      *verb, common, [&common, o] { return evaluate_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
