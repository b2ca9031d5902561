// SPDX-License-Identifier: BSD-3-Clause
// The interactive view: the page in a browser, and the server of `lidarena view`.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/system/browser.hpp"

namespace lidarena::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(ViewInBrowser, PixelsHaveTheColorsOfTheirDistancesAndTheConsoleStaysSilent) {
  const Picture picture = screenshot("#view=top&size=6");
  EXPECT_THAT(page_errors(), ElementsAre());
  // Seen from above, the floor is centered, with x < 4 m on the left. Expected are the colors of
  // the color ramp for 0 and for more than 20 cm.
  EXPECT_THAT(picture.at(kWidth / 2 - 60, kHeight / 2), ElementsAre(0, 34, 78));
  EXPECT_THAT(picture.at(kWidth / 2 + 20, kHeight / 2), ElementsAre(214, 32, 39));
  EXPECT_THAT(picture.at(kWidth / 2, 3), ElementsAre(246, 247, 249)) << "background";
}

TEST_F(ViewInBrowser, OutliersOnlyHidesTheRestAndALinkKeepsTheChoice) {
  const Picture picture = screenshot("#view=top&size=6&outliers=1");
  EXPECT_THAT(page_errors(), ElementsAre());
  EXPECT_THAT(picture.at(kWidth / 2 - 60, kHeight / 2), ElementsAre(246, 247, 249));
  EXPECT_THAT(picture.at(kWidth / 2 + 20, kHeight / 2), ElementsAre(214, 32, 39));
}

TEST_F(ViewInBrowser, AllPointsAreDrawnOnceTheyAreLoaded) {
  const std::string dom = browse("--dump-dom", "");
  EXPECT_THAT(page_errors(), ElementsAre());
  EXPECT_THAT(dom, AllOf(HasSubstr("data-ready=\"1\""), HasSubstr("data-drawn=\"30351\"")));
}

TEST_F(ViewInBrowser, WithoutWebGlThePictureInThePageStays) {
  const std::string dom = browse("--dump-dom", "", "--disable-gpu --disable-3d-apis");
  EXPECT_THAT(dom, AllOf(HasSubstr("data-failed=\"1\""), HasSubstr("could not start"),
                         HasSubstr("data:image/png;base64,")));
  EXPECT_THAT(dom, Not(HasSubstr("lidarena-view page live")));
}
/// Runs the program as a server in the background until the object is destroyed.
class Server {
 public:
  Server(const fs::path& folder, const std::string& arguments) {
    const std::string command = "cd " + folder.string() + " && { " + LIDARENA_BINARY + " " +
                                arguments + " >served 2>served_err </dev/null & echo $! >pid; }";
    started_ = std::system(command.c_str()) == 0;
    pid_ = std::stoi(content(folder / "pid"));
    for (int i = 0; i < 300 && port_ == 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      const auto json = nlohmann::json::parse(content(folder / "served"), nullptr, false);
      if (json.is_discarded()) {
        if (::kill(pid_, 0) != 0) break;
        continue;
      }
      const std::string address = json.at("address");
      port_ = std::stoi(address.substr(address.rfind(':') + 1));
    }
  }
  ~Server() { ::kill(pid_, SIGTERM); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  int port() const { return port_; }

  /// The answer to GET `target`, including its headers.
  std::string get(const std::string& target, const std::string& host) const {
    const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
              0);
    const std::string request =
        "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n";
    EXPECT_EQ(::send(connection, request.data(), request.size(), 0),
              static_cast<ssize_t>(request.size()));
    std::string answer;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::recv(connection, buffer.data(), buffer.size(), 0)) > 0;) {
      answer.append(buffer.data(), static_cast<std::size_t>(n));
    }
    ::close(connection);
    return answer;
  }

 private:
  bool started_ = false;
  int pid_ = 0;
  int port_ = 0;
};

TEST_F(Cli, TheServerOfTheViewGivesThePageAndItsBlocksAndNothingElse) {
  const std::string floor = write("floor.ply", floor_ply());
  write("secret.txt", "not to be seen");
  const Server server(folder_.path(), "view --json " + floor);
  const std::string refused = content(path("served_err"));
  if (refused.find("has no") != std::string::npos) GTEST_SKIP() << "skipped: " << refused;
  ASSERT_GT(server.port(), 0) << refused;
  const std::string host = "127.0.0.1:" + std::to_string(server.port());
  EXPECT_THAT(server.get("/", host), AllOf(HasSubstr("200 OK"), HasSubstr("data-blocks='server'")));
  // 30,351 points of 8 bytes
  EXPECT_THAT(server.get("/block/0", host), HasSubstr("Content-Length: 242808"));
  EXPECT_THAT(server.get("/block/1", host), HasSubstr("404"));
  for (const char* target : {"/secret.txt", "/floor.ply", "/../secret.txt", "/block/../secret.txt",
                             "/block/99999999999999999999", "/etc/passwd", "//etc/passwd"}) {
    const std::string answer = server.get(target, host);
    EXPECT_THAT(answer, HasSubstr(" 404 ")) << target;
    EXPECT_THAT(answer, Not(HasSubstr("not to be seen"))) << target;
  }
  EXPECT_THAT(server.get("/", "evil.example"), AllOf(HasSubstr(" 403 "), Not(HasSubstr("scene"))));
}

TEST_F(Cli, WhatCannotBeViewedIsRefusedAndLeavesNoPage) {
  const std::string broken = write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 9\n");
  EXPECT_THAT(refusal("view " + broken + " --out page.html"), HasSubstr("broken.ply"));
  EXPECT_THAT(refusal("view nowhere.pcd --out page.html"), HasSubstr("nowhere.pcd"));
  EXPECT_FALSE(fs::exists(path("page.html")));
}

}  // namespace
}  // namespace lidarena::testing
