// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/results/figures.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::results {
namespace {

using ::testing::HasSubstr;

/// Sets every number that a struct lists to a value of its own, and makes every optional part
/// exist.
class Fill {
 public:
  template <class T>
  void operator()(T& value) {
    if constexpr (ConfigStruct<T>) {
      T::visit(value, [&](std::string_view, auto& member, auto&&...) { (*this)(member); });
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = static_cast<T>(++next_);
    }
  }
  void operator()(std::string& text) { text = "text " + std::to_string(++next_); }
  void operator()(Pose& pose) {
    pose = Pose::Identity();
    pose.translation().x() = ++next_;
  }
  template <class T>
  void operator()(std::optional<T>& value) {
    (*this)(value.emplace());
  }
  template <class T>
  void operator()(std::vector<T>& values) {
    values.assign(3, T{});
    for (T& value : values) (*this)(value);
  }
  template <class T, std::size_t size>
  void operator()(std::array<T, size>& values) {
    for (T& value : values) (*this)(value);
  }

 private:
  int next_ = 0;
};

/// Metrics in which every number is another one.
RunMetrics full_metrics() {
  RunMetrics metrics;
  Fill fill;
  fill(metrics);
  metrics.schema_version = kMetricsSchemaVersion;
  return metrics;
}

TEST(RunMetrics, AreReadBackAsTheyWereWritten) {
  const TemporaryFolder folder;
  const RunMetrics metrics = full_metrics();
  write_metrics(folder.path(), metrics);
  const RunMetrics again = read_metrics(folder.path());
  EXPECT_EQ(lidarena::to_json(again), lidarena::to_json(metrics));
  EXPECT_EQ(again.maps.reprojected->robust.alignment->eigenvalues[5],
            metrics.maps.reprojected->robust.alignment->eigenvalues[5]);
  EXPECT_FALSE(dataset::read_json(folder.path() / "metrics.json").contains("resources"))
      << "they differ between repeated runs";
}

TEST(RunMetrics, WhatDoesNotExistIsNullAndStaysEmpty) {
  const TemporaryFolder folder;
  RunMetrics metrics;
  metrics.final.emplace().status = "no_overlap";
  metrics.maps.own.emplace().se3.refused = "the flight is a line";
  write_metrics(folder.path(), metrics);
  const Json json = dataset::read_json(folder.path() / "metrics.json");
  EXPECT_TRUE(json["live"].is_null());
  EXPECT_TRUE(json["truth"].is_null());
  EXPECT_TRUE(json["final"]["rpe"].is_null());
  EXPECT_TRUE(json["maps"]["own"]["se3"]["outliers_percent"].is_null());
  EXPECT_TRUE(json["maps"]["own"]["se3"]["distance"].is_null());
  const RunMetrics again = read_metrics(folder.path());
  EXPECT_FALSE(again.live);
  EXPECT_FALSE(again.final->rpe);
  EXPECT_TRUE(again.maps.own->se3.distance_m.empty());
  for (const Figure& figure : figures()) EXPECT_FALSE(value_of(again, figure)) << figure.key;
}

TEST(RunMetrics, OfAnotherVersionOrDamagedAreRefusedWithARemedy) {
  const TemporaryFolder folder;
  const auto refusal_of = [&](const std::string& text) {
    std::ofstream(folder.path() / "metrics.json") << text;
    try {
      read_metrics(folder.path());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal_of(R"({"schema_version": 1})"), HasSubstr("lidarena evaluate"));
  EXPECT_THAT(refusal_of("[]"), HasSubstr("schema version 0"));
  EXPECT_THAT(refusal_of(R"({"schema_version": 3, "final": {"status": 7}})"),
              HasSubstr("final: status: has a value of another type: 7"));
  EXPECT_THAT(refusal_of(R"({"schema_version": 3, "warnings": {}})"), HasSubstr("is not a list"));
  EXPECT_EQ(refusal_of(R"({"schema_version": 2, "final": {"rpe": {"1m": null}}})"), "accepted");
}

TEST(Figures, EachReadsANumberOfItsOwn) {
  const RunMetrics metrics = full_metrics();
  std::set<double> values;
  std::set<std::string> keys;
  for (const Figure& figure : figures()) {
    EXPECT_TRUE(keys.insert(figure.key).second) << figure.key;
    if (std::string(figure.key).find("completeness") != std::string::npos ||
        std::string(figure.key).find("f_score") != std::string::npos) {
      continue;  // of the row within 5 cm, which filled metrics do not have
    }
    const Reading reading = figure.read(metrics);
    ASSERT_TRUE(reading.value) << figure.key;
    EXPECT_TRUE(values.insert(*reading.value).second) << figure.key << " repeats a number";
  }
}

TEST(Figures, AKeyThatDoesNotExistHasTheNearest) {
  EXPECT_STREQ(figure_of("latency_p95", "here").label, "latency, P95");
  try {
    figure_of("latency_p96", "my.yaml:3");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("my.yaml:3"));
    EXPECT_THAT(error.what(), HasSubstr("latency_p9"));
  }
}

}  // namespace
}  // namespace lidarena::results
