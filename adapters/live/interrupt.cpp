// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/interrupt.hpp"

#include <csignal>
#include <initializer_list>

namespace lidarena::live {
namespace {

volatile std::sig_atomic_t was_interrupted = 0;

}  // namespace

bool (*end_on_interrupt())() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { was_interrupted = 1; });
  return [] { return was_interrupted != 0; };
}

}  // namespace lidarena::live
