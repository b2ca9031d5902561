// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/live_options.hpp"

#include "apps/lidarena/live_topics.hpp"

namespace lidarena {

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

void add_run_to_record(CLI::App& verb, live::RunToRecord& run) {
  verb.add_option(
      "--truth", run.dataset,
      "Record a SLAM node's poses and map as a RUN folder, which is scored against this "
      "DATASET, the one that is played");
  add_topic_option(verb, "--odometry-topic", run.topics.odometry,
                   "With --truth: poses; default: the only topic of Odometry, else of Path, that "
                   "is not the truth");
  add_topic_option(verb, "--path-topic", run.topics.path,
                   "With --truth: a Path, whose last message is the final trajectory");
  add_topic_option(verb, "--points-topic", run.topics.points,
                   "With --truth: registered clouds, in the frame of the poses, for the map; "
                   "default: none");
  verb.add_option(
          "--pose-of", run.pose_of,
          "With --truth: frame of the poses: body, lidar or imu; default: by the frame that "
          "they name, else lidar")
      ->check(CLI::IsMember({"body", "lidar", "imu"}));
  verb.add_option("--sensor", run.sensor, "With --truth: the LiDAR, if the dataset has several");
  verb.add_option("--name", run.name, "With --truth: the node's name in tables")
      ->capture_default_str();
  verb.add_option("--first-limit", run.first_limit_s,
                  "With --truth: gives up when no pose came for so many seconds; 0: never")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void add_live_simulation(CLI::App& verb, live::LiveSimulation& live) {
  verb.add_flag("--live", live.asked,
                "Publish the measurements on live topics while they are simulated, as play does; "
                "the dataset is written as with --no-data");
  verb.add_option("--rate", live.rate, "With --live: speed, times that of the sensors")
      ->check(CLI::PositiveNumber);
  verb.add_option("--wait", live.wait_s,
                  "With --live: seconds before the first message, in which subscribers find the "
                  "topics")
      ->check(CLI::NonNegativeNumber);
  verb.add_flag("--sensors-only", live.sensors_only,
                "With --live: leave out the truth: /truth/... and /tf");
  verb.add_option("--domain", live.domain,
                  "With --live: DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  verb.add_flag("--network", live.network, "With --live: reach other machines, too");
}

void add_live_run(CLI::App& verb, live::LiveRun& run) {
  verb.add_flag("--live", run.asked,
                "Run on live topics of --sensor (a name of list sensors) and publish the poses");
  verb.add_option("--points-topic", run.points_topic, "With --live; default: /SENSOR/points");
  verb.add_option("--idle", run.idle_s,
                  "With --live: ends when nothing came for so many seconds after the first message")
      ->check(CLI::NonNegativeNumber);
  verb.add_option(
          "--queue", run.queue,
          "With --live: scans that may wait while the algorithm is busy; of more, the oldest "
          "are dropped; 0: all wait")
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--domain", run.domain, "With --live: DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  verb.add_flag("--network", run.network, "With --live: reach other machines, too");
}

}  // namespace lidarena
