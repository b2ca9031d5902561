// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/report/pictures.hpp"
#include "lidarena/report/table.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// A part of the page: a heading, text and tables.
struct ReportSection {
  std::string id;
  std::string title;
  std::string text;   ///< before the tables, one paragraph per line; may be empty
  std::string world;  ///< if set, the world's pictures, 3D view and charts follow
  std::vector<ReportTable> tables;
};

/// All sections in the order of the page: summary, expectations, figures by sensor and algorithm,
/// world by world, the rest.
std::vector<ReportSection> report_sections(const results::StudyResults& results);

/// The report as one self-contained HTML file of at most 60 MB, whatever the size of the study; it
/// needs no network. `pictures` are those of all worlds (see draw_pictures()), `data` is the data
/// of the charts (see report_data()). If the build has no viewer, the page has only tables and
/// pictures.
std::string html_page(const results::StudyResults& results,
                      const std::vector<ReportSection>& sections,
                      const std::vector<WorldPictures>& pictures, const Json& data,
                      const Parallel& parallel, LogSink& log);

}  // namespace lidarena::report
