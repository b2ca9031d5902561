// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace lidarena::stages {

/// Resident memory of this process, bytes; 0 if /proc does not provide it. Cheap.
std::uint64_t resident_bytes();

/// Proportional set size of this process (shared pages divided by the number of their users),
/// bytes; empty if /proc does not provide it. The kernel walks the page tables for it, which takes
/// nearly a millisecond.
std::optional<std::uint64_t> proportional_bytes();

}  // namespace lidarena::stages
