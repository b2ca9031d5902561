// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/page_claims.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lidarena::report {

using results::Claim;
using results::Contest;
using results::Figure;
using results::StudyCells;
using results::Table;
using results::TableCell;

PageClaims::PageClaims(const StudyCells& cells, Figures within_worlds, Figures over_worlds)
    : sensors_(cells.sensors()), algorithms_(cells.algorithms()) {
  std::vector<Contest> contests;
  for (const Figure* figure : within_worlds) {
    for (const std::string& world : cells.worlds()) add(cells, *figure, world, contests);
  }
  for (const Figure* figure : over_worlds) add(cells, *figure, "", contests);
  claims_ = results::claims_of(contests);
}

void PageClaims::add(const StudyCells& cells, const Figure& figure, const std::string& world,
                     std::vector<Contest>& contests) {
  const auto add_one = [&](const Cell& a, const Cell& b) {
    Contest contest{cells.rows(world, a.sensor, a.algorithm),
                    cells.rows(world, b.sensor, b.algorithm), &figure};
    if (contest.a.empty() || contest.b.empty()) return;
    tests_.push_back({&figure, world, a, b});
    contests.push_back(std::move(contest));
  };
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    for (std::size_t a = 0; a < algorithms_.size(); ++a) {
      const Cell cell{sensors_[s], algorithms_[a]};
      for (std::size_t b = a + 1; b < algorithms_.size(); ++b)
        add_one(cell, {sensors_[s], algorithms_[b]});
      for (std::size_t t = s + 1; t < sensors_.size(); ++t)
        add_one(cell, {sensors_[t], algorithms_[a]});
    }
  }
}

bool PageClaims::is_best(const Figure& figure, const std::string& world, const std::string& sensor,
                         const std::string& algorithm, bool among_methods) const {
  const Cell cell{sensor, algorithm};
  bool best = false;
  for (std::size_t i = 0; i < claims_.size(); ++i) {
    const Test& test = tests_[i];
    if (test.figure != &figure || test.world != world || (test.a != cell && test.b != cell) ||
        (test.a.sensor == test.b.sensor) != among_methods)
      continue;
    best = test.a == cell ? claims_[i].a_is_better : claims_[i].b_is_better;
    if (!best) return false;
  }
  return best;
}

std::string PageClaims::words(const Figure& figure, const std::string& world) const {
  std::vector<Claim> some;
  for (std::size_t i = 0; i < claims_.size(); ++i) {
    if (tests_[i].figure == &figure && tests_[i].world == world) some.push_back(claims_[i]);
  }
  return results::words_of(some);
}

std::size_t PageClaims::tests() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(claims_, [](const Claim& claim) { return claim.p.has_value(); }));
}

TableCell PageClaims::ratio_cell(const Figure& figure, const Cell& of, const Cell& to) const {
  for (std::size_t i = 0; i < claims_.size(); ++i) {
    const Test& test = tests_[i];
    if (test.figure != &figure || !test.world.empty()) continue;
    const bool as_tested = test.a == to && test.b == of;
    if (!as_tested && !(test.a == of && test.b == to)) continue;
    Claim claim = claims_[i];
    if (!claim.ratio || !claim.ratio_95) return {};
    if (!as_tested) {
      claim.ratio = 1.0 / *claim.ratio;
      claim.ratio_95 = results::Interval{1.0 / claim.ratio_95->high, 1.0 / claim.ratio_95->low};
    }
    TableCell cell = results::number(claim.ratio);
    cell.spread = results::number(claim.ratio_95->low).text + " to " +
                  results::number(claim.ratio_95->high).text;
    cell.bold = as_tested ? claim.b_is_better : claim.a_is_better;
    return cell;
  }
  return {};
}

Table PageClaims::matrix(const Figure& figure, const std::string& fixed, bool of_methods) const {
  const std::vector<std::string>& names = of_methods ? algorithms_ : sensors_;
  const auto cell_of = [&](const std::string& name) {
    return of_methods ? Cell{fixed, name} : Cell{name, fixed};
  };
  Table table;
  table.head = {of_methods ? "method, by" : "sensor, by"};
  table.head.insert(table.head.end(), names.begin(), names.end());
  for (const std::string& of : names) {
    std::vector<TableCell> row{results::word(of)};
    bool known = false;
    for (const std::string& to : names) {
      row.push_back(of == to ? TableCell{} : ratio_cell(figure, cell_of(of), cell_of(to)));
      known = known || !row.back().text.empty();
    }
    if (known) table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Table> PageClaims::ratio_tables(const Figure& figure,
                                            const std::string& variant) const {
  std::vector<Table> tables;
  const auto keep = [&](const std::string& fixed, bool of_methods) {
    Table table = matrix(figure, fixed, of_methods);
    if (table.rows.empty()) return;
    const bool is_live = figure.subject == results::Subject::kLiveTrajectory;
    table.id = fmt::format("ratio-{}drift-{}-{}", is_live ? "live-" : "", fixed, variant);
    table.title =
        fmt::format("Ratio of the {} drift, {}, {}", is_live ? "live" : "final", fixed, variant);
    table.note = fmt::format(
        "Row divided by column over the same flights of all worlds: the Hodges-Lehmann ratio, and "
        "in brackets its interval at 95 %. Ranks are taken within each world. Bold: better, at 5 "
        "% after Holm's correction for all {} tests of these tables. Pairs of two lost runs are "
        "no pairs.",
        tests());
    tables.push_back(std::move(table));
  };
  for (const std::string& sensor : sensors_) keep(sensor, true);
  for (const std::string& algorithm : algorithms_) keep(algorithm, false);
  return tables;
}

}  // namespace lidarena::report
