// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace lidarena {

/// How a piece of work ended that was done in a process of its own.
struct IsolatedOutcome {
  bool ok = false;
  std::string reason;  ///< of the failure: the exception's text, or the signal's name
};

/// Does `work` in a forked child, so that a crash, or memory that it leaves behind, is that run's
/// alone. The caller must not have started threads before. Standard output is shared.
IsolatedOutcome run_isolated(const std::function<void()>& work);

}  // namespace lidarena
