// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/results/expectation.hpp"
#include "lidarena/results/map_metrics.hpp"
#include "lidarena/results/resource_metrics.hpp"
#include "lidarena/results/table.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

/// The data of the report's page, report.json. The types of the page's TypeScript are made from
/// these lists of fields (viewer/page_types.mjs).
namespace lidarena::report {

/// A figure of results/figures.hpp.
struct FigureInfo {
  static constexpr const char* kTitle = "FigureInfo";
  std::string key, label, unit;
  bool more_is_better = false;
  bool in_runs = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("key", self.key, "", "");
    v("label", self.label, "", "");
    v("unit", self.unit, "", "");
    v("more_is_better", self.more_is_better, "", "");
    v("in_runs", self.in_runs, "", "whether it is a column of the list of runs");
  }
};

/// A kind of events of dataset/run_events.hpp.
struct EventKind {
  static constexpr const char* kTitle = "EventKind";
  std::string name, label, value;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("label", self.label, "", "");
    v("value", self.value, "", "what the value of an event is, with its unit");
  }
};

/// A run with its figures and curves.
struct PageRun {
  static constexpr const char* kTitle = "Run";
  std::string name, folder, dataset, world, flight, sensor, algorithm, preset, variation;
  Json varied = Json::object();
  std::vector<std::string> differs;
  std::uint64_t seed = 0;
  std::string status, lost, command;
  std::optional<double> ended_at_s = {};
  bool mean_map = false;
  std::optional<std::map<std::string, std::size_t>> statuses = {};
  std::optional<double> coverage_percent = {};
  std::optional<std::vector<std::array<double, 4>>> events = {};
  std::vector<std::optional<double>> values = {};
  std::map<std::string, double> zero_bounds = {};
  std::map<std::string, std::array<std::uint64_t, 2>> sampled = {};
  std::optional<results::DistanceHistogram> own_map = {}, all_returns = {};
  std::optional<results::ErrorsOverTime> error = {}, drift = {};
  std::optional<results::ResourcesOverTime> resources = {};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "of the run's folder");
    v("folder", self.folder, "", "relative to the page");
    v("dataset", self.dataset, "", "");
    v("world", self.world, "", "");
    v("flight", self.flight, "", "");
    v("sensor", self.sensor, "", "");
    v("algorithm", self.algorithm, "", "");
    v("preset", self.preset, "", "with the timing mode of the sensors, if the study sets one");
    v("variation", self.variation, "", "what differs from the base of the study; may be empty");
    v("varied", self.varied, "", "each key that the study varies, with its value in this run");
    v("differs", self.differs, "",
      "those keys whose value is not that of the base; of a named set, its name");
    v("seed", self.seed, "", "");
    v("status", self.status, "", "");
    v("lost", self.lost, "", "why the run is lost (results/lost.hpp); empty if it is not");
    v("ended_at_s", self.ended_at_s, "s", "when the method ended itself");
    v("mean_map", self.mean_map, "", "whether points of its own map are means of several returns");
    v("command", self.command, "", "makes the run again");
    v("statuses", self.statuses, "", "how many scans had which");
    v("coverage_percent", self.coverage_percent, "%", "of the flight, by the trajectory");
    v("events", self.events, "",
      "index of the kind, begin since the first scan and duration (0: an instant) in s, value; in "
      "the order of their begins");
    v("values", self.values, "", "of all figures, in their order");
    v("zero_bounds", self.zero_bounds, "%",
      "upper bound of a share of which 0 of N points were found, by its figure");
    v("sampled", self.sampled, "", "scored points of how many, where a map was sampled");
    v("own_map", self.own_map, "", "as published by the algorithm");
    v("all_returns", self.all_returns, "", "the scored returns, placed by the estimated motion");
    v("error", self.error, "", "after SE(3) alignment");
    v("drift", self.drift, "", "over pieces of 1 m");
    v("resources", self.resources, "", "");
  }
};

/// The geometry of a LiDAR.
struct PageLidar {
  static constexpr const char* kTitle = "Lidar";
  int rows = 0, columns = 0;
  double rate_hz = 0.0, max_range_m = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("rows", self.rows, "", "");
    v("columns", self.columns, "", "");
    v("rate_hz", self.rate_hz, "Hz", "");
    v("max_range_m", self.max_range_m, "m", "");
  }
};

struct PageSensor {
  static constexpr const char* kTitle = "Sensor";
  std::string name;
  std::optional<PageLidar> lidar;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("lidar", self.lidar, "", "");
  }
};

/// A property by which combinations are compared; less is better.
struct PageCriterion {
  static constexpr const char* kTitle = "Criterion";
  std::string key, label, unit;
  double weight = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("key", self.key, "", "");
    v("label", self.label, "", "");
    v("unit", self.unit, "", "");
    v("weight", self.weight, "", "by default");
  }
};

/// A combination of sensor and method in a world.
struct PageCandidate {
  static constexpr const char* kTitle = "Candidate";
  std::string world, sensor, algorithm, preset;
  std::size_t runs = 0, kept = 0;
  std::vector<std::optional<double>> values = {};
  std::vector<results::TableCell> cells;
  results::TableCell own_map;
  std::string verdict;
  bool on_front = false;
  std::string dominated_by;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "");
    v("sensor", self.sensor, "", "");
    v("algorithm", self.algorithm, "", "");
    v("preset", self.preset, "", "");
    v("runs", self.runs, "", "");
    v("kept", self.kept, "", "runs that are not lost");
    v("values", self.values, "", "of the criteria; null: not known or lost");
    v("cells", self.cells, "", "the same as text");
    v("own_map", self.own_map, "", "");
    v("verdict", self.verdict, "", "");
    v("on_front", self.on_front, "", "");
    v("dominated_by", self.dominated_by, "", "");
  }
};

struct PageDecision {
  static constexpr const char* kTitle = "Decision";
  std::vector<PageCriterion> criteria;
  std::vector<PageCandidate> candidates;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("criteria", self.criteria, "", "");
    v("candidates", self.candidates, "", "");
  }
};

/// Which cells are better than which by the test of results/claims.hpp, over all runs.
struct CellClaims {
  static constexpr const char* kTitle = "Claims";
  std::vector<std::string> cells;
  std::map<std::string, std::vector<std::array<std::size_t, 2>>> better;
  std::map<std::string, std::string> words;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("cells", self.cells, "", "");
    v("better", self.better, "", "by figure: better, worse, as indices of cells");
    v("words", self.words, "", "by figure: on how many pairs of runs that rests");
  }
};

/// What one change contributes to a figure, with the interval at 95 %.
struct PageContribution {
  static constexpr const char* kTitle = "Contribution";
  std::string name;
  double value = 0.0;
  std::optional<double> low, high;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("value", self.value, "", "in the unit of the figure");
    v("low", self.low, "", "");
    v("high", self.high, "", "");
  }
};

/// What several changes contribute to a figure, see results/contributions.hpp.
struct PageContributions {
  static constexpr const char* kTitle = "Contributions";
  std::string world, sensor, method, figure;
  std::size_t flights = 0;
  double base = 0.0, all = 0.0;
  std::vector<PageContribution> parts;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "");
    v("sensor", self.sensor, "", "");
    v("method", self.method, "", "with its preset");
    v("figure", self.figure, "", "its key");
    v("flights", self.flights, "", "");
    v("base", self.base, "", "with nothing changed");
    v("all", self.all, "", "with all changed");
    v("parts", self.parts, "", "");
  }
};

/// What one variation does to a figure, see results/changes.hpp.
struct PageChange {
  static constexpr const char* kTitle = "Change";
  std::string world, sensor, method, figure, variation;
  std::size_t flights = 0;
  double value = 0.0;
  std::optional<double> low, high;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "");
    v("sensor", self.sensor, "", "");
    v("method", self.method, "", "with its preset");
    v("figure", self.figure, "", "its key");
    v("variation", self.variation, "", "");
    v("flights", self.flights, "", "flown with the base as well");
    v("value", self.value, "", "median of the differences from the base, in the figure's unit");
    v("low", self.low, "", "of the interval at 95 %");
    v("high", self.high, "", "");
  }
};

struct RunWithoutResult {
  static constexpr const char* kTitle = "RunWithoutResult";
  std::string name, status, reason;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("status", self.status, "", "missing or not flown");
    v("reason", self.reason, "", "");
  }
};

struct ReportData {
  std::string title, version;
  std::vector<std::string> made_on;
  std::vector<FigureInfo> figures;
  std::vector<PageSensor> sensors;
  PageDecision decision;
  CellClaims claims;
  std::vector<PageContributions> contributions;
  std::vector<PageChange> changes;
  std::vector<results::ReferenceFigure> reference;
  std::vector<EventKind> event_kinds;
  std::vector<results::Table> tables;
  std::vector<PageRun> runs;
  std::vector<RunWithoutResult> without_result;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("title", self.title, "", "");
    v("version", self.version, "", "");
    v("made_on", self.made_on, "", "machines and versions of the runs");
    v("figures", self.figures, "", "");
    v("sensors", self.sensors, "", "");
    v("decision", self.decision, "", "");
    v("claims", self.claims, "", "");
    v("contributions", self.contributions, "", "of a study with all combinations of changes");
    v("changes", self.changes, "", "of a study that varies settings");
    v("reference", self.reference, "", "published figures");
    v("event_kinds", self.event_kinds, "", "");
    v("tables", self.tables, "", "");
    v("runs", self.runs, "", "");
    v("without_result", self.without_result, "", "runs that count for no method");
  }
};

}  // namespace lidarena::report
