// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report.hpp"

#include <algorithm>

#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/page.hpp"
#include "lidarena/report/pictures.hpp"
#include "lidarena/report/report_data.hpp"
#include "lidarena/report/svg_figures.hpp"
#include "lidarena/report/table.hpp"
#include "lidarena/report/web_bundle.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {
namespace {

/// Writes every table as CSV, Markdown, LaTeX and JSON.
void write_tables(const std::vector<ReportSection>& sections, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const ReportSection& section : sections) {
    for (const ReportTable& table : section.tables) {
      dataset::write_text_file(folder / (table.id + ".csv"), table_csv(table));
      dataset::write_text_file(folder / (table.id + ".md"), table_markdown(table));
      dataset::write_text_file(folder / (table.id + ".tex"), table_latex(table));
      dataset::write_json(folder / (table.id + ".json"), table_json(table));
    }
  }
}

/// Writes every picture from above as a file.
void write_pictures(const std::vector<WorldPictures>& worlds, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const WorldPictures& world : worlds) {
    for (const auto& pictures : {world.place, world.maps}) {
      for (const Picture& picture : pictures) {
        dataset::write_text_file(folder / (picture.id + ".svg"), picture.svg);
      }
    }
  }
}

}  // namespace

ReportFiles write_report(const std::vector<std::filesystem::path>& folders,
                         const std::filesystem::path& folder, const Parallel& parallel,
                         LogSink& log) {
  std::vector<results::StudyResults> parts;
  for (const std::filesystem::path& part : folders) parts.push_back(results::read_results(part));
  const results::StudyResults results = results::merged(std::move(parts));
  log.info("drawing the report");
  std::filesystem::create_directories(folder);
  ReportFiles files;
  files.page = folder / "report.html";
  files.csv = folder / "results.csv";
  const std::vector<ReportSection> sections = report_sections(results);
  const std::vector<WorldPictures> pictures = draw_pictures(results);
  const Json data = report_data(results);
  dataset::write_text_file(files.csv, results::results_csv(results));
  write_tables(sections, folder / "tables");
  dataset::write_json(folder / "report.json", data);
  if (!draw_svg_figures(folder / "report.json", folder / "figures")) {
    log.info(web_bundle("figures.cjs").empty()
                 ? "figures are left out: this build has no viewer"
                 : "SVG files of the figures are left out: they need Node.js; the page has them");
  }
  write_pictures(pictures, folder / "figures");
  dataset::write_text_file(files.page, html_page(results, sections, pictures, data, parallel, log));
  files.shortfalls = results::shortfalls(results);
  files.text_table = results::results_text(results);
  files.missing = static_cast<std::size_t>(
      std::ranges::count(results.rows, "missing", &results::RunRecord::status));
  return files;
}

}  // namespace lidarena::report
