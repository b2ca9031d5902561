// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "lidarena/dataset/cloud.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/dataset/tum.hpp"
#include "lidarena/report/image.hpp"
#include "lidarena/report/svg.hpp"
#include "lidarena/report/top_view.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStyle = R"css(
body{font:15px/1.5 system-ui,sans-serif;color:#1c2430;background:#f6f7f9;margin:0}
main{max-width:1220px;margin:0 auto;padding:24px 20px 60px}
h1{font-size:26px;margin:8px 0 2px}h2{font-size:19px;margin:34px 0 6px}
p{max-width:78ch;margin:6px 0 12px}.note{color:#5b6470;font-size:13px}
table{border-collapse:collapse;background:#fff;font-variant-numeric:tabular-nums;font-size:13px}
th,td{padding:5px 6px;border-bottom:1px solid #e3e6ea;text-align:right;white-space:nowrap}
th{font-weight:600;background:#eef1f4;vertical-align:bottom}
td.l,th.l{text-align:left}td.best{font-weight:700}td.bad{color:#b3261e;text-align:left;white-space:normal}
.scroll{overflow-x:auto}.row{display:flex;flex-wrap:wrap;gap:12px;align-items:flex-start}
figure{margin:0;background:#fff;border:1px solid #e3e6ea;border-radius:6px;padding:6px}
svg{display:block;max-width:100%;height:auto}
.t{font:11px system-ui,sans-serif;fill:#5b6470}.h{font:600 12.5px system-ui,sans-serif;fill:#1c2430}
.key{display:inline-block;width:110px;height:10px;vertical-align:middle;border-radius:2px}
code{background:#eef1f4;padding:1px 4px;border-radius:3px}
@media print{body{background:#fff}figure{break-inside:avoid}}
)css";

/// Hatching for the bin beyond the threshold, defined once for all panels.
constexpr const char* kDefinitions =
    "<svg width='0' height='0' style='position:absolute'><defs><pattern id='hatch' width='5' "
    "height='5' patternUnits='userSpaceOnUse' patternTransform='rotate(45)'><rect width='5' "
    "height='5' fill='#fbe3e1'/><line x1='0' y1='0' x2='0' y2='5' stroke='#d62027' "
    "stroke-width='2.4'/></pattern></defs></svg>";

std::string label(const ResultRow& row) {
  return row.algorithm + (row.preset.empty() ? "" : " (" + row.preset + ")");
}

/// Blue for sparse sensors, red for the dense one, as in the paper's figures; others in turn.
std::string sensor_color(const std::string& sensor) {
  if (sensor.find("mid360") != std::string::npos) return "#2b6cb0";
  if (sensor.find("os0") != std::string::npos) return "#c2410c";
  return "#4d7c0f";
}

std::vector<std::string> scenes_of(const Results& results) {
  std::vector<std::string> scenes;
  for (const ResultRow& row : results.rows) {
    if (std::find(scenes.begin(), scenes.end(), row.world) == scenes.end()) {
      scenes.push_back(row.world);
    }
  }
  return scenes;
}

std::vector<const ResultRow*> rows_of(const Results& results, const std::string& scene) {
  std::vector<const ResultRow*> rows;
  for (const ResultRow& row : results.rows) {
    if (row.world == scene) rows.push_back(&row);
  }
  return rows;
}

/// A column of the table: how to get its figure from a row, how to show it, and which end is best.
struct Column {
  const char* head;
  const char* format;
  std::optional<double> (*value)(const ResultRow&);
  bool larger_is_better;
};

const std::vector<Column>& table_columns() {
  static const std::vector<Column> columns{
      {"RPE<br>cm per m", "{:.2f}", [](const ResultRow& r) { return r.rpe_cm_per_m; }, false},
      {"RPE<br>deg per m", "{:.3f}", [](const ResultRow& r) { return r.rpe_deg_per_m; }, false},
      {"ATE<br>cm", "{:.2f}", [](const ResultRow& r) { return r.ate_cm; }, false},
      {"coverage<br>%", "{:.1f}", [](const ResultRow& r) { return r.coverage_percent; }, true},
      {"own map<br>RMSE cm", "{:.2f}",
       [](const ResultRow& r) {
         return r.own_map ? std::optional(r.own_map->rmse_cm) : std::nullopt;
       },
       false},
      {"own map<br>&gt; 20 cm, %", "{:.3g}",
       [](const ResultRow& r) {
         return r.own_map ? std::optional(r.own_map->outliers_percent) : std::nullopt;
       },
       false},
      {"all returns<br>RMSE cm", "{:.2f}",
       [](const ResultRow& r) {
         return r.reprojected_map ? std::optional(r.reprojected_map->rmse_cm) : std::nullopt;
       },
       false},
      {"all returns<br>&gt; 20 cm, %", "{:.3g}",
       [](const ResultRow& r) {
         return r.reprojected_map ? std::optional(r.reprojected_map->outliers_percent)
                                  : std::nullopt;
       },
       false},
      {"times<br>real time", "{:.1f}", [](const ResultRow& r) { return r.real_time_factor; }, true},
      {"P95<br>ms a scan", "{:.0f}", [](const ResultRow& r) { return r.latency_p95_ms; }, false},
      {"own<br>memory MB", "{:.1f}", [](const ResultRow& r) { return r.own_memory_mb; }, false}};
  return columns;
}

/// True when no other row of the same sensor has a better figure, and there is one to beat.
bool is_best(const std::vector<const ResultRow*>& rows, const ResultRow& row,
             const Column& column) {
  const auto value = column.value(row);
  bool has_rival = false;
  for (const ResultRow* other : rows) {
    const auto theirs = column.value(*other);
    if (!value || !theirs || other == &row || other->sensor != row.sensor) continue;
    has_rival = true;
    if (column.larger_is_better ? *theirs > *value : *theirs < *value) return false;
  }
  return has_rival;
}

std::string table(const std::vector<const ResultRow*>& rows) {
  const bool several_seeds = std::any_of(
      rows.begin(), rows.end(), [&](const ResultRow* r) { return r->seed != rows[0]->seed; });
  std::string html =
      "<div class='scroll'><table><thead><tr><th class='l'>sensor</th>"
      "<th class='l'>algorithm</th>";
  if (several_seeds) html += "<th>seed</th>";
  for (const Column& column : table_columns()) html += fmt::format("<th>{}</th>", column.head);
  html += "</tr></thead><tbody>";
  for (const ResultRow* row : rows) {
    html += fmt::format("<tr><td class='l'>{}</td><td class='l'>{}</td>", escaped(row->sensor),
                        escaped(label(*row)));
    if (several_seeds) html += fmt::format("<td>{}</td>", row->seed);
    if (row->status != "ok") {
      html += fmt::format("<td class='bad' colspan='{}'>{}: {}</td></tr>", table_columns().size(),
                          escaped(row->status), escaped(row->reason));
      continue;
    }
    for (const Column& column : table_columns()) {
      const auto value = column.value(*row);
      html += fmt::format("<td{}>{}</td>", is_best(rows, *row, column) ? " class='best'" : "",
                          value ? fmt::format(fmt::runtime(column.format), *value) : "&ndash;");
    }
    html += "</tr>";
  }
  return html + "</tbody></table></div>";
}

std::string histograms(const std::vector<const ResultRow*>& rows) {
  double y_max = 0.0;
  for (const ResultRow* row : rows) {
    if (!row->reprojected_map) continue;
    for (const double p : row->reprojected_map->histogram_percent) y_max = std::max(y_max, p);
    y_max = std::max(y_max, row->reprojected_map->outliers_percent);
  }
  std::string html = "<div class='row'>";
  for (const ResultRow* row : rows) {
    if (!row->reprojected_map) continue;
    const MapFigures& map = *row->reprojected_map;
    HistogramPanel panel;
    panel.title = row->sensor + ", " + label(*row);
    panel.percent = map.histogram_percent;
    panel.outliers_percent = map.outliers_percent;
    panel.rmse_cm = map.rmse_cm;
    panel.y_max_percent = y_max > 0 ? 1.05 * y_max : 100.0;
    panel.color = sensor_color(row->sensor);
    panel.caption = {
        fmt::format("{} points, {:.3g} % of them beyond 20 cm", map.points, map.outliers_percent),
        fmt::format("RMSE {:.2f} cm, of the inliers {:.2f} cm", map.rmse_cm, map.rmse_inliers_cm)};
    html += "<figure>" + histogram_svg(panel) + "</figure>";
  }
  return html + "</div>";
}

/// Positions of the estimate in the mesh's frame, by the SE(3) gauge of its metrics.
std::vector<Eigen::Vector3d> aligned_positions(const ResultRow& row, const Trajectory& estimate) {
  Pose truth_from_estimate = Pose::Identity();
  for (const char* gauge : {"se3", "first_pose"}) {
    const Json::json_pointer pointer(
        fmt::format("/final/ate/{}/truth_from_estimate_m_quaternion", gauge));
    if (!row.metrics.is_object() || !row.metrics.contains(pointer)) continue;
    read_value(ConfigNode::parse(row.metrics.at(pointer).dump(), "metrics.json"),
               truth_from_estimate, {});
    break;
  }
  std::vector<Eigen::Vector3d> positions;
  for (const StampedPose& p : estimate.poses()) {
    positions.push_back(truth_from_estimate * p.world_from_body.translation());
  }
  return positions;
}

std::string top_views(const std::vector<const ResultRow*>& rows) {
  std::string html = "<div class='row'>";
  for (const ResultRow* row : rows) {
    if (row->status != "ok" || !fs::exists(row->folder / "trajectory.tum")) continue;
    const fs::path dataset = row->folder / row->manifest.value("dataset", "");
    const auto truth = load_truth(dataset);
    const Trajectory estimate = read_tum(row->folder / "trajectory.tum");
    Cloud map;
    if (fs::exists(row->folder / "scored.ply")) map = read_cloud(row->folder / "scored.ply");
    TopView view;
    view.title = row->sensor + ", " + label(*row);
    view.map = &map;
    view.truth = truth ? &*truth : nullptr;
    view.estimate = aligned_positions(*row, estimate);
    view.width = 560;
    html += "<figure>" + top_view_svg(view) + "</figure>";
  }
  return html + "</div>";
}

std::string color_key() {
  std::string stops;
  for (int cm = 0; cm <= 20; cm += 2) {
    const Rgb c = distance_color(cm * 0.01);
    stops += fmt::format(",rgb({},{},{})", c[0], c[1], c[2]);
  }
  const Rgb far = distance_color(1.0);
  return fmt::format(
      "<p class='note'>Each map from above, like an X-ray: upright surfaces are dark. Colour: mean "
      "distance to the mesh, 0 <span class='key' "
      "style='background:linear-gradient(90deg{})'></span> "
      "20 cm, beyond <span class='key' style='width:14px;background:rgb({},{},{})'></span>. Grey: "
      "the true path; orange: the estimate, laid over it by SE(3) over all positions.</p>",
      stops, far[0], far[1], far[2]);
}

std::string charts(const std::vector<const ResultRow*>& rows) {
  static const std::vector<std::string> palette{"#2b6cb0", "#c2410c", "#4d7c0f", "#7c3aed",
                                                "#0f766e", "#b45309", "#be185d", "#334155"};
  LineChart error{"Error of each metre flown", "end of the metre, s", "cm", {}, 380, 220, true};
  LineChart latency{"Time for a scan", "sensor time, s", "ms", {}, 380, 220, true};
  LineChart memory{
      "Memory that the algorithm says it holds", "sensor time, s", "MB", {}, 380, 220, true};
  std::size_t i = 0;
  for (const ResultRow* row : rows) {
    const std::string color = palette[i++ % palette.size()];
    const std::string name = row->sensor + " " + row->algorithm;
    const Json::json_pointer pointer("/final/errors_over_time/rpe_1m");
    if (row->metrics.is_object() && row->metrics.contains(pointer)) {
      Series s{name, color, row->metrics.at(pointer).at("t_s").get<std::vector<double>>(),
               row->metrics.at(pointer).at("translation_m").get<std::vector<double>>()};
      for (double& y : s.y) y *= 100.0;
      error.series.push_back(std::move(s));
    }
    if (!fs::exists(row->folder / "resources.csv")) continue;
    Series ms{name, color, {}, {}};
    Series mb{name, color, {}, {}};
    for (const ResourceRow& r : read_resources(row->folder / "resources.csv")) {
      ms.x.push_back(r.t_sensor_s);
      ms.y.push_back(1e3 * r.latency_s);
      mb.x.push_back(r.t_sensor_s);
      mb.y.push_back(own_memory_mb(r));
    }
    latency.series.push_back(std::move(ms));
    memory.series.push_back(std::move(mb));
  }
  std::string html = "<div class='row'>";
  for (const LineChart* chart : {&error, &latency, &memory}) {
    html += "<figure>" + line_chart_svg(*chart) + "</figure>";
  }
  return html + "</div>";
}

constexpr const char* kReading =
    "<h2>How to read this</h2>"
    "<p>RPE: the true path is cut into metres; for each, the motion that the algorithm found is "
    "set "
    "against the true one; root mean square over all metres. ATE: distance between the two paths "
    "after laying one over the other. Map: distance of each map point to the very mesh that was "
    "scanned; <em>own map</em> is what the program publishes, <em>all returns</em> is every return "
    "moved with the estimated path, made alike for every algorithm, the first point of each 2 cm "
    "voxel. Own memory: map, scan buffer and backlog as the algorithm itself counts them; "
    "resources.csv has the whole process beside it, which holds the simulator too when the flight "
    "is flown on the fly. Bold: best of several rows of the same sensor.</p>"
    "<p class='note'>A run that failed or diverged stays in the table with its reason. Figures "
    "come "
    "from the final trajectory; metrics.json in each run's folder holds the live one, the other "
    "segment lengths and gauges, and the id of each definition.</p>";

}  // namespace

std::string html_page(const Results& results) {
  std::string body = fmt::format("<h1>{}</h1>", escaped(results.title));
  const auto ok = std::count_if(results.rows.begin(), results.rows.end(),
                                [](const ResultRow& r) { return r.status == "ok"; });
  body += fmt::format(
      "<p>{} of {} runs scored. Everything on this page comes from the result files "
      "beside it.</p>",
      ok, results.rows.size());
  for (const std::string& scene : scenes_of(results)) {
    const std::vector<const ResultRow*> rows = rows_of(results, scene);
    body += fmt::format("<h2>{}</h2>", escaped(scene)) + table(rows);
    body += "<h3>How far the map lies from the mesh</h3>" + histograms(rows);
    body += "<h3>Map and paths from above</h3>" + color_key() + top_views(rows);
    body += "<h3>Over time</h3>" + charts(rows);
  }
  return fmt::format(
      "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
      "<meta name='viewport' content='width=device-width,initial-scale=1'><title>{}</title>"
      "<style>{}</style></head><body><main>{}{}{}</main></body></html>\n",
      escaped(results.title), kStyle, kDefinitions, body, kReading);
}

}  // namespace lidarena
