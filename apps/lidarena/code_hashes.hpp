// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lidarena {

/// {"simulator": HASH, "scorer": HASH, "methods": {FOLDER: HASH, "external": HASH}}: hashes of the
/// source files that decide the result of each part; written by cmake/HashCode.cmake.
extern const char* const kCodeHashes;

/// The commit of these files, "with changes" where they differ from it; "unknown" outside a clone.
extern const char* const kCommit;

}  // namespace lidarena
