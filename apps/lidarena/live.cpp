// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/live.hpp"

#include <csignal>

namespace lidarena {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

}  // namespace

void add_live_options(CLI::App& verb, dds::LiveOptions& options) {
  verb.add_option("--domain", options.domain, "DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  verb.add_flag(
      "--network", options.network,
      "Reach other machines, too; default: this one alone. CYCLONEDDS_URI decides where set");
}

CLI::Option* add_topic_option(CLI::App& verb, const std::string& name, std::string& topic,
                              const std::string& what) {
  return verb.add_option_function<std::string>(
      name,
      [&topic](const std::string& given) { topic = (given.starts_with('/') ? "" : "/") + given; },
      what);
}

bool (*end_on_interrupt())() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { was_interrupted = 1; });
  return [] { return was_interrupted != 0; };
}

}  // namespace lidarena
