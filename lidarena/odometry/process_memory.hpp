// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace lidarena {

/// Resident memory of this process, bytes; 0 where /proc does not tell. Cheap.
std::uint64_t resident_bytes();

/// The process's share of resident memory (shared pages divided by their users), bytes; empty where
/// /proc does not tell. Walks the page tables, so it takes a good part of a millisecond.
std::optional<std::uint64_t> proportional_bytes();

}  // namespace lidarena
