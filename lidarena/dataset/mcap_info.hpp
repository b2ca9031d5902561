// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/mcap_records.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena {

/// What is in a file; its topics are its channels, in the order of their ids.
struct McapInfo : RecordingInfo {
  mcap::Header header;
};

/// Takes the answer from the summary where there is a sound one (a few reads, any file size), else
/// from reading all of the file. Throws InputError when the file is missing or is not MCAP.
McapInfo read_mcap_info(const std::filesystem::path& file);

}  // namespace lidarena
