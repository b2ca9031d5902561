// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/svg_figures.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <string>

#include "lidarena/dataset/part_file.hpp"
#include "lidarena/report/web_bundle.hpp"

namespace lidarena::report {
namespace {

/// Calls `node SCRIPT PAGE FOLDER` and discards its output; true if its exit code is 0.
bool call_node(std::string script, std::string page, std::string folder) {
  std::string node = "node";
  std::array<char*, 5> arguments{node.data(), script.data(), page.data(), folder.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  }
  pid_t child = 0;
  const int refused =
      posix_spawnp(&child, node.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  return refused == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

}  // namespace

bool draw_svg_figures(const std::filesystem::path& page, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path script = folder / "figures.cjs";
  dataset::write_text_file(script, web_bundle("figures.cjs"));
  const bool drawn = call_node(script.string(), page.string(), folder.string());
  std::filesystem::remove(script);
  return drawn;
}

}  // namespace lidarena::report
