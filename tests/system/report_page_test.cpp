// SPDX-License-Identifier: BSD-3-Clause
// The page of `lidarena report` in a browser.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/system/browser.hpp"

namespace lidarena::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Writes the result files of a study: two sensors and two methods in one world, three seeds each;
/// the last run has diverged. The first run has a map and a path, its dataset a truth.
void write_study(const fs::path& folder) {
  nlohmann::json study{{"kind", "study"}, {"spec", {{"title", "Twelve runs"}}}, {"runs", {}}};
  int count = 0;
  for (const std::string sensor : {"livox_mid360", "ouster_os0_128"}) {
    for (const std::string algorithm : {"kiss_icp", "fast_lio2"}) {
      for (int seed = 1; seed <= 3; ++seed, ++count) {
        const std::string name = sensor + "-" + algorithm + "-" + std::to_string(seed);
        study["runs"].push_back({{"name", name},
                                 {"world", "cave"},
                                 {"flight", "cave"},
                                 {"sensor", sensor},
                                 {"algorithm", algorithm},
                                 {"preset", "indoor"},
                                 {"seed", seed}});
        const fs::path run = folder / "runs" / name;
        fs::create_directories(run);
        std::ofstream(run / "manifest.json")
            << nlohmann::json{{"kind", "run"}, {"dataset", "../../datasets/flight"}};
        std::vector<double> t, error;
        for (int i = 0; i < 30; ++i) {
          t.push_back(0.1 * i);
          error.push_back(0.001 * i);
        }
        const nlohmann::json curve{{"t_s", t}, {"translation_m", error}, {"rotation_rad", error}};
        const nlohmann::json rmse{{"count", 9}, {"rmse_m", 0.012 + 0.001234 * count}};
        const nlohmann::json final{{"rpe", {{"1m_at_poses", {{"translation", rmse}}}}},
                                   {"errors_over_time", {{"ate_se3", curve}}}};
        std::ofstream(run / "metrics.json")
            << nlohmann::json{{"schema_version", 3},
                              {"status", count == 11 ? "diverged" : "ok"},
                              {"reason", count == 11 ? "left the <world>" : ""},
                              {"final", final}};
        const nlohmann::json over_time{{"t_s", t},
                                       {"latency_s", error},
                                       {"map_bytes", t},
                                       {"scan_buffer_bytes", t},
                                       {"backlog_bytes", t}};
        std::ofstream(run / "resources.json") << nlohmann::json{{"scans", 30},
                                                                {"cpu_load_percent", 50.0},
                                                                {"latency", {{"count", 30}}},
                                                                {"own", {{"peak_bytes", 3000110}}},
                                                                {"over_time", over_time}};
      }
    }
  }
  std::ofstream(folder / "plan.json") << study;
  const fs::path run = folder / "runs" / "livox_mid360-kiss_icp-1";
  fs::create_directories(folder / "datasets" / "flight");
  std::ofstream(run / "scored.ply") << floor_ply();
  std::ofstream(run / "events.csv")
      << "t_sensor_s,duration_s,kind,value\n0.5,1,fast_turn,90\n1.2,0,loop,1\n1.9,0,loop,2\n";
  for (const fs::path& file :
       {run / "trajectory.tum", folder / "datasets" / "flight" / "truth.tum"}) {
    std::ofstream(file) << "0 1 1 1 0 0 0 1\n1 2 1 1 0 0 0 1\n2 3 1 1 0 0 0 1\n";
  }
}

/// The size of the quick study: two worlds, two sensors, eight methods, a map of every run. In the
/// world `two` the map of the last run is the worst.
void write_quick_study(const fs::path& folder) {
  nlohmann::json study{{"kind", "study"}, {"spec", {{"title", "Quick"}}}, {"runs", {}}};
  int count = 0;
  for (const std::string world : {"one", "two"}) {
    for (const std::string sensor : {"livox_mid360", "ouster_os0_128"}) {
      for (int method = 0; method < 8; ++method, ++count) {
        const std::string name =
            world + "-" + sensor + "-a_long_name_" + std::to_string(method) + "-indoor";
        study["runs"].push_back({{"name", name},
                                 {"world", world},
                                 {"flight", "round"},
                                 {"sensor", sensor},
                                 {"algorithm", "a_long_name_" + std::to_string(method)},
                                 {"preset", "indoor"},
                                 {"seed", 1}});
        const fs::path run = folder / "runs" / name;
        fs::create_directories(run);
        std::ofstream(run / "manifest.json") << nlohmann::json{{"kind", "run"}};
        const nlohmann::json rmse{{"count", 9}, {"rmse_m", 0.01 + 0.001 * count}};
        const nlohmann::json map{{"points", 9}, {"distance", rmse}};
        std::ofstream(run / "metrics.json")
            << nlohmann::json{{"schema_version", 3},
                              {"status", "ok"},
                              {"final", {{"rpe", {{"1m_at_poses", {{"translation", rmse}}}}}}},
                              {"maps", {{"reprojected", {{"se3", map}}}}}};
        // the more methods, the cheaper: four of eight are on the front with either sensor
        std::ofstream(run / "resources.json") << nlohmann::json{
            {"scans", 30}, {"cpu_load_percent", method < 4 ? 50.0 - method : 90.0}};
        std::ofstream(run / "scored.ply") << floor_ply();
        std::ofstream(run / "trajectory.tum") << "0 1 1 1 0 0 0 1\n1 2 1 1 0 0 0 1\n";
      }
    }
  }
  std::ofstream(folder / "plan.json") << study;
}

class ReportInBrowser : public ViewInBrowser {
 protected:
  void SetUp() override {
    ViewInBrowser::SetUp();
    if (IsSkipped()) return;
    write_study(path("study"));
    const Outcome made = call("report study");
    ASSERT_EQ(made.exit_code, 0) << made.err;
    page_ = content(path("study") + "/report.html");
  }
  /// Opens the page at `state` and runs `script` one (virtual) second later; the value that this
  /// returns, as JSON.
  nlohmann::json evaluate(const std::string& script, const std::string& state = "",
                          const std::string& gl = kSoftwareGl) {
    write("page.html",
          page_ +
              "<script>const until = async ready => { for (let i = 0; i < 150 && !ready(); ++i) "
              "await new Promise(done => setTimeout(done, 100)); }; setTimeout(async () => { const "
              "value = await (async () => {" +
              script +
              "})(); document.documentElement.dataset.test = "
              "encodeURIComponent(JSON.stringify(value)) }, 1000)</script>");
    const std::string dom = browse("--dump-dom", state, gl);
    if (gl == kSoftwareGl) {
      EXPECT_THAT(page_errors(), ElementsAre());
    }
    const std::string mark = "data-test=\"";
    const std::size_t begin = dom.find(mark);
    if (begin == std::string::npos) return nullptr;
    const std::size_t from = begin + mark.size();
    return nlohmann::json::parse(decoded(dom.substr(from, dom.find('"', from) - from)));
  }
  static std::string decoded(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '%') {
        out += text[i];
      } else {
        out += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
        i += 2;
      }
    }
    return out;
  }
  /// The values of a column of results.csv by sensor and method, infinite for runs that are lost.
  std::map<std::string, std::vector<double>> column_of_csv(const std::string& name) const {
    std::istringstream lines(content(path("study") + "/results.csv"));
    std::map<std::string, std::vector<double>> values;
    std::vector<std::string> head;
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::istringstream in(line);
      for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
      if (head.empty()) {
        head = cells;
        continue;
      }
      const auto column = std::find(head.begin(), head.end(), name) - head.begin();
      values[cells.at(3) + "|" + cells.at(4) + " (indoor)"].push_back(
          cells.at(8) == "ok" ? std::stod(cells.at(static_cast<std::size_t>(column)))
                              : std::numeric_limits<double>::infinity());
    }
    return values;
  }

  std::string page_;
};

constexpr const char* kMatrix =
    "return Object.fromEntries([...document.querySelectorAll('#matrix [data-cell]')].map(cell => "
    "[cell.dataset.cell, [Number(cell.dataset.median), cell.textContent]]));";

TEST_F(ReportInBrowser, TheFirstScreenHasTheMediansOfResultsCsvAndMarksWhatFailed) {
  const auto expected = column_of_csv("rpe_1m_at_poses_translation_cm");
  ASSERT_EQ(expected.size(), 4U);
  const nlohmann::json cells = evaluate(kMatrix);
  ASSERT_EQ(cells.size(), 4U) << cells;
  for (auto [cell, values] : expected) {
    std::sort(values.begin(), values.end());
    ASSERT_EQ(values.size(), 3U);
    const double median = values[1];
    EXPECT_NEAR(cells.at(cell).at(0).get<double>(), median, 1e-5 * median) << cell;
  }
  const std::string failed = cells.at("ouster_os0_128|fast_lio2 (indoor)").at(1);
  EXPECT_THAT(failed, AllOf(HasSubstr("– lost2 of 3"), HasSubstr("1 diverged")));
  const nlohmann::json memory = evaluate(kMatrix, "#figure=own_memory_peak");
  EXPECT_EQ(memory.at("livox_mid360|kiss_icp (indoor)").at(0), 3.00011);
}

TEST_F(ReportInBrowser, ThreePairsSupportNoMarkAndTheDecisionSaysSo) {
  const nlohmann::json seen = evaluate(
      "return [document.querySelectorAll('#matrix td.best').length, "
      "document.querySelector('#matrix .note').textContent, "
      "document.querySelector('#decision').textContent]");
  EXPECT_EQ(seen.at(0), 0);
  EXPECT_THAT(seen.at(1).get<std::string>(),
              AllOf(HasSubstr("None is framed"), HasSubstr("3 pairs: too few for a claim")));
  const std::string decision = seen.at(2);
  EXPECT_THAT(decision, AllOf(HasSubstr("1 of 4 combinations on the Pareto front"),
                              HasSubstr("3 pairs: too few for a claim"),
                              HasSubstr("ouster_os0_128 with fast_lio2 (indoor): lost in 1 of 3")));
}

TEST_F(ReportInBrowser, WeightsStandInTheAddressAndLostRunsMakeAMedianLost) {
  const nlohmann::json changed = evaluate(
      "const input = document.querySelector('input[name=weight-price]'); input.value = 4; "
      "input.onchange(); return [location.hash, "
      "document.querySelector('input[name=weight-price]').value]");
  EXPECT_EQ(changed, nlohmann::json({"#weight-price=4", "4"}));
  const nlohmann::json linked = evaluate(
      "return document.querySelector('input[name=weight-drift]').value", "#weight-drift=0.5");
  EXPECT_EQ(linked, "0.5");
  const nlohmann::json lost = evaluate(
      "return document.querySelector('#matrix [data-cell=\"ouster_os0_128|fast_lio2 "
      "(indoor)\"]').dataset.median",
      "#seed=3");
  EXPECT_EQ(lost, "lost");
}

TEST_F(ReportInBrowser, ItDrawsItsChartsAndReachesForNoNetwork) {
  const nlohmann::json seen = evaluate(
      "document.querySelectorAll('#charts .chart').forEach(c => c.scrollIntoView());"
      "return {figures: document.documentElement.dataset.figures, ready: "
      "document.documentElement.dataset.ready, reached: performance.getEntriesByType('resource')"
      ".map(e => e.name).filter(n => !n.startsWith('data:') && !n.startsWith('blob:')),"
      "sections: [...document.querySelectorAll('main > section')].map(s => s.id)}");
  EXPECT_EQ(seen.at("ready"), "1");
  // error over time, memory over time, spread over seeds, error against computing time and memory
  EXPECT_EQ(seen.at("figures"), "5");
  EXPECT_EQ(seen.at("reached"), nlohmann::json::array());
  EXPECT_EQ(seen.at("sections"),
            nlohmann::json({"overview", "scenes", "charts", "runs", "tables", "again"}));
  for (const char* file :
       {"results.csv", "report.json", "tables/runs-cave.csv", "tables/runs-cave.md",
        "tables/runs-cave.tex", "tables/runs-cave.json", "tables/decision-cave.csv"}) {
    EXPECT_TRUE(fs::exists(path("study") + "/" + file)) << file;
  }
  if (std::system("command -v node >/dev/null") != 0) return;
  for (const char* id : {"drift-cave", "memory-cave", "spread-cave", "pareto-cpu", "pareto-memory",
                         "map-cave-livox_mid360-kiss_icp-indoor"}) {
    EXPECT_THAT(content(path("study") + "/figures/" + id + ".svg"), HasSubstr("<svg")) << id;
  }
}

TEST_F(ReportInBrowser, FiltersStandInTheAddressAndApplyToTheMatrixAndTheRuns) {
  const std::string rows =
      "const rows = () => [...document.querySelectorAll('#table-runs tbody tr')].map(r => "
      "r.cells[0].textContent); const cells = () => document.querySelectorAll('#matrix "
      "[data-cell]').length;";
  const nlohmann::json of_link =
      evaluate(rows + "return [cells(), rows().length]", "#sensor=livox_mid360&seed=2");
  EXPECT_EQ(of_link, nlohmann::json({2, 2}));
  const nlohmann::json chosen =
      evaluate(rows +
               "const select = document.querySelector('select[name=method]'); select.value = "
               "'kiss_icp'; select.onchange(); return [cells(), rows().length, location.hash]");
  EXPECT_EQ(chosen, nlohmann::json({2, 6, "#method=kiss_icp"}));
}

TEST_F(ReportInBrowser, TablesSortByTheirFiguresInBothDirections) {
  const nlohmann::json sorted = evaluate(
      "const head = [...document.querySelectorAll('#table-runs thead button')].find(b => "
      "b.textContent.startsWith('RPE per meter, pose to pose, cm')); const first = () => "
      "document.querySelector('#table-runs tbody th').textContent; head.click(); const up = "
      "first(); head.click(); return [up, first()];");
  EXPECT_EQ(sorted, nlohmann::json({"livox_mid360-kiss_icp-1", "ouster_os0_128-fast_lio2-3"}));
}

TEST_F(ReportInBrowser, ACellOpensItsRunWithItsMapChartsAndCommand) {
  const std::string opened =
      "document.querySelector('#matrix [data-cell=\"livox_mid360|kiss_icp (indoor)\"] "
      "button').click();";
  const nlohmann::json run =
      evaluate(opened +
               "return [location.hash, document.querySelectorAll('#run .chart').length, "
               "document.querySelector('#run .command').textContent.includes('lidarena run "
               "kiss_icp')]");
  EXPECT_EQ(run, nlohmann::json({"#run=livox_mid360-kiss_icp-1", 4, true}));
  const nlohmann::json later = evaluate(
      "await until(() => document.documentElement.dataset.view); return "
      "[document.documentElement.dataset.view, document.querySelectorAll('#run "
      ".chart').length, document.querySelectorAll('#run canvas').length]",
      "#run=livox_mid360-kiss_icp-1");
  EXPECT_EQ(later, nlohmann::json({"livox_mid360-kiss_icp-1", 4, 1}));
  const nlohmann::json without_gl = evaluate(
      "await until(() => document.documentElement.dataset.picture); return "
      "[document.documentElement.dataset.picture, document.querySelectorAll('#run .map "
      "svg image').length]",
      "#run=livox_mid360-kiss_icp-1", "--disable-gpu --disable-3d-apis");
  EXPECT_EQ(without_gl, nlohmann::json({"livox_mid360-kiss_icp-1", 1}));
  const nlohmann::json without_points = evaluate(
      "return document.querySelector('#run').textContent", "#run=ouster_os0_128-fast_lio2-3");
  EXPECT_THAT(without_points.get<std::string>(),
              AllOf(HasSubstr("diverged: left the <world>"), HasSubstr("no points of this run")));
}

TEST_F(ReportInBrowser, TheTimeLineOfTheMapMovesAMarkThroughTheCharts) {
  // All charts are drawn as for paper: those in sight alone would have to wait for frames, of which
  // virtual time gives few.
  const nlohmann::json marks = evaluate(
      "const marks = () => [...document.querySelectorAll('#run .charts svg path')].filter(p => "
      "p.getAttribute('stroke') === '#f97316').length; "
      "window.dispatchEvent(new Event('beforeprint')); "
      "await until(() => document.documentElement.dataset.view); const time = "
      "document.querySelector('#run .timebar input'); time.value = 1; time.oninput(); "
      "await until(() => marks() === 4); return [time.value, marks()];",
      "#run=livox_mid360-kiss_icp-1");
  EXPECT_EQ(marks, nlohmann::json({"1", 4}));
}

TEST_F(ReportInBrowser, EventsOfARunAreBarsWithALegendAndFastTurnsShadeTheError) {
  const nlohmann::json seen = evaluate(
      "const strip = document.querySelector('#run-events .chart'); "
      "strip.scrollIntoView(); await until(() => strip.querySelector('svg')); "
      "const bars = color => [...strip.querySelectorAll('svg path')].filter(p => "
      "p.getAttribute('fill') === color && p.getBBox().height < 11).map(p => "
      "Math.round(p.getBBox().width)); return [strip.textContent, bars('#d9a441').length, "
      "bars('#0f766e').length, bars('#d9a441')[0] > 10 * bars('#0f766e')[0], "
      "document.querySelector('#run-error').textContent];",
      "#run=livox_mid360-kiss_icp-1");
  ASSERT_TRUE(seen.is_array());
  EXPECT_THAT(seen.at(0).get<std::string>(), AllOf(HasSubstr("fast turn"), HasSubstr("loop closed"),
                                                   Not(HasSubstr("degenerate"))));
  EXPECT_GE(seen.at(1), 1) << seen;
  EXPECT_GE(seen.at(2), 2) << seen;
  EXPECT_EQ(seen.at(3), true) << "a second against an instant";
  EXPECT_THAT(seen.at(4).get<std::string>(), HasSubstr("shaded: fast turns"));
  const nlohmann::json unknown = evaluate("return document.querySelectorAll('#run-events').length",
                                          "#run=livox_mid360-kiss_icp-2");
  EXPECT_EQ(unknown, 0) << "a run without the file";
}

TEST_F(ReportInBrowser, TheFirstScreenOfTheQuickStudyFits1280x800AndTheAddressChoosesItsPicture) {
  write_quick_study(path("quick"));
  const Outcome made = call("report quick");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  page_ = content(path("quick") + "/report.html");
  window_ = "1280,800";
  const std::string look =
      "await until(() => document.documentElement.dataset.seen); const end = s => "
      "Math.round(document.querySelector(s).getBoundingClientRect().bottom); return "
      "{ends: ['header .compared', '#decision', '.seen', '#matrix table'].map(end), inner: "
      "[innerWidth, innerHeight], wide: document.documentElement.scrollWidth, hidden: (v => "
      "v.scrollHeight - v.clientHeight)(document.querySelector('.verdicts')), front: "
      "document.querySelectorAll('.front tbody tr:not(.world)').length, picture: "
      "document.querySelector('.seen').textContent, options: "
      "[...document.querySelectorAll('select[name=front] option')].map(o => o.value)};";
  const nlohmann::json seen = evaluate(look);
  ASSERT_TRUE(seen.is_object());
  for (const nlohmann::json& end : seen.at("ends")) EXPECT_LE(end, 800) << seen;
  EXPECT_EQ(seen.at("wide"), 1280) << "no scrolling sideways";
  EXPECT_EQ(seen.at("front"), 8) << seen;
  EXPECT_LE(seen.at("hidden"), 1) << "all of the answer is in sight: " << seen;
  EXPECT_THAT(seen.at("picture").get<std::string>(), HasSubstr("highest: ouster_os0_128"));
  EXPECT_EQ(seen.at("options"), nlohmann::json({"one", "two"}));

  const nlohmann::json linked = evaluate(look, "#front=two");
  EXPECT_THAT(linked.at("picture").get<std::string>(), HasSubstr(": 4.1 cm")) << "the last run";
  const nlohmann::json chosen = evaluate(
      "await until(() => document.documentElement.dataset.seen); const select = () => "
      "document.querySelector('select[name=front]'); select().focus(); select().value = 'two'; "
      "select().onchange(); await until(() => document.querySelector('.seen').textContent.includes("
      "': 4.1 cm')); return [location.hash, select().value, document.activeElement === select()];");
  EXPECT_EQ(chosen, nlohmann::json({"#front=two", "two", true}));
}

TEST_F(ReportInBrowser, TheKeyboardMovesThroughCellsAndRunsAndTheFocusStays) {
  const std::string keys =
      "const press = key => document.activeElement.dispatchEvent(new KeyboardEvent('keydown', "
      "{key, "
      "bubbles: true, cancelable: true})); const cell = () => "
      "document.activeElement.closest('td')?.dataset.cell ?? ''; const run = () => "
      "decodeURIComponent(location.hash); document.querySelector('#matrix td button').focus(); ";
  const nlohmann::json cells = evaluate(
      keys +
      "return ['Home', 'ArrowRight', 'ArrowRight', 'ArrowDown', 'ArrowLeft', 'ArrowUp', 'End']"
      ".map(key => { press(key); return cell(); });");
  const std::string mid = "livox_mid360|", os0 = "ouster_os0_128|", kiss = "kiss_icp (indoor)",
                    fast = "fast_lio2 (indoor)";
  EXPECT_EQ(cells, nlohmann::json({mid + kiss, mid + fast, mid + fast, os0 + fast, os0 + kiss,
                                   mid + kiss, mid + fast}));
  const nlohmann::json runs = evaluate(
      keys +
      "document.activeElement.click(); const out = [run(), document.activeElement.id]; "
      "for (const key of ['PageDown', 'PageDown', 'PageUp']) { press(key); out.push(run(), "
      "document.activeElement.id); } document.querySelector('#run [title^=next]').focus(); "
      "document.activeElement.click(); out.push(run(), document.activeElement.title); "
      "press('Escape'); out.push(run(), cell(), document.querySelectorAll('#run').length); "
      "return out;");
  const std::string first = "#run=livox_mid360-kiss_icp-";
  EXPECT_EQ(runs,
            nlohmann::json({first + "1", "run", first + "2", "run", first + "3", "run", first + "2",
                            "run", first + "3", "next run (Page down)", "", mid + kiss, 0}));
  const nlohmann::json kept = evaluate(
      "const figure = document.querySelector('[data-figure=cpu_load]'); figure.focus(); "
      "figure.click(); const now = document.activeElement; "
      "return [now.dataset.figure, now !== figure, now.matches(':focus')];");
  EXPECT_EQ(kept, nlohmann::json({"cpu_load", true, true}));
}

}  // namespace
}  // namespace lidarena::testing
