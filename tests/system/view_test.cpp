// SPDX-License-Identifier: BSD-3-Clause
// The interactive view: the page in a browser, and the server of `lidarena view`.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr const char* kSoftwareGl = "--use-gl=angle --use-angle=swiftshader";

/// A floor of 8 x 6 m with a point every 4 cm; its distance is 0 where x < 4 m, 0.5 m elsewhere.
std::string floor_ply() {
  std::ostringstream rows;
  int points = 0;
  for (int i = 0; i <= 200; ++i) {
    for (int j = 0; j <= 150; ++j, ++points) {
      rows << 0.04 * i << " " << 0.04 * j << " 0 " << (i < 100 ? 0.0 : 0.5) << "\n";
    }
  }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float distance\n"
         "end_header\n" +
         rows.str();
}

struct Picture {
  std::vector<std::uint8_t> rgb;
  std::array<int, 3> at(int x, int y) const {
    const auto i = 3 * static_cast<std::size_t>(y * kWidth + x);
    return {rgb.at(i), rgb.at(i + 1), rgb.at(i + 2)};
  }
};

class ViewInBrowser : public Cli {
 protected:
  void SetUp() override {
    const std::string missing = missing_for_browser();
    if (!missing.empty()) GTEST_SKIP() << "skipped: " << missing;
    floor_ = write("floor.ply", floor_ply());
    const Outcome made = call("view " + floor_ + " --out page.html");
    if (made.err.find("has no interactive view") != std::string::npos) {
      GTEST_SKIP() << "skipped: built without the viewer (LIDARENA_WITH_VIEWER)";
    }
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  /// What this machine lacks to show a page with WebGL (tried with a small page); empty if nothing.
  std::string missing_for_browser() {
    if (std::system("command -v chromium >/dev/null") != 0) {
      return "chromium is not installed";
    }
    const std::string probe =
        write("probe.html",
              "<canvas></canvas><script>document.documentElement.dataset.webgl ="
              " document.querySelector('canvas').getContext('webgl2') ? 'works' : 'none'</script>");
    if (run_chromium("--dump-dom", probe, kSoftwareGl) != 0)
      return "chromium does not run on this machine";
    const bool works =
        content(path("browser_out")).find("data-webgl=\"works\"") != std::string::npos;
    return works ? "" : "chromium has no WebGL on this machine";
  }
  /// Returns chromium's exit status; its output is in browser_out, console messages in browser_err.
  int run_chromium(const std::string& task, const std::string& address, const std::string& gl) {
    const std::string command =
        "cd " + folder_.path().string() + " && timeout 120 chromium --headless --no-sandbox " + gl +
        " --enable-unsafe-swiftshader --ignore-gpu-blocklist --hide-scrollbars --window-size=" +
        std::to_string(kWidth) + "," + std::to_string(kHeight) +
        " --no-first-run --disable-background-networking --disable-component-update"
        " --disable-default-apps --disable-sync --virtual-time-budget=20000"
        " --enable-logging=stderr " +
        task + " 'file://" + address + "' >browser_out 2>browser_err";
    return std::system(command.c_str());
  }
  /// Opens the page with the URL fragment `state` ("#..."); returns chromium's output.
  std::string browse(const std::string& task, const std::string& state,
                     const std::string& gl = kSoftwareGl) {
    EXPECT_EQ(run_chromium(task, path("page.html") + state, gl), 0) << content(path("browser_err"));
    return content(path("browser_out"));
  }
  Picture screenshot(const std::string& state) {
    browse("--screenshot=" + path("picture.png"), state);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&png, path("picture.png").c_str()), 0);
    EXPECT_EQ(png.width, static_cast<unsigned>(kWidth));
    png.format = PNG_FORMAT_RGB;
    Picture picture;
    picture.rgb.resize(PNG_IMAGE_SIZE(png));
    EXPECT_NE(png_image_finish_read(&png, nullptr, picture.rgb.data(), 0, nullptr), 0);
    return picture;
  }
  /// Console messages of the page, except performance messages of the OpenGL driver.
  std::vector<std::string> page_errors() const {
    std::istringstream lines(content(path("browser_err")));
    std::vector<std::string> errors;
    for (std::string line; std::getline(lines, line);) {
      const bool of_page = line.find("CONSOLE") != std::string::npos;
      const bool performance =
          line.find("GL Driver Message (OpenGL, Performance") != std::string::npos;
      if (of_page && !performance) errors.push_back(line);
    }
    return errors;
  }

  std::string floor_;
};

TEST_F(ViewInBrowser, PixelsHaveTheColorsOfTheirDistancesAndTheConsoleStaysSilent) {
  const Picture picture = screenshot("#view=top&size=6");
  EXPECT_THAT(page_errors(), ElementsAre());
  // Seen from above, the floor is centered, with x < 4 m on the left. Expected are the colors of
  // distance_color() for 0 and for more than 20 cm.
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

/// Writes the result files of a study with two runs in one world, without maps and datasets.
void write_study(const fs::path& folder) {
  nlohmann::json study{{"kind", "study"}, {"spec", {{"title", "Two runs"}}}, {"runs", {}}};
  for (const std::string algorithm : {"kiss_icp", "fast_lio2"}) {
    study["runs"].push_back({{"name", algorithm},
                             {"world", "cave"},
                             {"flight", "cave"},
                             {"sensor", "livox_mid360"},
                             {"algorithm", algorithm},
                             {"preset", "indoor"},
                             {"seed", 1}});
    const fs::path run = folder / "runs" / algorithm;
    fs::create_directories(run);
    std::ofstream(run / "manifest.json") << nlohmann::json{{"kind", "run"}};
    const nlohmann::json curve{{"t_s", {0.0, 1.0, 2.0}}, {"translation_m", {0.0, 0.01, 0.02}}};
    const nlohmann::json final{
        {"rpe", {{"1m_at_poses", {{"translation", {{"count", 9}, {"rmse_m", 0.012}}}}}}},
        {"errors_over_time", {{"ate_se3", curve}}}};
    std::ofstream(run / "metrics.json")
        << nlohmann::json{{"schema_version", 3}, {"status", "ok"}, {"final", final}};
    std::ofstream(run / "resources.json") << nlohmann::json{{"scans", 3},
                                                            {"real_time_factor", 2.0},
                                                            {"latency", {{"count", 3}}},
                                                            {"own", {{"peak_bytes", 3000110}}}};
    std::ofstream(run / "resources.csv")
        << "t_sensor_s,latency_s,rss_bytes,pss_bytes,map_bytes,scan_buffer_bytes,backlog_bytes\n"
           "0.1,0.01,1,1,1000000,100,10\n1,0.01,1,1,2000000,100,10\n2,0.01,1,1,3000000,100,10\n";
  }
  std::ofstream(folder / "plan.json") << study;
}

TEST_F(ViewInBrowser, TheReportDrawsItsChartsAndItsFiles) {
  write_study(path("study"));
  const Outcome made = call("report study");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  fs::rename(path("study") + "/report.html", path("page.html"));
  const std::string dom = browse("--dump-dom", "");
  EXPECT_THAT(page_errors(), ElementsAre());
  // four figures: error over time, memory over time, error against computing time and memory
  EXPECT_THAT(dom, AllOf(HasSubstr("data-ready=\"1\""), HasSubstr("data-figures=\"4\"")));
  for (const char* file :
       {"results.csv", "report.json", "tables/runs-cave.csv", "tables/runs-cave.md",
        "tables/runs-cave.tex", "tables/runs-cave.json"}) {
    EXPECT_TRUE(fs::exists(path("study") + "/" + file)) << file;
  }
  if (std::system("command -v node >/dev/null") != 0) return;
  for (const char* id : {"drift-cave", "memory-cave", "pareto-cpu", "pareto-memory"}) {
    EXPECT_THAT(content(path("study") + "/figures/" + id + ".svg"), HasSubstr("<svg")) << id;
  }
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
