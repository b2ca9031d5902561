// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "lidarena/report/scene_blocks.hpp"

namespace lidarena {

/// Serves "/" (the page) and "/block/N" (block N of the scene's data) on 127.0.0.1 until the
/// process is stopped. Nothing else is served; no file is opened. Requests with another host in
/// their Host header are rejected, so that a foreign web page cannot read the data through a host
/// name that resolves to 127.0.0.1 (DNS rebinding). `port` 0 = any free port; `listening` is called
/// with the address. Throws InputError if the port is in use, Error if this build has no server.
void serve_view(const std::string& page, const report::PackedScene& scene, int port,
                const std::function<void(const std::string& address)>& listening);

}  // namespace lidarena
