// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/read_report.hpp"

#include <fmt/format.h>

#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {

void ReadReport::count(std::string_view what, Time stamp) {
  auto found = counts_.find(what);
  if (found == counts_.end()) found = counts_.emplace(what, Count{0, stamp}).first;
  ++found->second.times;
}

std::vector<std::string> ReadReport::lines() const {
  std::vector<std::string> lines;
  for (const auto& [what, count] : counts_) {
    lines.push_back(count.times == 1 ? fmt::format("{}: at {} s", what, format_seconds(count.first))
                                     : fmt::format("{}: {} times, first at {} s", what, count.times,
                                                   format_seconds(count.first)));
  }
  return lines;
}

}  // namespace lidarena::dataset
