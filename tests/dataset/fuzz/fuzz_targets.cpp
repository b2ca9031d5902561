// SPDX-License-Identifier: BSD-3-Clause
#include "tests/dataset/fuzz/fuzz_targets.hpp"

#ifdef LIDARENA_TEST_SQLITE
#include <sqlite3.h>
#endif

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "lidarena/base/error.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/imu_text.hpp"
#include "lidarena/dataset/mcap/mcap_writer.hpp"
#include "lidarena/dataset/messages/driver_layouts.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/packets/velodyne_packets.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/points/sweep_file.hpp"
#include "lidarena/dataset/ros1/bag_writer.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "tests/dataset/packet_samples.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset::fuzz {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Runs `read`, which may throw InputError.
template <class Read>
void ignore_input_errors(Read&& read) {
  try {
    read();
  } catch (const InputError&) {
    // allowed: the input was rejected
  }
}

void drain(EventSource& source) {
  while (source.next()) {
  }
}

/// Calls every function that reads a dataset.
void read_dataset(const fs::path& path) {
  ignore_input_errors([&] { drain(*open_dataset(path).events); });
  ignore_input_errors([&] { load_truth(path); });
  ignore_input_errors([&] {
    if (const auto truth = open_scan_truth(path)) {
      while (truth->next()) {
      }
    }
  });
}

/// A temporary folder of this process; its files are rewritten for each input.
const fs::path& scratch() {
  static const TemporaryFolder folder;
  return folder.path();
}

fs::path written(const fs::path& file, std::string_view bytes) {
  fs::create_directories(file.parent_path());
  fs::remove(file);  // overwriting makes some file systems wait for the disk
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

void write_dataset(const fs::path& path, const WriteOptions& options) {
  DatasetWriter out(path, sample::rig(), options);
  int next_truth = 0;
  for (const Event& event : sample::events(2, 8)) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      out.write(ScanTruth{"mid360", scan->stamp, {PointTruth{}}});
    } else if (next_truth < 5) {
      out.write_truth(sample::truth(next_truth++));
    }
    out.write(event);
  }
  out.close();
}

std::string dataset_file(const char* name, const WriteOptions& options) {
  const fs::path file = scratch() / name;
  write_dataset(file, options);
  return text_of(file);
}

/// A bag with uncompressed chunks has no checksums: damage reaches the decoders of messages.
std::string stored_bag() {
  const fs::path file = scratch() / "stored.bag";
  BagWriter out(file, {.compression = BagCompression::kNone});
  const std::uint16_t points = out.add_topic("/points", ros::kPointCloud2);
  const std::uint16_t imu = out.add_topic("/imu", ros::kImu);
  const std::uint16_t livox = out.add_topic("/livox", "livox_ros_driver/msg/CustomMsg");
  MessageWriter message(Encoding::kRos1);
  LidarInfo lidar;
  for (int i = 0; i < 3; ++i) {
    ros::encode_scan(sample::scan(i, 6), "lidar", message);
    out.write(points, sample::kStart, sample::kStart, message.bytes());
    encode_livox_custom(sample::scan(i, 6), lidar, "lidar", message);
    out.write(livox, sample::kStart, sample::kStart, message.bytes());
    ros::encode_imu(sample::imu(i), "imu", message);
    out.write(imu, sample::kStart, sample::kStart, message.bytes());
  }
  out.close();
  return text_of(file);
}

Target recordings(const char* ending, std::vector<std::string> corpus) {
  return {ending, std::move(corpus),
          [file = scratch() / (std::string("in.") + ending)](std::string_view bytes) {
            read_dataset(written(file, bytes));
          }};
}

Target clouds(const char* ending) {
  const fs::path file = scratch() / (std::string("cloud.") + ending);
  const bool is_pcd = std::string_view(ending) == "pcd";
  Cloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  cloud.intensity = {7, 8};
  is_pcd ? write_pcd(file, cloud) : write_ply(file, cloud);
  std::vector<std::string> corpus{text_of(file)};
  is_pcd ? write_sweep_pcd(file, sample::scan(0, 5)) : write_sweep_ply(file, sample::scan(0, 5));
  corpus.push_back(text_of(file));
  corpus.push_back(is_pcd ? "VERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F U\nCOUNT 1 1 1 "
                            "1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3 4\n5 6 7 8\n"
                          : "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int v\n"
                            "element vertex 2\nproperty float x\nproperty double y\nproperty float "
                            "z\nend_header\n3 1 2 3\n1 2 3\n4 5 6\n");
  return {ending, corpus, [file](std::string_view bytes) {
            written(file, bytes);
            ignore_input_errors([&] { read_cloud(file); });
            ignore_input_errors([&] { read_sweep(file, Time{5}); });
          }};
}

Target raw_sweeps() {
  const fs::path file = scratch() / "sweep.bin";
  write_sweep_bin(file, sample::scan(0, 5));
  return {"bin", {text_of(file)}, [file](std::string_view bytes) {
            written(file, bytes);
            for (const std::string& layout : raw_layouts()) {
              ignore_input_errors([&] { read_sweep(file, Time{5}, layout); });
            }
          }};
}

Target trajectories() {
  const fs::path file = scratch() / "path" / "poses.txt";
  fs::create_directories(file.parent_path());
  std::vector<StampedPose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(sample::truth(i));
  write_tum(file, Trajectory(poses), kTruthHeader);
  std::vector<std::string> corpus{text_of(file)};
  write_kitti_poses(file, Trajectory(poses));
  corpus.push_back(text_of(file));
  corpus.push_back(
      "#timestamp, p x, p y, p z, q w, q x, q y, q z\n1403636580838555648,1,2,3,1,0,"
      "0,0\n1403636580843555648,1,2,3.5,0.9999,0.01,0,0\n");
  corpus.push_back(
      "%time,field.pose.pose.position.x,y,z,field.pose.pose.orientation.x,qy,qz,qw,v.x\n"
      "1403636580838555648,1,2,3,0,0,0,1,5\n1403636580.9,1,2,3.5,0,0.01,0,0.9999,5\n");
  return {"trajectory", corpus, [file](std::string_view bytes) {
            written(file, bytes);
            ignore_input_errors([&] { read_trajectory(file); });
            ignore_input_errors([&] { read_framed_trajectory(file); });
            ignore_input_errors([&] { read_times(file); });
            ignore_input_errors([&] { read_imu_text(file); });
          }};
}

/// Captures of an Ouster of two beams and of a Velodyne, with the metadata beside them.
Target captures() {
  const fs::path folder = scratch() / "capture";
  written(folder / "a.json",
          R"({"prod_line": "OS-1-2", "udp_profile_lidar": "RNG15_RFL8_NIR8", "lidar_mode": "4x10",
              "columns_per_frame": 4, "columns_per_packet": 2, "beam_altitude_angles": [10, -10],
              "beam_azimuth_angles": [0, 0],
              "lidar_to_sensor_transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
              "imu_to_sensor_transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})");
  std::vector<std::string> ouster;
  for (std::uint16_t k = 0; k < 4; ++k) {
    const std::string packet =
        ouster_packet(OusterProfile::kLowRate, k / 2, static_cast<std::uint16_t>(2 * (k % 2)),
                      packed(std::uint16_t{500}, std::uint8_t{9}, std::uint8_t{9}));
    ouster.push_back(ip_frame(udp(packet, 7502), k, 0, false));
    ouster.push_back(ip_frame(udp(std::string(48, '\x3f'), 7503), k, 0, false));
  }
  std::string velodyne(1206, '\x11');
  for (std::size_t block = 0; block < 12; ++block)
    velodyne.replace(100 * block, 4, packed(std::uint16_t{0xEEFF}, std::uint16_t{3000}));
  velodyne.replace(1200, 6, packed(0U, std::uint8_t{0x39}, std::uint8_t{0x22}));
  const std::string frame = ip_frame(udp(velodyne, 2368), 1, 0, false);
  const auto alone = scratch() / "velodyne" / "b.pcap";
  return {"pcap",
          {pcap(ouster), pcap({frame, frame}),
           pcap({ip_frame(udp(velodyne, 2368).substr(0, 800), 1, 0, true),
                 ip_frame(udp(velodyne, 2368).substr(800), 1, 800, false)})},
          [folder, alone](std::string_view bytes) {
            ignore_input_errors(
                [&] { drain(*open_dataset(written(folder / "a.pcap", bytes)).events); });
            ignore_input_errors([&] { drain(*open_dataset(written(alone, bytes)).events); });
          }};
}

#ifdef LIDARENA_TEST_SQLITE
/// A bag of rosbag2 in SQLite storage.
Target databases() {
  const fs::path file = scratch() / "a.db3";
  sqlite3* db = nullptr;
  sqlite3_open(file.c_str(), &db);
  const auto run = [&](const std::string& sql) {
    sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
      "serialization_format TEXT, offered_qos_profiles TEXT)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
      "data BLOB)");
  run("INSERT INTO topics VALUES(1,'/imu','sensor_msgs/msg/Imu','cdr','')");
  run("INSERT INTO topics VALUES(2,'/points','sensor_msgs/msg/PointCloud2','cdr','')");
  MessageWriter message;
  for (int i = 0; i < 3; ++i) {
    for (const int topic : {1, 2}) {
      topic == 1 ? ros::encode_imu(sample::imu(i), "imu", message)
                 : ros::encode_scan(sample::scan(i, 4), "lidar", message);
      std::string hex;
      for (const std::byte byte : message.bytes())
        hex += "0123456789abcdef"[std::to_integer<int>(byte) >> 4],
            hex += "0123456789abcdef"[std::to_integer<int>(byte) & 15];
      run("INSERT INTO messages(topic_id, timestamp, data) VALUES(" + std::to_string(topic) + "," +
          std::to_string(i) + ", x'" + hex + "')");
    }
  }
  sqlite3_close(db);
  return {"db3", {text_of(file)}, [file](std::string_view bytes) {
            read_dataset(written(file, bytes));
          }};
}
#endif

/// Dataset folders with a damaged manifest.json.
Target manifests() {
  const fs::path recorded = scratch() / "recorded";
  const fs::path sweeps = scratch() / "sweeps";
  write_dataset(recorded, {});
  write_dataset(sweeps, {.format = DatasetFormat::kPcd});
  return {"manifest",
          {text_of(recorded / "manifest.json"), text_of(sweeps / "manifest.json")},
          [recorded, sweeps](std::string_view bytes) {
            for (const fs::path& folder : {recorded, sweeps}) {
              written(folder / "manifest.json", bytes);
              read_dataset(folder);
            }
          }};
}

Target configurations() {
  return {"yaml",
          {"body_frame: base\nlidars:\n  - id: a\n    rate_hz: 10\n    pixel_shifts: [1, 2]\n    "
           "body_from_lidar: [0, 0, 0.1, 0, 0, 0, 1]\nimus: []\n",
           "? [body_frame, lidars]\n: a list as a key\n"},
          [](std::string_view bytes) {
            ignore_input_errors([&] {
              Rig rig;
              read_config(ConfigNode::parse(std::string(bytes), "fuzz"), rig);
            });
          }};
}

/// Messages as stored in recordings, in both encodings.
Target messages() {
  std::vector<std::string> corpus;
  LidarInfo lidar;
  lidar.model = "ouster_os0_128";
  for (const Encoding encoding : {Encoding::kCdr, Encoding::kRos1}) {
    MessageWriter out(encoding);
    const auto keep = [&] { corpus.push_back(text_of(out.bytes())); };
    ros::encode_scan(sample::scan(0, 4), "lidar", out);
    keep();
    encode_livox_cloud(sample::scan(0, 4), lidar, "lidar", out);
    keep();
    encode_livox_custom(sample::scan(0, 4), lidar, "lidar", out);
    keep();
    encode_ouster_cloud(sample::scan(0, 4), lidar, "lidar", out);
    keep();
    ros::encode_imu(sample::imu(0), "imu", out);
    keep();
    ros::encode_odometry(sample::truth(1), {"a", "b"}, out);
    keep();
    const ros::StampedTransform transform{sample::kStart, "a", "b", Pose::Identity()};
    ros::encode_transforms(std::span(&transform, 1), out);
    keep();
    ros::encode_scan_truth({"a", sample::kStart, {PointTruth{}}}, "world", out);
    keep();
  }
  return {"messages", corpus, [](std::string_view text) {
            const Bytes bytes = std::as_bytes(std::span(text));
            for (const Encoding encoding : {Encoding::kCdr, Encoding::kRos1}) {
              ignore_input_errors([&] { ros::decode_scan(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { ros::decode_imu(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { ros::decode_odometry(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { ros::decode_transforms(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { ros::decode_scan_truth(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { ros::decode_string(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { decode_livox(bytes, "fuzz", encoding); });
              ignore_input_errors([&] { decode_velodyne(bytes, "fuzz", encoding); });
            }
          }};
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> kTargets{
      recordings("mcap", {dataset_file("a.mcap", {}),
                          dataset_file("b.mcap", {.dialect = Dialect::kDriver})}),
      recordings("bag", {stored_bag(), dataset_file("a.bag", {})}),
      clouds("pcd"),
      clouds("ply"),
      raw_sweeps(),
      trajectories(),
      captures(),
#ifdef LIDARENA_TEST_SQLITE
      databases(),
#endif
      manifests(),
      configurations(),
      messages()};
  return kTargets;
}

const Target& target(std::string_view name) {
  for (const Target& candidate : targets()) {
    if (candidate.name == name) return candidate;
  }
  throw std::out_of_range("no such target");
}

}  // namespace lidarena::dataset::fuzz
