// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/stages/external_program.hpp"

/// Programs of others as files of `configs/programs/`.
namespace lidarena::stages {

/// Reads a program's file. {here} in its command lines becomes the file's folder. Throws
/// InputError.
ExternalProgram load_program(const std::filesystem::path& file);

/// Whether the program's `needs` succeeds in a shell; true if it needs nothing. It has 20 s.
bool is_installed(const ExternalProgram& program);

}  // namespace lidarena::stages
