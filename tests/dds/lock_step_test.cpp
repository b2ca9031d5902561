// SPDX-License-Identifier: BSD-3-Clause
// A node is fed scan by scan, by `play --lock-step` and in a study.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "tests/dds/live_helpers.hpp"
#include "tests/dds/same_poses.hpp"

namespace lidarena::dds {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kScans = "/livox_mid360/points";
constexpr auto kThought = milliseconds(80);  // of the node over a scan

/// A node that thinks over each scan and then answers, but for some scans.
class SlowNode {
 public:
  explicit SlowNode(const LiveOptions& options)
      : out_(options),
        odometry_(out_.add_topic("/odom", dataset::ros::kOdometry, false)),
        in_(options, {.topics = {kScans}, .idle = milliseconds(0), .stopped = [this] {
                        return std::chrono::steady_clock::now() > deadline_;
                      }}) {}

  /// Until no scan comes for 15 s, at the begin, or 3 s. Returns how many came.
  int run(const std::set<int>& without_answer) {
    int scans = 0;
    for (auto wait = milliseconds(15'000);; wait = milliseconds(3000)) {
      const auto stamp = next(wait);
      if (!stamp) return scans;
      const bool is_left_out = without_answer.contains(scans++);
      if (is_left_out) continue;
      if (next(kThought)) {
        ADD_FAILURE() << "a scan came before the answer to number " << scans - 1;
        ++scans;
      }
      dataset::ros::encode_odometry({*stamp, Pose::Identity()}, {"odom", "body"}, message_);
      out_.write(odometry_, Time{1}, Time{1}, message_.bytes());
    }
  }

 private:
  std::optional<Time> next(milliseconds limit) {
    deadline_ = std::chrono::steady_clock::now() + limit;
    const auto message = in_.next();
    if (!message) return std::nullopt;
    return dataset::ros::decode_scan(message->data, "test").stamp;
  }

  std::chrono::steady_clock::time_point deadline_;
  LiveWriter out_;
  std::uint16_t odometry_;
  LiveReader in_;
  dataset::MessageWriter message_;
};

TEST(LockStep, EachScanIsSentAfterTheAnswerToTheOneBefore) {
  const LiveCalls live;
  live.simulate("data", 1.0);
  SlowNode node(live.options());
  Program play = live.start("play --json --lock-step odom " + live.path("data"), "play.json");
  EXPECT_EQ(node.run({}), 10);
  ASSERT_EQ(play.wait(), 0) << live.text("play.json");
  const Json told = live.json("play.json");
  EXPECT_EQ(told.at("answered"), 10);
  EXPECT_EQ(told.at("unanswered"), 0);
  EXPECT_GT(told.at("answer_median_s"), 0.08);
  EXPECT_LT(told.at("answer_median_s"), 1.0);
}

TEST(LockStep, AScanWithoutAnAnswerIsWaitedForAndCounted) {
  const LiveCalls live;
  live.simulate("data", 1.0);
  SlowNode node(live.options());
  Program play = live.start("play --json --answer-limit 0.7 --lock-step /odom " + live.path("data"),
                            "play.json");
  EXPECT_EQ(node.run({0, 4, 9}), 10);
  ASSERT_EQ(play.wait(), 0) << live.text("play.json");
  EXPECT_EQ(live.json("play.json").at("answered"), 7);
  EXPECT_EQ(live.json("play.json").at("unanswered"), 3);
}

TEST(LockStep, ANodeThatDoesNotAppearIsNamed) {
  const LiveCalls live;
  live.simulate("data", 0.5);
  EXPECT_EQ(
      live.call("play --start-limit 1 --lock-step /odom " + live.path("data") + live.domain()), 1);
  EXPECT_THAT(live.text("log.txt"),
              AllOf(HasSubstr("nobody subscribes to /livox_mid360/points"), HasSubstr("1 s")));
}

/// An external program: our own odometry, as a node.
std::string node_yaml(const std::string& name, const std::string& command,
                      const std::string& more = "", const std::string& before = "") {
  return "{name: " + name + ", command: '" + command + "', " + before +
         "pose_of: body, node: {odometry: /lidarena/odometry, points: /lidarena/points" + more +
         "}}";
}
const std::string kOurNode =
    LIDARENA_BINARY " run arena_lio --live --sensor {sensor} --idle 60 --out {output}/node";

TEST(LockStep, AStudyDrivesANodeAndScoresItLikeTheSameMethodOnTheFile) {
  const LiveCalls live;
  const fs::path study = live.path("study.yaml");
  dataset::write_text_file(study,
                           "title: A node\nscenes: [{world: house, flight: house, seconds: 3}]\n"
                           "sensors: [livox_mid360]\nalgorithms: [arena_lio, node, broken]\n"
                           "external:\n- " +
                               node_yaml("node", kOurNode, "", "start_s: 1000, ") + "\n- " +
                               node_yaml("broken", "echo no map; exit 3") + "\n");
  ASSERT_EQ(live.call("study " + study.string() + " --out " + live.path("out")), 0)
      << live.text("log.txt");
  const auto run = [&](const std::string& name) {
    return live.path("out/runs/house-house-s1-livox_mid360-" + name);
  };
  const auto node = dataset::read_run(run("node-external"));
  expect_same_poses(node.live, dataset::read_run(run("arena_lio")).live);
  const Json& messages = node.manifest.messages;
  EXPECT_EQ(messages.at("answered"), 30);
  EXPECT_EQ(messages.at("unanswered"), 0);
  EXPECT_EQ(messages.at("lost"), 0);
  const Json metrics = dataset::read_json(run("node-external") + "/metrics.json");
  EXPECT_EQ(metrics.at("status"), "ok");
  EXPECT_FALSE(metrics.at("/maps/own"_json_pointer).is_null());
  EXPECT_FALSE(fs::exists(run("node-external") + "/input"));
  EXPECT_THAT(dataset::read_bytes(run("node-external") + "/program.log"),
              HasSubstr("waits for /livox_mid360/points"));
  const Json broken = dataset::read_json(run("broken-external") + "/manifest.json");
  EXPECT_THAT(broken.at("reason").get<std::string>(),
              AllOf(HasSubstr("ended before the data did"), HasSubstr("exit code 3")));
  EXPECT_EQ(dataset::read_bytes(run("broken-external") + "/program.log"), "no map\n");
}

TEST(LockStep, ANodeIsAlsoFedAtARateAndStoppedAfterwards) {
  const LiveCalls live;
  live.simulate("data", 2.0);
  dataset::write_text_file(
      live.path("node.yaml"),
      node_yaml("node", "echo $$ > " + live.path("pid") + "; exec " + kOurNode, ", rate: 1"));
  ASSERT_EQ(live.call("run node " + live.path("data") + " --external " + live.path("node.yaml") +
                      " --out " + live.path("run")),
            0)
      << live.text("log.txt");
  EXPECT_GE(dataset::read_run(live.path("run")).live.size(), 18U);
  EXPECT_NE(kill(std::stoi(live.text("pid")), 0), 0) << "the node still runs";
}

TEST(LockStep, ANodeThatNeverAnswersIsStoppedToo) {
  const LiveCalls live;
  live.simulate("data", 0.5);
  dataset::write_text_file(live.path("node.yaml"),
                           node_yaml("node", "echo $$ > " + live.path("pid") + "; exec sleep 100",
                                     ", start_limit_s: 2"));
  EXPECT_EQ(live.call("run node " + live.path("data") + " --external " + live.path("node.yaml") +
                      " --out " + live.path("run")),
            1);
  EXPECT_THAT(live.text("log.txt"), HasSubstr("nobody subscribes"));
  EXPECT_NE(kill(std::stoi(live.text("pid")), 0), 0) << "the node still runs";
}

}  // namespace
}  // namespace lidarena::dds
