// SPDX-License-Identifier: BSD-3-Clause
#include "tests/odometry/measured_errors.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace lidarena::odometry {
namespace {

constexpr std::array<std::string_view, 9> kSituations = {
    "flight", "faulty_scans", "empty_first_scan", "elsewhere", "mounted",
    "moving", "vibrating",    "standing",         "map"};

struct Row {
  std::string_view method;
  std::array<double, kSituations.size()> error_m;  ///< 0: not entered
};

// A test without an entry fails and prints the value to enter here. Values are rounded up to two
// digits. Whoever improves a method enters its smaller errors; whoever enters larger ones says why.
// The room's pattern does not repeat, but for "standing": one that repeats held methods at the
// start (fast_lio2:indoor erred by 0.25 m) and steadied kiss_icp:indoor (0.095 m instead of 0.2 m).
// clang-format off
constexpr Row kRows[] = {
    //                           flight   faulty   empty    else-    mounted  moving   vibrat-  standing map
    //                                    scans    first    where                      ing
    {"kiss_icp:indoor",          {0.2,     0.24,    0.19,    0.23,    0.069,   0.092,   0.2,     0.0057,  0.02}},
    {"kiss_icp:published",       {0.099,   0.083,   0.12,    0.12,    0.13,    0.1,     0.099,   0.016,   0.048}},
    {"kiss_icp_head",            {0.15,    0.18,    0.08,    0.11,    0.22,    0.14,    0.15,    0.023,   0.057}},
    {"ct_icp:indoor",            {0.014,   0.084,   0.015,   0.0086,  0.012,   0.044,   0.014,   0.047,   0.023}},
    {"ct_icp:published",         {0.027,   0.026,   0.042,   0.032,   0.017,   0.063,   0.027,   0.086,   0.04}},
    {"fast_lio2:indoor",         {0.0063,  0.0075,  0.0063,  0.0073,  0.074,   0.062,   0.007,   0.012,   0.018}},
    {"fast_lio2:published",      {0.014,   0.014,   0.014,   0.0053,  0.013,   0.05,    0.013,   0.015,   0.017}},
    {"lio_sam:indoor",           {0.051,   0.05,    0.043,   0.047,   0.047,   0.045,   0.05,    0.006,   0.056}},
    {"lio_sam:published",        {0.041,   0.04,    0.039,   0.048,   0.047,   0.029,   0.041,   0.012,   0.055}},
    {"lio_sam_lc:indoor",        {0.051,   0.05,    0.043,   0.047,   0.047,   0.045,   0.05,    0.006,   0.056}},
    {"lio_sam_lc:published",     {0.041,   0.04,    0.039,   0.048,   0.047,   0.029,   0.041,   0.012,   0.055}},
    {"arena_lo",                 {0.0015,  0.012,   0.0013,  0.00098, 0.0013,  0.0015,  0.0015,  0.0061,  0.018}},
    {"arena_lio",                {0.00089, 0.0007,  0.00076, 0.0007,  0.00064, 0.00077, 0.0026,  1.5e-05, 0.017}},
    {"kiss_icp+loop:indoor",     {0.2,     0.24,    0.19,    0.23,    0.069,   0.092,   0.2,     0.0057,  0.025}},
    {"kiss_icp+loop:published",  {0.099,   0.083,   0.12,    0.12,    0.13,    0.1,     0.099,   0.016,   0.084}},
    {"kiss_icp_head+loop",       {0.15,    0.18,    0.08,    0.11,    0.22,    0.14,    0.15,    0.023,   0.073}},
    {"fast_lio2+loop:indoor",    {0.0063,  0.0075,  0.0063,  0.0073,  0.074,   0.062,   0.007,   0.012,   0.081}},
    {"fast_lio2+loop:published", {0.014,   0.014,   0.014,   0.0053,  0.013,   0.05,    0.013,   0.015,   0.043}},
    {"arena_lo+loop",            {0.0015,  0.012,   0.0013,  0.00098, 0.0013,  0.0015,  0.0015,  0.0061,  0.019}},
    {"arena_lio+loop",           {0.00089, 0.0007,  0.00076, 0.0007,  0.00064, 0.00077, 0.0026,  1.5e-05, 0.017}},
};
// clang-format on

}  // namespace

std::string_view name_of(Situation situation) {
  return kSituations.at(static_cast<std::size_t>(situation));
}

std::optional<double> measured_error(std::string_view method, Situation situation) {
  const auto row = std::ranges::find(kRows, method, &Row::method);
  if (row == std::ranges::end(kRows)) return std::nullopt;
  const double error = row->error_m.at(static_cast<std::size_t>(situation));
  return error > 0.0 ? std::optional(error) : std::nullopt;
}

}  // namespace lidarena::odometry
