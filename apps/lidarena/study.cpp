// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <map>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/study_calls.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/report/report.hpp"
#include "lidarena/results/version_comparison.hpp"
#include "lidarena/study/plan.hpp"
#include "lidarena/study/program.hpp"
#include "lidarena/study/slurm.hpp"
#include "lidarena/study/study_programs.hpp"

namespace lidarena {
namespace {

/// The last signal that asks the study to end; handlers can only write to a global.
std::atomic<int> stop_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

/// SIGUSR1 asks the study to end soon; Ctrl-C and SIGTERM at once.
study::Stop asked_to_stop() {
  const int signal = stop_signal;
  if (signal == 0) return study::Stop::kNo;
  return signal == SIGUSR1 ? study::Stop::kSoon : study::Stop::kNow;
}

}  // namespace

void listen_to_signals() {
  for (const int signal : {SIGUSR1, SIGTERM, SIGINT})
    std::signal(signal, [](int received) { stop_signal = received; });
}

study::StudyOptions local_study(const Common& common) {
  study::StudyOptions options;
  options.threads = common.threads;
  options.program = "/proc/self/exe";
  options.stop = asked_to_stop;
  return options;
}

namespace {

struct StudyRequest {
  std::string name;  ///< name or file of a study; empty: made from the fields below
  std::string world;
  std::vector<std::string> sensors;
  std::vector<std::string> algorithms{"all"};
  std::vector<std::string> programs;
  bool tour = false;  ///< plan a tour of the world automatically
  double seconds = 0.0;
  bool allow_missing = false;
  std::string out;
  bool dry = false;
  int jobs = 1;
  std::string shard = "1/1";
  bool worker = false;
  std::string scratch;
  std::optional<double> scratch_gb;
  std::vector<std::filesystem::path> known;
  double grace_s = 0.0;
  bool slurm = false;
  bool print = false;
  study::SlurmOptions cluster;
};

/// A study of one world on an automatically planned tour; the algorithm "all" stands for every one.
/// Sensors and algorithms are judged before anything is said to be missing.
study::StudySpec spec_of_one_world(const StudyRequest& request,
                                   const stages::ConfigFolder& configs) {
  for (const std::string& sensor : request.sensors) configs.resolve("sensors", sensor);
  for (const std::string& algorithm : request.algorithms) {
    if (algorithm != "all") odometry::check_algorithm(study::parse_algorithm(algorithm));
  }
  if (request.world.empty()) {
    throw InputError("study", "neither a study nor a world is given",
                     "name a study, or give --world and --sensors");
  }
  if (!request.tour) {
    throw InputError("study --world", "has no flight", "give --auto to plan a tour of the world");
  }
  study::StudySpec spec;
  spec.title = "Which LiDAR, which SLAM: " + std::filesystem::path(request.world).stem().string();
  spec.scenes = {{request.world, "auto", request.seconds, request.allow_missing}};
  spec.sensors = request.sensors;
  for (const std::string& algorithm : request.algorithms) {
    if (algorithm != "all") {
      spec.algorithms.push_back(algorithm);
      continue;
    }
    for (const odometry::AlgorithmInfo& info : odometry::list_algorithms())
      spec.algorithms.push_back(info.name);
  }
  return spec;
}

/// The runs of a shard, with estimated time and disk space; what is simulated once, and what anew
/// for each run.
void print_plan(const study::StudyPlan& plan, const study::Shard& shard,
                const stages::ConfigFolder& configs, std::uint64_t budget) {
  double seconds = 0.0, disk_mb = 0.0;
  std::size_t runs = 0;
  std::string datasets;
  for (const std::size_t i : units_of(plan, shard)) {
    const study::PlanUnit& unit = plan.units[i];
    for (const std::size_t cell : unit.cells) {
      const study::CellEstimate one = study::estimate(plan.spec, plan.cells[cell], configs);
      const double mb = one.record_mb + (plan.spec.keep_maps ? one.maps_mb : 0.0);
      fmt::print("{:70} {:>8} {:6.0f} MB\n", plan.cells[cell].name, clock_text(one.seconds), mb);
      seconds += one.seconds;
      disk_mb += mb;
      ++runs;
    }
    datasets += fmt::format(
        "{:70} {:6.1f} GB for a while{}\n", unit.dataset,
        1e-9 * static_cast<double>(unit.data_bytes),
        unit.data_bytes <= budget ? "" : ": more than --scratch-gb, simulated anew for each run");
  }
  fmt::print("{}: {} runs, about {} and {:.1f} GB of disk space (on two cores, one job)\n",
             plan.spec.title, runs, clock_text(seconds), 1e-3 * disk_mb);
  fmt::print("{}at most {:.1f} GB of data at a time (--scratch-gb)\n", datasets,
             1e-9 * static_cast<double>(budget));
}

/// Expectations that fall short, a line each.
std::string shortfall_text(const report::ReportFiles& report) {
  std::string text;
  for (const results::Judgement& judged : report.shortfalls) {
    text += fmt::format("falls short{}: {} ({})\n",
                        judged.variant.empty() ? "" : " with " + judged.variant,
                        judged.expectation.finding, fmt::join(judged.evidence, "; "));
  }
  return text;
}

Json shortfall_json(const report::ReportFiles& report) {
  Json list = Json::array();
  for (const results::Judgement& judged : report.shortfalls) {
    list.push_back({{"finding", judged.expectation.finding},
                    {"variant", judged.variant},
                    {"evidence", judged.evidence}});
  }
  return list;
}

study::StudyOptions options_of(const Common& common, const StudyRequest& request) {
  study::StudyOptions options = local_study(common);
  options.jobs = request.jobs;
  options.shard = study::parse_shard(request.shard);
  options.scratch = request.scratch;
  if (request.scratch_gb)
    options.scratch_bytes = static_cast<std::uint64_t>(1e9 * *request.scratch_gb);
  options.known = request.known;
  options.grace_s = request.grace_s;
  options.waits_for_others = !request.worker;
  return options;
}

void print_outcome(const Common& common, const std::string& out,
                   const study::StudyOutcome& outcome) {
  if (common.json) {
    print_json({{"study", out},
                {"cells", outcome.cells},
                {"runs", outcome.runs},
                {"reused", outcome.reused},
                {"failed", outcome.failed},
                {"diverged", outcome.diverged}});
  } else {
    fmt::print("{} of {} runs have a result: {} not by this call, {} failed, {} diverged\n",
               outcome.runs, outcome.cells, outcome.reused, outcome.failed, outcome.diverged);
  }
}

/// A study that was asked to end before its end. If it has finished nothing, another call with as
/// little time would not, either.
int interrupted(const study::StudyOutcome& outcome) {
  if (outcome.has_advanced) return kInterrupted;
  fmt::print(stderr,
             "lidarena: study: was asked to end before it had finished a flight or a run; give it "
             "more time (in a cluster: --time)\n");
  return kWorkFailed;
}

/// Part of a study, without a report: a shard, or what a worker finds to do.
int study_part(const Common& common, const StudyRequest& request,
               const study::StudyOutcome& outcome) {
  if (outcome.is_interrupted) return interrupted(outcome);
  print_outcome(common, request.out, outcome);
  return request.worker || outcome.runs == outcome.cells ? kDone : kWorkFailed;
}

int submit_study(const Common& common, const StudyRequest& request, const study::StudyPlan& plan) {
  study::SlurmOptions options = request.cluster;
  options.configs = common.configs;
  options.scratch = request.scratch;
  const study::SlurmJobs jobs =
      study::write_slurm_jobs(plan, request.out, study::find_program("/proc/self/exe"), options);
  const std::string job = request.print ? std::string() : study::submit(jobs);
  if (common.json) {
    print_json({{"study", request.out},
                {"job", job},
                {"tasks", jobs.tasks.string()},
                {"report", jobs.report.string()}});
  } else if (request.print) {
    fmt::print(
        "{}{}submit them: job=$(sbatch --parsable {}) && sbatch --dependency=afterany:$job {}\n",
        dataset::read_bytes(jobs.tasks), dataset::read_bytes(jobs.report), jobs.tasks.string(),
        jobs.report.string());
  } else {
    fmt::print("submitted as job {}: {} runs of {} datasets\nlook: lidarena status {}\n", job,
               plan.cells.size(), plan.units.size(), request.out);
  }
  return kDone;
}

int whole_study(const Common& common, const StudyRequest& request,
                const study::StudyOutcome& outcome, Console& console) {
  if (outcome.is_interrupted) return interrupted(outcome);
  const std::string& out = request.out;
  const report::ReportFiles report =
      report::write_report({out}, out, Parallel(common.threads), console);
  if (common.json) {
    print_json({{"study", out},
                {"runs", outcome.runs},
                {"reused", outcome.reused},
                {"failed", outcome.failed},
                {"diverged", outcome.diverged},
                {"shortfalls", shortfall_json(report)},
                {"report", report.page.string()}});
  } else {
    fmt::print("{}\n{}{} runs: {} reused, {} failed, {} diverged\nreport: {}\n", report.text_table,
               shortfall_text(report), outcome.runs, outcome.reused, outcome.failed,
               outcome.diverged, report.page.string());
  }
  return outcome.runs == outcome.cells && report.shortfalls.empty() ? kDone : kWorkFailed;
}

void need_folder(const StudyRequest& request) {
  if (request.out.empty()) throw InputError("study", "needs a folder to write", "give --out DIR");
}

int study_verb(const Common& common, const StudyRequest& request) {
  const stages::ConfigFolder configs = common.config_folder();
  const study::StudyOptions options = options_of(common, request);
  Console console(common.quiet);
  if (request.worker) {
    need_folder(request);
    listen_to_signals();
    return study_part(common, request,
                      study::work_on_study(request.out, configs, options, console));
  }
  auto spec = request.name.empty() ? spec_of_one_world(request, configs)
                                   : study::load_study(configs.resolve("studies", request.name));
  study::add_programs(spec, request.programs, configs);
  if (request.dry) {
    const auto code = study::ProgramCode::ask(study::find_program(options.program));
    print_plan(study::make_plan(spec, configs, code, options.shard.of), options.shard, configs,
               options.scratch_bytes.value_or(
                   study::default_scratch_bytes(request.out.empty() ? "." : request.out)));
    return kDone;
  }
  study::planned_cells(spec, configs);  // judges all names
  need_folder(request);
  if (request.slurm || request.print)
    return submit_study(common, request, study::plan_study(spec, configs, request.out, options));
  listen_to_signals();
  const study::StudyOutcome outcome =
      study::run_study(spec, configs, request.out, options, console);
  return options.shard.of > 1 ? study_part(common, request, outcome)
                              : whole_study(common, request, outcome, console);
}

struct ReportRequest {
  std::vector<std::filesystem::path> folders, against;
  std::vector<std::string> fail_on;
  std::string out;
};

results::StudyResults read_all(const std::vector<std::filesystem::path>& folders) {
  std::vector<results::StudyResults> parts;
  for (const std::filesystem::path& folder : folders)
    parts.push_back(results::read_results(folder));
  return results::merged(std::move(parts));
}

/// Compares with an earlier study; returns the limits that were exceeded.
std::vector<std::string> compare(const ReportRequest& request, const std::filesystem::path& out,
                                 bool as_json, Json& json) {
  std::vector<results::ChangeLimit> limits;
  for (const std::string& text : request.fail_on) limits.push_back(results::parse_limit(text));
  const results::VersionComparison comparison =
      results::compare_versions(read_all(request.against), read_all(request.folders));
  const results::Table table = results::table_of(comparison);
  dataset::write_text_file(out / "comparison.csv", results::table_csv(table));
  dataset::write_text_file(out / "comparison.md", results::table_markdown(table));
  std::vector<std::string> beyond = results::exceeded(comparison, limits);
  json["comparison"] = results::to_json(comparison);
  json["exceeded"] = beyond;
  if (!as_json) {
    fmt::print("\n{}", results::comparison_text(comparison));
    for (const std::string& line : beyond) fmt::print("beyond the limit {}\n", line);
  }
  return beyond;
}

int report_verb(const Common& common, const ReportRequest& request) {
  if (request.out.empty() && request.folders.size() > 1) {
    throw InputError("report", "the report of several folders needs an output folder",
                     "give --out DIR");
  }
  if (request.against.empty() && !request.fail_on.empty())
    throw InputError("--fail-on", "needs an earlier study", "give --against OLD");
  Console console(common.quiet);
  const std::filesystem::path out =
      request.out.empty() ? request.folders.front() : std::filesystem::path(request.out);
  const report::ReportFiles report =
      report::write_report(request.folders, out, Parallel(common.threads), console);
  Json json{{"report", report.page.string()}, {"shortfalls", shortfall_json(report)}};
  if (!common.json) {
    fmt::print("{}\n{}report: {}\n", report.text_table, shortfall_text(report),
               report.page.string());
  }
  const bool within = request.against.empty() || compare(request, out, common.json, json).empty();
  if (common.json) print_json(json);
  return report.missing == 0 && within ? kDone : kWorkFailed;
}

/// Options of a study that more than one machine works on.
void add_shared_options(CLI::App& verb, StudyRequest& request) {
  verb.add_option("--shard", request.shard, "K/N: run only the K-th of N parts of the study");
  verb.add_flag("--worker", request.worker,
                "Instead of a study: work on the one planned in --out, with any other workers, "
                "until nothing is left that nobody has");
  verb.add_option("--scratch", request.scratch,
                  "Folder for flights and runs in progress, best on this machine's own disk; "
                  "default: in --out");
  verb.add_option("--grace", request.grace_s,
                  "Seconds that runs in progress may still take after the signal USR1")
      ->check(CLI::NonNegativeNumber);
  verb.add_flag("--slurm", request.slurm,
                "Plan, write tasks.sh and report.sh into --out, and submit them to Slurm");
  verb.add_flag("--print", request.print, "With --slurm: write and print, but do not submit");
  verb.add_option("--partition", request.cluster.partition, "With --slurm: partition");
  verb.add_option("--time", request.cluster.time, "With --slurm: limit of a task, as for sbatch");
  verb.add_option("--cpus", request.cluster.cpus, "With --slurm: processor cores of a task")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  verb.add_option("--array-limit", request.cluster.array_limit,
                  "With --slurm: tasks at the same time; no more than datasets are started")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb.add_option("--warning", request.cluster.warning_s,
                  "With --slurm: seconds before the limit of time at which a task is told to end; "
                  "runs that take less than 3/4 of it are finished")
      ->check(CLI::Range(10, 3600))
      ->capture_default_str();
  verb.add_option(
      "--command", request.cluster.command,
      "With --slurm: how a node calls lidarena, e.g. \"apptainer exec FILE.sif lidarena\"; "
      "default: this program at its path");
  verb.add_option("--sbatch", request.cluster.sbatch,
                  "With --slurm: one more option of sbatch, --sbatch=--account=NAME; repeatable")
      ->allow_extra_args(false);
}

}  // namespace

void add_study(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "study",
      "Simulate, run and score a matrix of worlds, sensors and algorithms; writes a report");
  auto request = std::make_shared<StudyRequest>();
  verb->add_option("study", request->name, "Name (see: list studies) or YAML");
  verb->add_option("--out", request->out,
                   "Folder to write, required; complete runs in it are reused");
  verb->add_option("--world", request->world,
                   "Instead of a study: one world, a name or a mesh file");
  verb->add_option("--sensors", request->sensors, "With --world: sensors A,B,...")->delimiter(',');
  verb->add_option("--algorithms", request->algorithms, "With --world: algorithms A,B,... or all")
      ->delimiter(',')
      ->default_str("all");
  verb->add_option("--programs", request->programs,
                   "Also run programs of others A,B,... (see: list programs), or files of them; "
                   "installed = all that are installed")
      ->delimiter(',');
  verb->add_flag("--auto", request->tour, "With --world: plan a tour of the world automatically");
  verb->add_option("--seconds", request->seconds,
                   "With --world: length of the flight, s; 0 = the whole tour");
  add_allow_missing(*verb, request->allow_missing);
  verb->add_flag("--dry", request->dry, "Only list the runs, with estimated time and disk space");
  verb->add_option("--known", request->known,
                   "results.csv of an earlier part of this study: its rows count as done if code, "
                   "settings and seed are the same; may be repeated")
      ->check(CLI::ExistingFile);
  verb->add_option("--jobs", request->jobs,
                   "Number of runs at the same time, each on its own cores")
      ->check(CLI::Range(1, 256));
  verb->add_option("--scratch-gb", request->scratch_gb,
                   "Disk space for data of datasets in use, GB; those that need more are simulated "
                   "anew for each run. Default: half of the free space")
      ->check(CLI::NonNegativeNumber);
  add_shared_options(*verb, *request);
  set_verb(
      *verb, common, [&common, request] { return study_verb(common, *request); }, exit_code);
}

void add_report(CLI::App& app, Common& common, int& exit_code) {
  auto* verb =
      app.add_subcommand("report", "Write the report page again from the result files of studies");
  auto request = std::make_shared<ReportRequest>();
  verb->add_option("folders", request->folders,
                   "Study folder or RUN folder; several, as from --shard, become one report")
      ->required();
  verb->add_option("--out", request->out, "Folder of the report; default: the only folder given");
  verb->add_option("--against", request->against,
                   "Earlier study, or its parts: compare the same runs of both, figure by figure");
  verb->add_option("--fail-on", request->fail_on,
                   "With --against: FIGURE=LIMIT,... as drift=5%,lost=0 (drift, map, outliers, "
                   "cpu, memory, lost); exit code 1 where a median grew by more")
      ->delimiter(',')
      ->allow_extra_args(false);
  set_verb(
      *verb, common, [&common, request] { return report_verb(common, *request); }, exit_code);
}

}  // namespace lidarena
