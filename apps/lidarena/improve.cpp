// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/study_calls.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/improvement_table.hpp"
#include "lidarena/report/report.hpp"
#include "lidarena/study/improvement.hpp"

namespace lidarena {
namespace {

struct ImproveRequest {
  study::ImprovementRequest what;
  std::string steps;
  std::string out;
  int jobs = 1;
  bool dry = false;
};

/// The steps that make the sensor better, and which are left out since it is as good already.
struct Chosen {
  std::vector<study::VariedSet> sets;
  std::vector<report::StepNote> notes;
  std::vector<std::string> left_out;
};

Chosen choose(const ImproveRequest& request, const stages::ConfigFolder& configs) {
  const auto file = request.steps.empty() ? configs.root() / "improve.yaml"
                                          : std::filesystem::path(request.steps);
  const auto steps = study::load_steps(file);
  Chosen chosen;
  chosen.sets = study::steps_for(steps, configs.load_sensor(request.what.sensor));
  for (const study::ImprovementStep& step : steps) {
    if (std::ranges::find(chosen.sets, step.name, &study::VariedSet::name) != chosen.sets.end())
      chosen.notes.push_back({step.name, step.source});
    else
      chosen.left_out.push_back(step.name);
  }
  if (chosen.sets.empty())
    throw InputError(request.what.sensor, "is as good as each step of " + file.string(),
                     "write your own steps, and give them with --steps FILE");
  return chosen;
}

void write_table(const results::Table& table, const std::filesystem::path& out) {
  std::filesystem::create_directories(out / "tables");
  dataset::write_text_file(out / "tables" / "improve.csv", results::table_csv(table));
  dataset::write_text_file(out / "tables" / "improve.md", results::table_markdown(table));
}

int improve_verb(const Common& common, const ImproveRequest& request) {
  Console console(common.quiet);
  const stages::ConfigFolder configs = common.config_folder();
  const Chosen chosen = choose(request, configs);
  const study::StudySpec spec = study::improvement_study(request.what, chosen.sets);
  const auto cells = study::planned_cells(spec, configs);
  if (!chosen.left_out.empty())
    console.info(
        fmt::format("the sensor is as good already: {}", fmt::join(chosen.left_out, ", ")));
  if (request.dry) {
    double seconds = 0.0;
    for (const study::PlannedRun& cell : cells) seconds += estimate(spec, cell, configs).seconds;
    fmt::print("{} runs, about {} on two cores\n", cells.size(), clock_text(seconds));
    return kDone;
  }
  if (request.out.empty()) throw InputError("improve", "needs a folder to write", "give --out DIR");
  study::StudyOptions options = local_study(common);
  options.jobs = request.jobs;
  listen_to_signals();
  const study::StudyOutcome outcome =
      study::run_study(spec, configs, request.out, options, console);
  if (outcome.is_interrupted) return kInterrupted;
  const report::ReportFiles report =
      report::write_report({request.out}, request.out, Parallel(common.threads), console);
  const report::Improvement made =
      report::improvement_of(results::read_results(request.out), chosen.notes);
  write_table(made.table, request.out);
  if (common.json) {
    print_json({{"table", to_json(made.table)},
                {"words", made.words},
                {"left_out", chosen.left_out},
                {"report", report.page.string()}});
  } else {
    fmt::print("{}\n{}\nreport: {}\n", results::table_text(made.table), fmt::join(made.words, "\n"),
               report.page.string());
  }
  return outcome.runs == outcome.cells ? kDone : kWorkFailed;
}

}  // namespace

void add_improve(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "improve", "Which property of a sensor, one realistic step better, would gain most");
  auto request = std::make_shared<ImproveRequest>();
  study::ImprovementRequest& what = request->what;
  verb->add_option("sensor", what.sensor, "Name or file of the sensor")->required();
  verb->add_option("--world", what.world, "Name of a world, or a file")->required();
  verb->add_option("--flight", what.flight, "Name of a flight, or a file")->required();
  verb->add_option("--algorithm", what.algorithm, "NAME or NAME:PRESET")->capture_default_str();
  verb->add_option("--seconds", what.seconds, "Length of each flight, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_option("--seeds", what.seeds,
                   "Flights; each also has its own world (of a generated one), route and gusts")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb->add_flag("--pairs", what.pairs, "Also any two steps together");
  verb->add_option("--steps", request->steps, "File of steps; default: configs/improve.yaml");
  verb->add_option("--out", request->out, "Folder to write; complete runs in it are reused");
  verb->add_option("--jobs", request->jobs, "Number of runs at the same time")
      ->check(CLI::Range(1, 256));
  verb->add_flag("--dry", request->dry, "Only count the runs, with estimated time");
  set_verb(
      *verb, common, [&common, request] { return improve_verb(common, *request); }, exit_code);
}

}  // namespace lidarena
