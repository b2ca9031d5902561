// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "lidarena/report/scene_blocks.hpp"

namespace lidarena {

/// Serves "/" (the page) and "/block/N" (the scene's bytes) on 127.0.0.1 until the process is told
/// to stop, and nothing else: no file is ever opened. Requests that name another host in their Host
/// header are refused, so that a foreign page cannot reach in through a name that points here.
/// `port` 0 = any free one; `listening` is told the address. Throws InputError when the port is
/// taken, Error when this build has no server.
void serve_view(const std::string& page, const PackedScene& scene, int port,
                const std::function<void(const std::string& address)>& listening);

}  // namespace lidarena
