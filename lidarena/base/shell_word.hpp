// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena {

/// `word` as one word of a POSIX shell's command line: in single quotes unless all of its
/// characters are letters, digits or others without a meaning there.
std::string shell_word(const std::string& word);

}  // namespace lidarena
