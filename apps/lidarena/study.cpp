// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fmt/format.h>

#include <map>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/report/report.hpp"
#include "lidarena/study/scratch.hpp"

namespace lidarena {
namespace {

struct StudyRequest {
  std::string name;  ///< name or file of a study; empty: made from the fields below
  std::string world;
  std::vector<std::string> sensors;
  std::vector<std::string> algorithms{"all"};
  bool tour = false;  ///< plan a tour of the world automatically
  double seconds = 0.0;
  std::string out;
  bool dry = false;
  int jobs = 1;
  std::string shard = "1/1";
  std::optional<double> scratch_gb;
};

/// A study of one world on an automatically planned tour; the algorithm "all" stands for every one.
study::StudySpec spec_of_one_world(const StudyRequest& request) {
  if (request.world.empty()) {
    throw InputError("study", "neither a study nor a world is given",
                     "name a study, or give --world and --sensors");
  }
  if (!request.tour) {
    throw InputError("study --world", "has no flight", "give --auto to plan a tour of the world");
  }
  study::StudySpec spec;
  spec.title = "Which LiDAR, which SLAM: " + std::filesystem::path(request.world).stem().string();
  spec.scenes = {{request.world, "auto", request.seconds}};
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

void print_plan(const study::StudySpec& spec, const std::vector<study::PlannedRun>& cells,
                const study::ConfigFolder& configs) {
  double seconds = 0.0;
  double disk_mb = 0.0;
  for (const study::PlannedRun& cell : cells) {
    const study::CellEstimate one = study::estimate(cell, configs);
    const double mb = one.record_mb + (spec.keep_maps ? one.maps_mb : 0.0);
    fmt::print("{:70} {:>8} {:6.0f} MB\n", cell.name, clock_text(one.seconds), mb);
    seconds += one.seconds;
    disk_mb += mb;
  }
  fmt::print("{}: {} runs, about {} and {:.1f} GB of disk space (on two cores, one job)\n",
             spec.title, cells.size(), clock_text(seconds), 1e-3 * disk_mb);
}

/// What is simulated once, and what anew for each run.
void print_scratch(const study::StudySpec& spec, const std::vector<study::PlannedRun>& cells,
                   const study::ConfigFolder& configs, std::uint64_t budget) {
  std::map<std::string, std::uint64_t> datasets;
  for (const study::PlannedRun& cell : cells) {
    if (!datasets.contains(cell.dataset))
      datasets[cell.dataset] = study::data_bytes(spec, cell, configs);
  }
  for (const auto& [name, bytes] : datasets) {
    fmt::print("{:70} {:6.1f} GB for a while{}\n", name, 1e-9 * static_cast<double>(bytes),
               bytes <= budget ? "" : ": more than --scratch-gb, simulated anew for each run");
  }
  fmt::print("at most {:.1f} GB of data at a time (--scratch-gb)\n",
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

int study_verb(const Common& common, const StudyRequest& request) {
  const study::ConfigFolder configs = common.config_folder();
  const auto spec = request.name.empty()
                        ? spec_of_one_world(request)
                        : load_config<study::StudySpec>(configs.resolve("studies", request.name));
  study::StudyOptions options;
  options.threads = common.threads;
  options.jobs = request.jobs;
  options.shard = study::parse_shard(request.shard);
  options.program = "/proc/self/exe";
  if (request.scratch_gb)
    options.scratch_bytes = static_cast<std::uint64_t>(1e9 * *request.scratch_gb);
  if (request.dry) {
    const auto cells = study::cells_of_shard(study::plan(spec, configs), options.shard, configs);
    print_plan(spec, cells, configs);
    print_scratch(spec, cells, configs,
                  options.scratch_bytes.value_or(study::default_scratch_bytes(request.out)));
    return kDone;
  }
  Console console(common.quiet);
  const std::string& out = request.out;
  const study::StudyOutcome outcome = study::run_study(spec, configs, out, options, console);
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

struct ReportRequest {
  std::vector<std::filesystem::path> folders;
  std::string out;
};

int report_verb(const Common& common, const ReportRequest& request) {
  if (request.out.empty() && request.folders.size() > 1) {
    throw InputError("report", "the report of several folders needs an output folder",
                     "give --out DIR");
  }
  Console console(common.quiet);
  const std::filesystem::path out =
      request.out.empty() ? request.folders.front() : std::filesystem::path(request.out);
  const report::ReportFiles report =
      report::write_report(request.folders, out, Parallel(common.threads), console);
  if (common.json) {
    print_json({{"report", report.page.string()}, {"shortfalls", shortfall_json(report)}});
  } else {
    fmt::print("{}\n{}report: {}\n", report.text_table, shortfall_text(report),
               report.page.string());
  }
  return kDone;
}

}  // namespace

void add_study(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "study",
      "Simulate, run and score a matrix of worlds, sensors and algorithms; writes a report");
  auto request = std::make_shared<StudyRequest>();
  verb->add_option("study", request->name, "Name (see: list studies) or YAML");
  verb->add_option("--out", request->out, "Folder to write; complete runs in it are reused")
      ->required();
  verb->add_option("--world", request->world,
                   "Instead of a study: one world, a name or a mesh file");
  verb->add_option("--sensors", request->sensors, "With --world: sensors A,B,...")->delimiter(',');
  verb->add_option("--algorithms", request->algorithms, "With --world: algorithms A,B,... or all")
      ->delimiter(',')
      ->default_str("all");
  verb->add_flag("--auto", request->tour, "With --world: plan a tour of the world automatically");
  verb->add_option("--seconds", request->seconds,
                   "With --world: length of the flight, s; 0 = the whole tour");
  verb->add_flag("--dry", request->dry, "Only list the runs, with estimated time and disk space");
  verb->add_option("--jobs", request->jobs,
                   "Number of runs at the same time, each on its own cores")
      ->check(CLI::Range(1, 256));
  verb->add_option("--scratch-gb", request->scratch_gb,
                   "Disk space for data of datasets in use, GB; those that need more are simulated "
                   "anew for each run. Default: half of the free space")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--shard", request->shard, "K/N: run only the K-th of N parts of the study");
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
  set_verb(
      *verb, common, [&common, request] { return report_verb(common, *request); }, exit_code);
}

}  // namespace lidarena
