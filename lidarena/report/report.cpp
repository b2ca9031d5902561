// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report.hpp"

#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/page.hpp"
#include "lidarena/report/result_table.hpp"

namespace lidarena {

ReportFiles write_report(const std::filesystem::path& folder, LogSink& log) {
  const Results results = read_results(folder);
  log.info("drawing the report");
  ReportFiles files;
  files.page = folder / "report.html";
  files.csv = folder / "results.csv";
  write_text_file(files.csv, results_csv(results));
  write_text_file(files.page, html_page(results));
  files.text_table = results_text(results);
  return files;
}

}  // namespace lidarena
