// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena {

/// `--compat evo` and its options as typed.
struct EvoArguments {
  std::string tool;  ///< "evo", or empty
  std::string metric = "ape", relation = "trans_part", unit = "f";
  double delta = 1.0;
  double delta_tolerance = 0.1;
  bool all_pairs = false, pairs_from_reference = false;
  bool align = false, scale = false, origin = false;
  std::size_t n_to_align = 0;
  double t_max_diff = 0.01;
  double t_offset = 0.0;
};

void add_evo_options(CLI::App& verb, EvoArguments& arguments);

/// Metrics of one pair of trajectories as evo computes them: options, pairs, statistics, alignment.
Json evo_json(std::span<const StampedPose> truth, std::span<const StampedPose> estimate,
              const EvoArguments& arguments);
std::string evo_text(const Json& result);

}  // namespace lidarena
