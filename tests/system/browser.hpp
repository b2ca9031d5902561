// SPDX-License-Identifier: BSD-3-Clause
// What the tests of HTML pages share: a headless browser.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <sstream>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {

inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
inline constexpr const char* kSoftwareGl = "--use-gl=angle --use-angle=swiftshader";

/// A floor of 8 x 6 m with a point every 4 cm; its distance is 0 where x < 4 m, 0.5 m elsewhere.
inline std::string floor_ply() {
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

/// A screenshot.
struct Picture {
  std::vector<std::uint8_t> rgb;
  std::array<int, 3> at(int x, int y) const {
    const auto i = 3 * static_cast<std::size_t>(y * kWidth + x);
    return {rgb.at(i), rgb.at(i + 1), rgb.at(i + 2)};
  }
};

/// Pages of the program in a headless Chromium; at first that of `view` with the floor.
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
        window_ +
        " --no-first-run --disable-background-networking --disable-component-update"
        " --disable-default-apps --disable-sync --virtual-time-budget=" +
        std::to_string(budget_ms_) + " --enable-logging=stderr " + task + " 'file://" + address +
        "' >browser_out 2>browser_err";
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
  int budget_ms_ = 20'000;  ///< virtual time that a page gets
  std::string window_ = std::to_string(kWidth) + "," + std::to_string(kHeight);
};

}  // namespace lidarena::testing
