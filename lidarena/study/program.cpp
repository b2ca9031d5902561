// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/program.hpp"

#include <cstdlib>
#include <sstream>

#include "lidarena/base/error.hpp"
#include "lidarena/stages/process.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "lidarena";

}  // namespace

fs::path find_program(const fs::path& given) {
  if (!given.empty()) {
    if (!fs::exists(given)) throw InputError(given.string(), "does not exist", "check the program");
    return fs::absolute(given);
  }
  std::error_code ignored;
  std::string folders = fs::read_symlink("/proc/self/exe", ignored).parent_path().string();
  if (const char* path = std::getenv("PATH")) folders += std::string(":") + path;
  std::istringstream all(folders);
  for (std::string folder; std::getline(all, folder, ':');) {
    const fs::path program = fs::absolute(fs::path(folder) / kName);
    if (fs::is_regular_file(program, ignored)) return program;
  }
  throw InputError("study", "does not find the program lidarena, beside this one or in PATH",
                   "give its path: StudyOptions::program");
}

ProgramCode ProgramCode::ask(const fs::path& program) {
  stages::Command ask;
  ask.arguments = {program.string(), "--version", "--json"};
  const stages::Answer answer = stages::answer_of(ask);
  if (answer.end.exit_code < 0) {
    throw Error(program.string() + " --version --json: " + answer.end.reason);
  }
  Json code = answer.end.exit_code == 0 ? Json::parse(answer.text, nullptr, false) : Json();
  if (!code.is_object() || !code.contains("code")) {
    throw InputError(program.string(), "does not answer to --version --json",
                     "give the program lidarena of this version");
  }
  return ProgramCode(std::move(code));
}

Json ProgramCode::of(const std::string& part) const {
  return {{"version", code_.at("version")}, {part, code_.at("code").at(part)}};
}

Json ProgramCode::of_method(const std::string& algorithm) const {
  const Json& methods = code_.at("code").at("methods");
  Json found = methods.at("external");
  for (const auto& [name, hash] : methods.items()) {
    // Variants of a method are in its folder: lio_sam_lc, kiss_icp+loop.
    const std::string rest = algorithm.starts_with(name) ? algorithm.substr(name.size()) : "other";
    if (rest.empty() || rest[0] == '_' || rest[0] == '+') found = hash;
  }
  return {{"version", code_.at("version")}, {"method", found}};
}

}  // namespace lidarena::study
