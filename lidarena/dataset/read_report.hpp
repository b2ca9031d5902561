// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena::dataset {

/// What was left out of a recording while its events were read, and where it ended too early.
class ReadReport {
 public:
  /// One measurement at `stamp` is concerned by `what`: "TOPIC: what was done, why".
  void count(std::string_view what, Time stamp);
  /// The recording is damaged there, or cut off; what was read is intact.
  void end(std::string_view why) { ended_ = why; }

  const std::string& ended() const { return ended_; }
  /// One line for each kind: "TOPIC: what was done, why: 5 times, first at 3.2 s".
  std::vector<std::string> lines() const;

 private:
  struct Count {
    std::size_t times = 0;
    Time first{0};
  };
  std::map<std::string, Count, std::less<>> counts_;
  std::string ended_;
};

}  // namespace lidarena::dataset
