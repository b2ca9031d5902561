// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report.hpp"

#include <algorithm>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/change_tables.hpp"
#include "lidarena/report/contribution_tables.hpp"
#include "lidarena/report/decision.hpp"
#include "lidarena/report/figure_tables.hpp"
#include "lidarena/report/page_scenes.hpp"
#include "lidarena/report/report_data.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/report/svg_figures.hpp"
#include "lidarena/report/sweep_tables.hpp"
#include "lidarena/report/web_page.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

/// Expectations as judged, and tables that compare cells.
std::vector<results::Table> comparison_tables(const results::StudyResults& results) {
  std::vector<results::Table> tables;
  const auto add = [&](std::vector<results::Table> more) {
    std::ranges::move(more, std::back_inserter(tables));
  };
  add(contribution_tables(shown_contributions(results)));
  add(change_tables(shown_changes(results)));
  add(sweep_tables(results));
  for (const std::string& world : results::StudyCells(results, "").worlds())
    tables.push_back(decision_table(results, world));
  for (const std::string& variant : results::variants_of(results)) {
    if (!results.expect.empty()) tables.push_back(expectations_table(results, variant));
    add(figure_tables(results, variant));
  }
  for (const std::string& world : results::StudyCells(results, "").worlds())
    tables.push_back(usual_table(results, world));
  add(timing_tables(results));
  return tables;
}

/// Lists of runs, which the page makes from its data.
std::vector<results::Table> lists(const results::StudyResults& results) {
  std::vector<results::Table> tables{failures_table(results), commands_table(results)};
  for (const std::string& world : results::StudyCells(results, "").worlds())
    tables.push_back(runs_table(results, world));
  return tables;
}

/// Writes every table as CSV, Markdown, LaTeX and JSON.
void write_tables(const std::vector<results::Table>& tables, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const results::Table& table : tables) {
    dataset::write_text_file(folder / (table.id + ".csv"), table_csv(table));
    dataset::write_text_file(folder / (table.id + ".md"), table_markdown(table));
    dataset::write_text_file(folder / (table.id + ".tex"), table_latex(table));
    dataset::write_json(folder / (table.id + ".json"), to_json(table));
  }
}

}  // namespace

ReportFiles write_report(const std::vector<std::filesystem::path>& folders,
                         const std::filesystem::path& folder, const Parallel& parallel,
                         LogSink& log) {
  std::vector<results::StudyResults> parts;
  for (const std::filesystem::path& part : folders) parts.push_back(results::read_results(part));
  const results::StudyResults results = results::merged(std::move(parts));
  log.info("writing the report");
  std::filesystem::create_directories(folder);
  ReportFiles files;
  files.csv = folder / "results.csv";
  const std::vector<results::Table> tables = comparison_tables(results);
  dataset::write_text_file(files.csv, results::results_csv(results));
  write_tables(tables, folder / "tables");
  write_tables(lists(results), folder / "tables");
  WebPage page{results.title, "report", to_json(report_data(results, tables, folder)), {}};
  files.page = folder / "report.json";
  dataset::write_json(files.page, page.data);
  if (has_viewer()) {
    files.page = folder / "report.html";
    page.scenes = page_scenes(results, parallel, log);
    write_page(files.page, page);
    if (!draw_svg_figures(files.page, folder / "figures"))
      log.info("SVG files of the figures are left out: they need Node.js; the page has them");
  } else {
    std::filesystem::remove(folder / "report.html");  // of former results
    log.info("the page is left out: this build has no viewer");
  }
  files.shortfalls = results::shortfalls(results);
  files.text_table = results::results_text(results);
  files.missing = static_cast<std::size_t>(
      std::ranges::count(results.without_result, results::kMissing, &results::RunRecord::status));
  return files;
}

}  // namespace lidarena::report
