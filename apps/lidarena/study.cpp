// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fmt/format.h>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/report/report.hpp"

namespace lidarena {
namespace {

int study_verb(const Common& common, const std::string& name, const std::string& out, bool dry) {
  const ConfigFolder configs = common.config_folder();
  const auto spec = load_config<StudySpec>(configs.resolve("studies", name));
  if (dry) {
    const std::vector<PlannedRun> cells = plan(spec, configs);
    for (const PlannedRun& cell : cells) fmt::print("{}\n", cell.name);
    fmt::print("{} runs\n", cells.size());
    return kDone;
  }
  Console console(common.quiet);
  const StudyOutcome outcome = run_study(spec, configs, out, common.threads, console);
  const ReportFiles report = write_report(out, console);
  if (common.json) {
    print_json({{"study", out},
                {"runs", outcome.runs},
                {"reused", outcome.reused},
                {"failed", outcome.failed},
                {"diverged", outcome.diverged},
                {"report", report.page.string()}});
  } else {
    fmt::print("{}\n{} runs: {} kept from before, {} failed, {} diverged\nreport: {}\n",
               report.text_table, outcome.runs, outcome.reused, outcome.failed, outcome.diverged,
               report.page.string());
  }
  return outcome.failed + outcome.diverged > 0 ? kWorkFailed : kDone;
}

}  // namespace

void add_study(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "study", "Fly, run and score a matrix of worlds, sensors and algorithms; writes a report");
  auto name = std::make_shared<std::string>();
  auto out = std::make_shared<std::string>();
  auto dry = std::make_shared<bool>(false);
  verb->add_option("study", *name, "Name (see: list studies) or YAML")->required();
  verb->add_option("--out", *out, "Folder to write; what is complete there is kept")->required();
  verb->add_flag("--dry", *dry, "Only list the runs");
  set_verb(
      *verb, common, [&common, name, out, dry] { return study_verb(common, *name, *out, *dry); },
      exit_code);
}

void add_report(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand("report", "Make the page anew from a study's result files");
  auto folder = std::make_shared<std::string>();
  verb->add_option("folder", *folder, "A study's folder, or one RUN folder")->required();
  set_verb(
      *verb, common,
      [&common, folder] {
        Console console(common.quiet);
        const ReportFiles report = write_report(*folder, console);
        if (common.json) {
          print_json({{"report", report.page.string()}});
        } else {
          fmt::print("{}\nreport: {}\n", report.text_table, report.page.string());
        }
        return kDone;
      },
      exit_code);
}

}  // namespace lidarena
