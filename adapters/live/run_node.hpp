// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/stages/external_program.hpp"
#include "lidarena/stages/run_algorithm.hpp"

namespace lidarena::live {

/// Runs an external program that is a ROS 2 node (its `node` names topics) over the dataset that
/// `request` names, and writes the RUN folder `out`. The node is started by its command, in a DDS
/// domain of its own (ROS_DOMAIN_ID) that no other run has at the same time. It gets the
/// measurements of the chosen LiDAR and the IMU beside it on live topics, in lock-step or at a
/// rate; its poses and clouds are collected; then it is stopped as by Ctrl-C. What it prints goes
/// to program.log. Throws Error when it ends early, does not appear, or does not answer.
odometry::RunSummary run_node(const stages::ExternalProgram& program,
                              const stages::RunRequest& request, const std::filesystem::path& out,
                              const Parallel& parallel, LogSink& log);

}  // namespace lidarena::live
