// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "lidarena/base/error.hpp"
#include "tests/dataset/packed.hpp"

namespace lidarena::dataset {

/// Writes `bytes` to `file` and returns `file`.
inline std::filesystem::path write_file(const std::filesystem::path& file, std::string_view bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

inline std::string file_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// The message of the InputError that `action` throws; the test fails if it throws none.
template <class Action>
std::string input_error(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return {};
}

inline std::filesystem::path shared_data(const std::string& name) {
  return std::filesystem::path(LIDARENA_SHARED_DATA) / name;
}

}  // namespace lidarena::dataset

/// Skips the test when the real data file or folder `path` is not there.
#define LIDARENA_NEEDS(path)                                      \
  if (!std::filesystem::exists(path)) {                           \
    GTEST_SKIP() << "real data not found: " << (path).filename(); \
  }                                                               \
  static_assert(true)
