// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/ready_program.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/base/shell_word.hpp"
#include "lidarena/stages/foreign_program.hpp"
#include "lidarena/stages/process.hpp"

namespace lidarena::stages {

namespace fs = std::filesystem;

ExternalProgram load_program(const fs::path& file) {
  auto program = load_config<ExternalProgram>(file);
  const std::string here = shell_word(fs::absolute(file).parent_path().string());
  program.command = substitute(program.command, "{here}", here);
  program.needs = substitute(program.needs, "{here}", here);
  return program;
}

bool is_installed(const ExternalProgram& program) {
  if (program.needs.empty()) return true;
  Command ask;
  ask.arguments = {"/bin/sh", "-c", "(" + program.needs + ") >/dev/null 2>&1"};
  return Process(ask, {.seconds = 20.0}).wait().exit_code == 0;
}

}  // namespace lidarena::stages
