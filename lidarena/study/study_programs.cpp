// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study_programs.hpp"

#include "lidarena/stages/ready_program.hpp"

namespace lidarena::study {
namespace {

constexpr const char* kInstalled = "installed";

/// "NAME: HOW TO INSTALL IT".
std::string remedy_of(const stages::ExternalProgram& program) {
  return program.name + ": " +
         (program.install.empty() ? "see its own documentation" : program.install);
}

void add(StudySpec& spec, stages::ExternalProgram program) {
  if (find_external(spec, program.name) != nullptr)
    throw InputError("--programs " + program.name, "is in the study already", "leave it out");
  spec.algorithms.emplace_back(program.name);
  spec.external.push_back(std::move(program));
}

void add_installed(StudySpec& spec, const stages::ConfigFolder& configs) {
  for (const std::string& name : configs.names("programs")) {
    const auto program = stages::load_program(configs.resolve("programs", name));
    if (find_external(spec, program.name) == nullptr && stages::is_installed(program))
      add(spec, program);
  }
}

}  // namespace

void add_programs(StudySpec& spec, const std::vector<std::string>& names,
                  const stages::ConfigFolder& configs) {
  std::string missing, remedies;
  for (const std::string& name : names) {
    if (name == kInstalled) {
      add_installed(spec, configs);
      continue;
    }
    const auto program = stages::load_program(configs.resolve("programs", name));
    if (!stages::is_installed(program)) {
      missing += (missing.empty() ? "" : ", ") + program.name;
      remedies += (remedies.empty() ? "" : "; ") + remedy_of(program);
    }
    add(spec, program);
  }
  if (!missing.empty())
    throw InputError("--programs", "not installed here: " + missing, "install " + remedies);
}

}  // namespace lidarena::study
