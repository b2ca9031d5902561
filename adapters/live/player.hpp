// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "adapters/live/paced_writer.hpp"
#include "lidarena/base/log.hpp"

namespace lidarena::live {

/// The recording in a dataset folder, or the file itself. Throws InputError.
std::filesystem::path recording_in(const std::filesystem::path& dataset);

/// The topic with a recording's scans: `asked`, or else the only one. Throws InputError if there is
/// none, or several.
std::string scan_topic_of(const std::filesystem::path& recording, const std::string& asked);

/// Publishes the messages of a recording on topics of the same names, until `stopped` is true.
/// Throws InputError if they are not ROS 2's.
void play_recording(const std::filesystem::path& recording, PacedWriter& out,
                    const std::function<bool()>& stopped, LogSink& log);

}  // namespace lidarena::live
