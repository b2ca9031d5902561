// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/mcap/mcap_records.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// Contents of an MCAP file; its topics are its channels, in the order of their ids.
struct McapInfo : RecordingInfo {
  mcap::Header header;
};

/// Reads only the summary if the file has a valid one (a few reads, for any file size), else the
/// whole file. Throws InputError when the file is missing or is not MCAP.
McapInfo read_mcap_info(const std::filesystem::path& file);

}  // namespace lidarena::dataset
