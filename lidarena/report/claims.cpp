// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/report/paper_tables.hpp"
#include "lidarena/report/table.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr double kSimilarRatio =
    1.25;  // ratio; the paper calls 1.78 and 1.53 (1.16) largely unaffected
constexpr double kTenfoldMinRatio = 5.0;  // minimum ratio: "tenfold", within a factor of two
constexpr double kMaxEasyOutliers_percent =
    5;  // the paper has at most 4.24 % outliers in the House
constexpr double kMinLinearRSquared =
    0.9;  // minimum r squared of a line fit for growth to be linear

struct Place {
  std::string name;   ///< in the study
  std::string paper;  ///< in the paper
};

/// The study's worlds or sensors that correspond to the paper's.
std::vector<Place> places(const std::vector<std::string>& names,
                          std::string (*paper_name)(const std::string&)) {
  std::vector<Place> found;
  for (const std::string& name : names) {
    if (!paper_name(name).empty()) found.push_back({name, paper_name(name)});
  }
  return found;
}

std::string shown(std::optional<double> value) {
  const std::string text = figure(value).text;
  return text.empty() ? "not measured" : text;
}

class ClaimChecker {
 public:
  ClaimChecker(const results::StudyResults& results, const std::string& preset)
      : cells_(results, preset, true),
        worlds_(places(cells_.worlds(), results::paper_world)),
        sensors_(places(cells_.sensors(), results::paper_sensor)) {}

  /// `algorithm` has the lowest (sign +1) or highest (sign -1) drift in all worlds, with all
  /// sensors.
  Claim extreme(const std::string& algorithm, double sign, Claim claim) const {
    for (const Place& world : worlds_) {
      for (const Place& sensor : sensors_) {
        const auto own = drift(world, sensor, algorithm);
        std::optional<double> rival;
        std::string rival_name;
        for (const std::string& other : cells_.algorithms()) {
          const auto theirs = drift(world, sensor, other);
          if (other == algorithm || !theirs) continue;
          if (!rival || sign * *theirs < sign * *rival) rival = theirs, rival_name = other;
        }
        if (!own || !rival) continue;
        judge(claim, sign * *own < sign * *rival);
        claim.evidence.push_back(fmt::format("{}, {}: {} cm per m, against {} of {}", world.name,
                                             sensor.name, shown(own), shown(rival), rival_name));
      }
    }
    return claim;
  }

  Claim ct_icp_independent_of_sensor(Claim claim) const {
    for (const Place& world : worlds_) {
      const auto mid = at(world.paper, "Mid-360", "ct_icp", results::rpe_of);
      const auto os0 = at(world.paper, "Os0-128", "ct_icp", results::rpe_of);
      if (!mid || !os0) {
        add_failures(claim, world.paper, "ct_icp");
        continue;
      }
      judge(claim, std::max(*mid / *os0, *os0 / *mid) < kSimilarRatio);
      claim.evidence.push_back(fmt::format("{}: {} cm per m with the Mid-360, {} with the Os0-128",
                                           world.name, shown(mid), shown(os0)));
    }
    return claim;
  }

  /// In `world`, the figure `of` with the sensor `worse` exceeds `factor` times the other sensor's.
  Claim sensor_matters(const std::string& world, const std::string& algorithm,
                       const std::string& worse, const results::RowFigure& of, double factor,
                       const char* unit, Claim claim) const {
    const std::string better = worse == "Mid-360" ? "Os0-128" : "Mid-360";
    const auto high = at(world, worse, algorithm, of);
    const auto low = at(world, better, algorithm, of);
    if (!high || !low) {
      add_failures(claim, world, algorithm);
      return claim;
    }
    const auto lost = [&](const std::string& sensor) {
      return at(world, sensor, algorithm, results::outliers_of).value_or(0.0) >
             results::kTrackingLostOutliers_percent;
    };
    if (lost(worse) && lost(better)) {
      claim.evidence.push_back(world + ": tracking lost with both sensors");
      return claim;
    }
    judge(claim, *high > factor * *low);
    claim.evidence.push_back(fmt::format("{}: {} {} with the {}, {} with the {}", world,
                                         shown(high), unit, worse, shown(low), better));
    return claim;
  }

  Claim loop_closure_improves_cave(Claim claim) const {
    for (const Place& sensor : sensors_) {
      const auto with = at("Cave", sensor.paper, "lio_sam_lc", results::outliers_of);
      const auto without = at("Cave", sensor.paper, "lio_sam", results::outliers_of);
      if (!with || !without) continue;
      if (*without == 0.0) {
        claim.evidence.push_back(sensor.name +
                                 ": nothing to improve, 0 % outliers without loop closure");
        continue;
      }
      judge(claim, 2.0 * *with < *without);
      claim.evidence.push_back(fmt::format("{}: {} % outliers with loop closure, {} % without",
                                           sensor.name, shown(with), shown(without)));
    }
    return claim;
  }

  Claim loop_closure_worsens_house(Claim claim) const {
    const auto with = at("House", "Mid-360", "lio_sam_lc", results::outliers_of);
    const auto without = at("House", "Mid-360", "lio_sam", results::outliers_of);
    if (!with || !without) return claim;
    judge(claim, *with > *without);
    claim.evidence.push_back(
        fmt::format("{} % outliers with loop closure, {} % without", shown(with), shown(without)));
    return claim;
  }

  Claim house_is_easy(Claim claim) const {
    for (const Place& sensor : sensors_) {
      for (const std::string& algorithm : cells_.algorithms()) {
        const auto outliers = at("House", sensor.paper, algorithm, results::outliers_of);
        if (!outliers) continue;
        judge(claim, *outliers < kMaxEasyOutliers_percent);
        claim.evidence.push_back(
            fmt::format("{}, {}: {} % outliers", algorithm, sensor.name, shown(outliers)));
      }
    }
    return claim;
  }

  Claim lio_sam_grows_less(Claim claim) const {
    for (const Place& sensor : sensors_) {
      const auto growth = [&](const std::string& algorithm) -> std::optional<double> {
        const auto cave = at("Cave", sensor.paper, algorithm, results::rpe_of);
        const auto house = at("House", sensor.paper, algorithm, results::rpe_of);
        if (!cave || !house) return std::nullopt;
        return drift_increase_of_the_paper(*cave, *house);
      };
      const auto sam = growth("lio_sam");
      const auto fast = growth("fast_lio2");
      if (!sam || !fast) continue;
      judge(claim, *sam < *fast);
      claim.evidence.push_back(fmt::format("{}: increase of {} % for LIO-SAM, {} % for FAST-LIO2",
                                           sensor.name, shown(sam), shown(fast)));
    }
    return claim;
  }

  Claim memory_grows(Claim claim) const {
    for (const Place& world : worlds_) {
      for (const Place& sensor : sensors_) {
        for (const results::RunRecord* row : cells_.rows(world.name, sensor.name, "fast_lio2")) {
          const auto line = memory_line(*row);
          if (!line) continue;
          judge(claim, line->r_squared > kMinLinearRSquared && line->slope > 0);
          claim.evidence.push_back(fmt::format(
              "{}, {}, seed {}: {} MB per second{}, r squared {:.2f}", world.name, sensor.name,
              row->seed, shown(line->slope), bytes_per_shot(*row, line->slope), line->r_squared));
        }
      }
    }
    return claim;
  }

 private:
  struct Line {
    double slope = 0.0;
    double r_squared = 0.0;
  };

  /// Least-squares line of the algorithm's own memory over time; empty if it was not measured.
  static std::optional<Line> memory_line(const results::RunRecord& row) {
    if (row.status != "ok" || !fs::exists(row.folder / "resources.csv")) return std::nullopt;
    const auto rows = dataset::read_resources(row.folder / "resources.csv");
    if (rows.size() < 3) return std::nullopt;
    double t = 0.0;
    double m = 0.0;
    for (const dataset::ResourceRow& r : rows) t += r.t_sensor_s, m += results::own_memory_mb(r);
    t /= static_cast<double>(rows.size());
    m /= static_cast<double>(rows.size());
    double tt = 0.0;
    double tm = 0.0;
    double mm = 0.0;
    for (const dataset::ResourceRow& r : rows) {
      const double dt = r.t_sensor_s - t;
      const double dm = results::own_memory_mb(r) - m;
      tt += dt * dt;
      tm += dt * dm;
      mm += dm * dm;
    }
    if (!(tt > 0.0)) return std::nullopt;
    return Line{tm / tt, mm > 0.0 ? tm * tm / (tt * mm) : 0.0};
  }

  /// ", 12 bytes per shot"; empty if the sensor is not known.
  static std::string bytes_per_shot(const results::RunRecord& row, double mb_per_s) {
    if (!row.lidar.is_object()) return {};
    const double shots = row.lidar.value("rows", 0.0) * row.lidar.value("columns", 0.0) *
                         row.lidar.value("rate_hz", 0.0);
    return shots > 0.0 ? fmt::format(", {} bytes per shot", shown(mb_per_s * 1e6 / shots)) : "";
  }

  /// Adds to the evidence the states of the runs of `algorithm` in `world` that did not succeed.
  void add_failures(Claim& claim, const std::string& world, const std::string& algorithm) const {
    for (const Place& w : worlds_) {
      for (const Place& s : sensors_) {
        const std::string state = cells_.status_text(w.name, s.name, algorithm);
        if (w.paper == world && !state.empty()) {
          claim.evidence.push_back(fmt::format("{}, {}: {} {}", w.name, s.name, algorithm, state));
        }
      }
    }
  }

  std::optional<double> drift(const Place& world, const Place& sensor,
                              const std::string& algorithm) const {
    return cells_.median(world.name, sensor.name, algorithm, results::rpe_of);
  }

  std::optional<double> at(const std::string& world, const std::string& sensor,
                           const std::string& algorithm, const results::RowFigure& of) const {
    for (const Place& w : worlds_) {
      for (const Place& s : sensors_) {
        if (w.paper != world || s.paper != sensor) continue;
        if (const auto value = cells_.median(w.name, s.name, algorithm, of)) return value;
      }
    }
    return std::nullopt;
  }

  /// A claim holds when all of its checks do.
  static void judge(Claim& claim, bool check) { claim.holds = claim.holds.value_or(true) && check; }

  results::StudyCells cells_;
  std::vector<Place> worlds_, sensors_;
};

}  // namespace

std::vector<Claim> paper_claims(const results::StudyResults& results, const std::string& preset) {
  const ClaimChecker judge(results, preset);
  const auto claim = [](const char* text, const char* rule, const char* possible_reason) {
    return Claim{text, rule, {}, {}, possible_reason};
  };
  return {
      judge.extreme(
          "fast_lio2", 1.0,
          claim("FAST-LIO2 has the lowest drift on both maps and with both sensors",
                "its RPE over 1 m is below that of every other algorithm (paper: 0.49 to 1.61 cm "
                "per m)",
                "keyframe smoothing with matching to submaps of all earlier passes drifts less at "
                "revisited places than a filter does")),
      judge.extreme("kiss_icp", -1.0,
                    claim("KISS-ICP has the highest drift",
                          "its RPE over 1 m is above that of every other algorithm (paper: 3.34 to "
                          "8.17 cm per m)",
                          "a smoother flight violates its assumption of constant velocity less")),
      judge.ct_icp_independent_of_sensor(
          claim("CT-ICP's drift hardly depends on the sensor",
                "the two sensors' RPE differ by less than a quarter (paper: 1.78 and 1.53, 2.72 "
                "and 2.79 cm per m)",
                "in one scan, a spinning sensor measures each direction once, a rosette pattern "
                "many times: if the body rotates far during the scan, the spinning sensor "
                "constrains the rotation between its start and end less")),
      judge.sensor_matters(
          "Cave", "ct_icp", "Mid-360", results::outliers_of, kTenfoldMinRatio, "% outliers",
          claim("CT-ICP's Cave map has ten times the outliers with the Mid-360",
                "more than five times the outliers with the Mid-360, which is tenfold within a "
                "factor of two (paper: 14.95 against 1.40 %)",
                "the share of points beyond 20 cm depends on a few moments of one flight")),
      judge.sensor_matters(
          "Cave", "kiss_icp", "Os0-128", results::outliers_of, 1.0, "% outliers",
          claim("KISS-ICP's Cave map is worse with the OS0-128",
                "more outliers than with the Mid-360 (paper: 58.25 against 31.91 %)",
                "the points of a scan of the paper's simulated OS0-128 may have shared one time "
                "stamp; without de-skewing, its many points blur the map more")),
      judge.sensor_matters("Cave", "lio_sam", "Mid-360", results::rpe_of, 1.0, "cm per m",
                           claim("LIO-SAM drifts less with the dense sensor in the Cave",
                                 "less drift with the OS0-128 (paper: 1.24 against 2.61 cm per m)",
                                 "the cave has enough geometric structure even for few points")),
      judge.sensor_matters("House", "lio_sam", "Mid-360", results::rpe_of, 1.0, "cm per m",
                           claim("LIO-SAM drifts less with the dense sensor in the House",
                                 "less drift with the OS0-128 (paper: 1.51 against 2.70 cm per m)",
                                 "the paper's version may extract edge and plane features from a "
                                 "Livox scan differently")),
      judge.loop_closure_improves_cave(
          claim("Loop closure improves the Cave map",
                "less than half the outliers (paper: from 10.68 to 3.68 % and from 21.78 to "
                "0.17 %)",
                "if the map is good without loop closure, there is little to improve, and "
                "distortions between two loops remain")),
      judge.loop_closure_worsens_house(
          claim("Loop closure worsens the House map with the Mid-360",
                "more outliers with loop closure (paper: from 2.28 to 4.24 %)",
                "the paper's loops in the House may have been false matches")),
      judge.house_is_easy(claim("The House is easy for all algorithms",
                                "fewer than 5 % outliers for each (paper: at most 4.24 %)",
                                "our flight through the House rotates faster than a human pilot "
                                "would fly")),
      judge.lio_sam_grows_less(
          claim("From Cave to House the drift grows less for LIO-SAM than for FAST-LIO2",
                "by the paper's formula, (house - cave) / house (paper: 3.3 against 32.5 % and "
                "17.9 against 55.8 %)",
                "the ratio of two flights depends more on the flights than on the algorithms")),
      judge.memory_grows(claim(
          "FAST-LIO2's memory grows linearly with time, in proportion to the points",
          "a straight line explains more than 90 % of the variance of the memory of map, scan "
          "buffer and backlog",
          "a downsampled map stops growing where the sensor sees nothing new, and a list "
          "that doubles its capacity when it is full grows in steps"))};
}

}  // namespace lidarena::report
