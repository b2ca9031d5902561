// SPDX-License-Identifier: BSD-3-Clause
// A full disk, for every format: the error names the file, no output looks complete, and recordings
// can be read up to the last chunk.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The error message of `action`, run in a separate process with a file size limit of `bytes`.
template <class Action>
std::string error_with_file_size_limit(std::size_t bytes, const fs::path& report, Action&& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);  // so that write() fails, as on a full disk
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::string text = "nothing";
    try {
      action();
    } catch (const Error& error) {
      text = error.what();
    }
    std::ofstream(report) << text;
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? file_text(report) : "a crash";
}

class FullDisk : public testing::TestWithParam<DatasetFormat> {
 protected:
  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "flight";
};

TEST_P(FullDisk, LeavesNothingThatLooksWhole) {
  const bool is_recording = GetParam() == DatasetFormat::kMcap || GetParam() == DatasetFormat::kBag;
  // Room for some chunks of a bag, for two of five chunks of an MCAP file, for no complete sweep.
  const std::size_t file_size_limit = GetParam() == DatasetFormat::kBag    ? 2'500'000
                                      : GetParam() == DatasetFormat::kMcap ? 5'000'000
                                                                           : 100'000;
  const std::string error_message =
      error_with_file_size_limit(file_size_limit, folder_.path() / "report", [&] {
        DatasetWriter out(path_, sample::rig(), {.format = GetParam()});
        for (const Event& event : sample::events(24, 16'000)) out.write(event);
        out.close();
      });
  EXPECT_THAT(error_message, HasSubstr("cannot be written"));
  EXPECT_THAT(error_message, HasSubstr(path_.string()));
  EXPECT_FALSE(fs::exists(path_ / "manifest.json"));
  EXPECT_THAT(input_error([&] { open_dataset(path_); }), HasSubstr("unfinished"));
  if (!is_recording) return;
  const bool is_bag = GetParam() == DatasetFormat::kBag;
  Dataset part = open_dataset(path_ / (is_bag ? "data.bag.part" : "data.mcap.part"));
  std::vector<Event> found;
  const std::string cut = input_error([&] {
    while (auto event = part.events->next()) found.push_back(*std::move(event));
  });
  EXPECT_THAT(cut, testing::AnyOf(HasSubstr("cut off"), HasSubstr("never closed")));
  EXPECT_GT(found.size(), 50U);
  std::vector<Event> expected = sample::events(24, 16'000);
  expected.resize(found.size());
  // the last scan may come before IMU samples that were not written
  found.resize(found.size() - 30);
  expected.resize(found.size());
  expect_same(found, expected);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, FullDisk,
    testing::Values(DatasetFormat::kMcap, DatasetFormat::kBag, DatasetFormat::kPcd,
                    DatasetFormat::kPly, DatasetFormat::kKitti),
    [](const auto& param) {
      return std::string(enum_names(DatasetFormat{})[static_cast<std::size_t>(param.param)].first);
    });

}  // namespace
}  // namespace lidarena::dataset
