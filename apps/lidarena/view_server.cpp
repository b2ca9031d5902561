// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/view_server.hpp"

#include <fmt/format.h>
#ifdef LIDARENA_HAVE_HTTPLIB
#include <httplib.h>
#endif

#include "lidarena/base/error.hpp"

namespace lidarena {

#ifdef LIDARENA_HAVE_HTTPLIB
namespace {

constexpr const char* kHost = "127.0.0.1";

void reject_foreign_hosts(httplib::Server& server, int port) {
  server.set_pre_routing_handler([port](const httplib::Request& request,
                                        httplib::Response& response) {
    const std::string host = request.get_header_value("Host");
    if (host == fmt::format("{}:{}", kHost, port) || host == fmt::format("localhost:{}", port)) {
      return httplib::Server::HandlerResponse::Unhandled;
    }
    response.status = 403;
    response.set_content("this server answers only requests to 127.0.0.1\n", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
}

void serve_block(const report::PackedScene& scene, const httplib::Request& request,
                 httplib::Response& response) {
  const std::string number = request.matches[1];
  const std::size_t index = number.size() > 9 ? scene.blocks.size() : std::stoul(number);
  if (index >= scene.blocks.size()) {
    response.status = 404;
    return;
  }
  const std::string& block = scene.blocks[index];
  response.set_content_provider(
      block.size(), "application/octet-stream",
      [&block](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        return sink.write(block.data() + offset, length);
      });
}

}  // namespace

void serve_view(const std::string& page, const report::PackedScene& scene, int port,
                const std::function<void(const std::string& address)>& listening) {
  httplib::Server server;
  server.Get("/", [&](const httplib::Request&, httplib::Response& response) {
    response.set_content(page, "text/html; charset=utf-8");
  });
  server.Get(R"(/block/(\d+))", [&](const httplib::Request& request, httplib::Response& response) {
    serve_block(scene, request, response);
  });
  if (port == 0) {
    port = server.bind_to_any_port(kHost);
  } else if (!server.bind_to_port(kHost, port)) {
    port = -1;
  }
  if (port < 0) {
    throw InputError("--port", "this port is in use or not allowed",
                     "leave --port out for any free port");
  }
  reject_foreign_hosts(server, port);
  listening(fmt::format("http://{}:{}/", kHost, port));
  server.listen_after_bind();
}
#else
void serve_view(const std::string&, const PackedScene&, int,
                const std::function<void(const std::string& address)>&) {
  throw Error("this build has no server: give --out page.html, or build with cpp-httplib");
}
#endif

}  // namespace lidarena
