// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "lidarena/report/decision.hpp"
#include "lidarena/report/figure_tables.hpp"
#include "lidarena/report/image.hpp"
#include "lidarena/report/scene_blocks.hpp"
#include "lidarena/report/scene_files.hpp"
#include "lidarena/report/simplified_mesh.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/report/svg.hpp"
#include "lidarena/report/timing.hpp"
#include "lidarena/report/view_page.hpp"
#include "lidarena/report/web_bundle.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoints = 2'500'000;       // of all 3D views; 8 bytes each, 4/3 as text
constexpr std::size_t kPointsOfRun = 120'000;    // maximum per run
constexpr std::size_t kPictureBytes = 12 << 20;  // of all maps from above, rarely reached
constexpr std::size_t kTriangles = 400'000;      // of all meshes; about 18 bytes each, 4/3 as text

constexpr const char* kStyle = R"css(
body{font:15px/1.5 system-ui,sans-serif;color:#1c2430;background:#f6f7f9;margin:0}
main{max-width:1280px;margin:0 auto;padding:24px 20px 60px}
h1{font-size:26px;margin:8px 0 2px}main>h2{font-size:20px;margin:36px 0 6px;border-top:1px solid #d7dce2;padding-top:14px}
p{max-width:82ch;margin:6px 0 12px}.note,figcaption{color:#5b6470;font-size:13px}.note{max-width:none}
nav a{margin-right:14px;color:#2b5a97}
table{border-collapse:collapse;background:#fff;font-variant-numeric:tabular-nums;font-size:13px;margin-top:10px}
caption{text-align:left;white-space:nowrap;font-weight:600;padding:4px 0;font-size:14px}
th,td{padding:5px 8px;border-bottom:1px solid #e3e6ea;text-align:right;vertical-align:top}
th{font-weight:600;background:#eef1f4;vertical-align:bottom}td.l,th.l{text-align:left}
.reference{color:#7a828d;font-size:12px}.scroll{overflow-x:auto;display:inline-block;vertical-align:top;max-width:100%;margin-right:28px}
.row,.figures{display:flex;flex-wrap:wrap;gap:12px;align-items:flex-start;margin-top:10px}
figure{margin:0;background:#fff;border:1px solid #e3e6ea;border-radius:6px;padding:6px;max-width:100%;overflow-x:auto}
figcaption{max-width:82ch;padding:2px 6px}svg{display:block;max-width:100%;height:auto}
.t{font:11px system-ui,sans-serif;fill:#5b6470}.h{font:600 12.5px system-ui,sans-serif;fill:#1c2430}
.ramp{display:inline-block;width:110px;height:10px;vertical-align:middle;border-radius:2px}
#commands td{font:12px ui-monospace,monospace;white-space:normal;overflow-wrap:anywhere}
@media print{body{background:#fff;font-size:11px}main{max-width:none;padding:0}nav,.start{display:none}
main>h2{break-after:avoid}figure,tr{break-inside:avoid}table,.note,figcaption{font-size:9px}
.scroll,figure{overflow:visible}th,td{padding:2px 4px}}
)css";

std::vector<std::string> worlds_of(const results::StudyResults& results) {
  return results::StudyCells(results, "").worlds();
}

/// Pictures side by side, up to `budget` bytes.
std::string figures(const std::vector<Picture>& pictures, std::size_t budget) {
  if (pictures.empty()) return {};
  std::string html = "<div class='row'>";
  for (const Picture& picture : pictures) {
    if (html.size() + picture.svg.size() > budget) break;
    html += "<figure>" + picture.svg + "</figure>";
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
      "<p class='note'>Each map is shown from above, like an X-ray image: vertical surfaces are "
      "dark. Color: mean point-to-mesh distance, 0 <span class='ramp' "
      "style='background:linear-gradient(90deg{})'></span> "
      "20 cm, beyond <span class='ramp' style='width:14px;background:rgb({},{},{})'></span>. Gray: "
      "true path; orange: estimated path, aligned to it by SE(3) over all positions. Only the "
      "first seed is shown.</p>",
      stops, far[0], far[1], far[2]);
}

/// The 3D view of a world as HTML elements: its header and its data blocks.
std::string world_view(const results::StudyResults& results, const std::string& world,
                       std::size_t worlds, std::size_t runs, const Parallel& parallel,
                       LogSink& log) {
  Scene scene;
  scene.title = world;
  SceneOptions options;
  options.map = MapChoice::kScored;
  options.max_points = std::min(kPointsOfRun, kPoints / std::max<std::size_t>(runs, 1));
  for (const results::RunRecord* row : first_seed_rows(results, world)) {
    if (fs::exists(row->folder / "scored.ply")) add_run(scene, row->folder, options, log);
  }
  if (scene.clouds.empty()) return {};
  for (SceneMesh& mesh : scene.meshes) mesh.mesh = simplified(mesh.mesh, kTriangles / worlds);
  const PackedScene packed = pack(scene, parallel);
  const std::string id = escaped(world);
  std::string html = fmt::format("<script type='application/json' id='scene-{}'>{}</script>\n", id,
                                 script_json(packed.header));
  for (std::size_t i = 0; i < packed.blocks.size(); ++i) {
    html += fmt::format("<script type='text/plain' id='block-{}-{}'>{}</script>\n", id, i,
                        base64(packed.blocks[i]));
  }
  return html;
}

std::string section_html(const ReportSection& section, const std::vector<WorldPictures>& pictures) {
  std::string html =
      fmt::format("<h2 id='{}'>{}</h2>", escaped(section.id), escaped(section.title));
  std::istringstream paragraphs(section.text);
  for (std::string text; std::getline(paragraphs, text);) html += "<p>" + escaped(text) + "</p>";
  for (std::size_t i = 0; i < section.tables.size(); ++i) {
    ReportTable table = section.tables[i];
    const bool is_repeated =
        i + 1 < section.tables.size() && section.tables[i + 1].note == table.note;
    if (is_repeated) table.note.clear();  // tables side by side show a common note once
    html += table_html(table);
  }
  if (section.id == "costs") html += "<div class='figures' id='figures'></div>";
  if (section.world.empty()) return html;
  const std::string id = escaped(section.world);
  const auto of_world = std::ranges::find(pictures, section.world, &WorldPictures::world);
  if (of_world == pictures.end()) return html;
  const std::size_t budget = kPictureBytes / pictures.size();
  return html + figures(of_world->place, budget) +
         fmt::format(
             "<h3>Maps and paths</h3><div id='view-{0}' class='lidarena-view embedded timed'>"
             "<p class='message'></p><div class='fallback'>{1}{2}</div><div class='stage'></div>"
             "<div class='progress'></div></div><div class='figures' id='figures-{0}'></div>",
             id, color_key(), figures(of_world->maps, budget));
}

/// The machines and versions of lidarena that the runs were made with.
std::string made_on(const results::StudyResults& results) {
  std::vector<std::string> machines;
  for (const results::RunRecord& row : results.rows) {
    if (!row.manifest.is_object() || !row.manifest.contains("made_on")) continue;
    const Json& on = row.manifest.at("made_on");
    const std::string machine =
        fmt::format("{}, {} cores, {} GiB, lidarena {}", on.value("processor", ""),
                    on.value("cores", 0), on.value("memory_gib", 0.0), on.value("lidarena", ""));
    if (std::ranges::find(machines, machine) == machines.end()) machines.push_back(machine);
  }
  return machines.empty() ? "" : fmt::format("Runs made on: {}. ", fmt::join(machines, "; "));
}

std::string without_bundle() {
  return "<p class='note'>This build has no viewer, so charts and 3D views are left out; "
         "results.csv and the files in tables/ hold all figures.</p>";
}

constexpr const char* kTiming =
    "The same flights, simulated in several timing modes. rolling: every shot is cast from the "
    "pose at its own instant, as a real sensor does. frozen: all shots of a scan are cast from the "
    "pose at its stamp, but have time stamps as if the sensor had moved. frozen_unstamped: the "
    "same, without time stamps per point. official: like frozen_unstamped, and every range is too "
    "short by the sensor's minimum range, as in the manufacturer's simulation plugin. Differences "
    "between the columns are caused by the simulator, not by the algorithm.";
constexpr const char* kDefinitions =
    "RPE: the true path is cut into segments of 1 m that begin and end at estimated poses; in "
    "each, the estimated motion is compared with the true one; root mean square over all segments. "
    "ATE: distance between the two paths after aligning them. Map: point-to-mesh distance to the "
    "same mesh that was scanned. All figures are those of the final trajectory; metrics.json in "
    "each run's folder also holds those of the live trajectory, of other segment lengths and "
    "alignments, and the id of each definition. A run that failed or diverged stays in the tables "
    "with its reason.";

ReportSection summary_section(const results::StudyResults& results) {
  const auto ok = std::count_if(results.rows.begin(), results.rows.end(),
                                [](const results::RunRecord& r) { return r.status == "ok"; });
  std::string text = fmt::format("{} of {} runs succeeded.", ok, results.rows.size());
  for (const std::string& preset : results::variants_of(results)) {
    std::size_t holds = 0;
    std::size_t fails = 0;
    for (const results::Judgement& judged : results::judge(results, preset)) {
      if (judged.holds) ++(*judged.holds ? holds : fails);
    }
    if (holds + fails == 0) continue;
    text += fmt::format(
        " Preset {}: of the study's expectations that these runs can judge, {} hold and {} fall "
        "short.",
        preset, holds, fails);
  }
  ReportSection section{"summary", "Summary", text, "", {winners_table(results)}};
  if (ReportTable failures = failures_table(results); !failures.rows.empty()) {
    section.tables.push_back(std::move(failures));
  }
  return section;
}

}  // namespace

std::vector<ReportSection> report_sections(const results::StudyResults& results) {
  std::vector<ReportSection> sections{summary_section(results), decision_section(results)};
  if (!results.expect.empty()) {
    ReportSection expectations{"expectations", "What the study expects", "", "", {}};
    for (const std::string& variant : results::variants_of(results))
      expectations.tables.push_back(expectations_table(results, variant));
    sections.push_back(std::move(expectations));
  }
  for (const std::string& variant : results::variants_of(results)) {
    sections.push_back({"figures-" + variant, "Figures by sensor and algorithm, " + variant, "", "",
                        figure_tables(results, variant)});
  }
  if (std::vector<ReportTable> tables = timing_tables(results); !tables.empty()) {
    sections.push_back({"timing", "Effect of the simulator's timing", kTiming, "", tables});
  }
  for (const std::string& world : worlds_of(results)) {
    sections.push_back({"world-" + world, world, "", world, {runs_table(results, world)}});
  }
  sections.push_back({"costs", "Error against cost", "", "", {}});
  sections.push_back(
      {"again", "How to reproduce these results", kDefinitions, "", {commands_table(results)}});
  return sections;
}

std::string html_page(const results::StudyResults& results,
                      const std::vector<ReportSection>& sections,
                      const std::vector<WorldPictures>& pictures, const Json& data,
                      const Parallel& parallel, LogSink& log) {
  const std::vector<std::string> worlds = worlds_of(results);
  std::size_t runs = 0;
  for (const std::string& world : worlds) runs += first_seed_rows(results, world).size();
  std::string body;
  std::string nav;
  for (const ReportSection& section : sections) {
    body += section_html(section, pictures);
    nav += fmt::format("<a href='#{}'>{}</a>", escaped(section.id), escaped(section.title));
  }
  const bool bundled = has_viewer();
  std::string scripts;
  if (bundled) {
    for (const std::string& world : worlds) {
      scripts += world_view(results, world, worlds.size(), runs, parallel, log);
    }
    scripts += fmt::format(
        "<script type='application/json' id='data'>{}</script>\n<script>{}</script>\n"
        "<script type='text/plain' id='licenses'>{}</script>\n",
        script_json(data), web_bundle("report.js"), escaped(web_bundle("licenses.txt")));
  }
  return fmt::format(
      "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
      "<meta name='viewport' content='width=device-width,initial-scale=1'>"
      "<link rel='icon' href='data:,'><title>{0}</title>"
      "<style>{1}{2}</style></head><body><main><h1>{0}</h1><nav>{3}</nav>{4}{5}"
      "<p class='note'>{7}This page was made by lidarena {6} from the result files "
      "only.</p></main>\n{8}</body></html>\n",
      escaped(results.title), kStyle, web_bundle("report.css"), nav, body,
      bundled ? "" : without_bundle(), LIDARENA_VERSION, escaped(made_on(results)), scripts);
}

}  // namespace lidarena::report
