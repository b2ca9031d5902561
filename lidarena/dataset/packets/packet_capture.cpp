// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/packet_capture.hpp"

#include <fmt/format.h>

#include <deque>
#include <exception>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/packets/ouster_packets.hpp"
#include "lidarena/dataset/packets/pcap_reader.hpp"
#include "lidarena/dataset/packets/velodyne_packets.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/stream_merge.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLidar = "lidar";
constexpr const char* kImu = "imu";

/// The events of a capture; `take` (a datagram to the merge) and `finish` are of the maker.
class PacketEvents : public EventSource {
 public:
  PacketEvents(const fs::path& file, const std::vector<std::string>& imus,
               std::shared_ptr<ReadReport> report)
      : reader_(file), report_(std::move(report)), merge_(file.string(), imus, report_.get()) {}

  std::optional<Event> next() override {
    while (true) {
      if (auto event = merge_.pop()) return event;
      if (finished_ && failure_) std::rethrow_exception(failure_);
      if (finished_) return std::nullopt;
      read_next();
    }
  }

 protected:
  virtual void take(const Datagram& datagram) = 0;
  virtual std::optional<Scan> last_scan() = 0;
  void push(Scan scan) {
    merge_.push({kLidar, std::move(scan)});
    if (const auto imu = merge_.lagging()) merge_.give_up(*imu);
  }
  void push(const ImuSample& sample) { merge_.push({kImu, sample}); }

 private:
  void read_next() {
    try {
      if (const auto datagram = reader_.next()) return take(*datagram);
    } catch (const DamagedFile&) {
      failure_ = std::current_exception();
    }
    if (auto scan = last_scan()) push(*std::move(scan));
    merge_.finish();
    finished_ = true;
  }

  PcapReader reader_;
  std::shared_ptr<ReadReport> report_;
  StreamMerge merge_;
  bool finished_ = false;
  std::exception_ptr failure_;
};

class OusterEvents final : public PacketEvents {
 public:
  OusterEvents(const fs::path& file, const OusterMetadata& meta, bool has_imu,
               std::shared_ptr<ReadReport> report)
      : PacketEvents(file, has_imu ? std::vector<std::string>{kImu} : std::vector<std::string>{},
                     std::move(report)),
        meta_(meta),
        scans_(meta) {}

 private:
  void take(const Datagram& datagram) override {
    if (datagram.port == meta_.lidar_port && datagram.payload.size() == scans_.packet_bytes()) {
      if (auto scan = scans_.push(datagram.payload)) push(*std::move(scan));
    } else if (datagram.port == meta_.imu_port) {
      if (const auto sample = ouster_imu_sample(datagram.payload)) push(*sample);
    }
  }
  std::optional<Scan> last_scan() override { return scans_.finish(); }

  OusterMetadata meta_;
  OusterScans scans_;
};

class VelodyneEvents final : public PacketEvents {
 public:
  VelodyneEvents(const fs::path& file, std::shared_ptr<ReadReport> report)
      : PacketEvents(file, {}, std::move(report)), scans_(file.string()) {}

 private:
  void take(const Datagram& datagram) override {
    if (datagram.payload.size() != kVelodynePacket) return;
    if (auto scan = scans_.push(datagram.captured, datagram.payload)) push(*std::move(scan));
  }
  std::optional<Scan> last_scan() override { return scans_.finish(); }

  VelodyneScans scans_;
};

/// The metadata beside a capture; empty when there are none.
std::optional<fs::path> find_metadata(const fs::path& capture) {
  const std::string stem = capture.stem().string();
  std::vector<fs::path> all;
  std::optional<fs::path> nearest;
  for (const auto& entry : fs::directory_iterator(fs::absolute(capture).parent_path())) {
    const fs::path& file = entry.path();
    if (file.extension() != ".json") continue;
    try {
      if (!is_ouster_metadata(read_json(file))) continue;
    } catch (const InputError&) {
      continue;  // another kind of file
    }
    all.push_back(file);
    const bool is_nearer =
        !nearest || file.stem().string().size() > nearest->stem().string().size();
    if (stem.starts_with(file.stem().string()) && is_nearer) nearest = file;
  }
  return nearest || all.size() != 1 ? nearest : std::optional(all.front());
}

/// Sizes of packets at the beginning of a capture, by port.
struct Traffic {
  std::map<std::pair<std::uint16_t, std::size_t>, std::size_t> packets;

  explicit Traffic(const fs::path& file) {
    constexpr int kLook = 2000;  // packets: more than a second of any LiDAR
    PcapReader reader(file);
    try {
      for (int i = 0; i < kLook; ++i) {
        const auto datagram = reader.next();
        if (!datagram) break;
        ++packets[{datagram->port, datagram->payload.size()}];
      }
    } catch (const DamagedFile&) {
      // reported when the events are read
    }
  }
  bool has(std::uint16_t port, std::size_t size) const { return packets.contains({port, size}); }
  bool has_size(std::size_t size) const {
    return std::ranges::any_of(packets, [&](const auto& p) { return p.first.second == size; });
  }
  std::string text() const {
    std::string list;
    for (const auto& [kind, count] : packets)
      list += fmt::format("{}{} of {} bytes to port {}", list.empty() ? "" : ", ", count,
                          kind.second, kind.first);
    return list.empty() ? "no UDP packet" : list;
  }
};

Dataset open_ouster(const fs::path& file, const fs::path& metadata, const Traffic& traffic,
                    const ReadOptions& options) {
  constexpr std::size_t kImuPacket = 48;
  const OusterMetadata meta = read_ouster_metadata(metadata);
  const std::size_t size = OusterScans(meta).packet_bytes();
  if (!traffic.has(meta.lidar_port, size)) {
    throw InputError(file.string(),
                     fmt::format("holds no packets of {} bytes to port {}, which {} describes",
                                 size, meta.lidar_port, metadata.filename().string()),
                     "it holds " + traffic.text() + "; give the metadata of this recording");
  }
  Dataset dataset;
  dataset.path = file;
  dataset.rig = single_lidar_rig(file, options);
  LidarInfo& lidar = dataset.rig.lidars.front();
  lidar.model = meta.model;
  lidar.kind = "spinning";
  lidar.rows = static_cast<int>(meta.rows());
  lidar.columns = meta.columns_per_frame;
  lidar.beam_origin_m = meta.beam_origin_m.norm();
  lidar.rate_hz = meta.rate_hz;
  if (!options.body_from_lidar) lidar.body_from_lidar = meta.sensor_from_lidar;
  const bool has_imu = traffic.has(meta.imu_port, kImuPacket);
  if (has_imu) {
    ImuInfo& imu = dataset.rig.imus.emplace_back();
    imu.id = kImu;
    imu.rate_hz = 100.0;
    imu.body_from_imu = meta.sensor_from_imu;
  }
  dataset.notes.push_back(
      fmt::format("packets of an {} are read by {}; the body frame is its "
                  "sensor frame",
                  meta.model, metadata.filename().string()));
  dataset.events = std::make_unique<OusterEvents>(file, meta, has_imu, dataset.report);
  return dataset;
}

}  // namespace

bool is_packet_capture(const fs::path& file) {
  return file.extension() == ".pcap" || file.extension() == ".pcapng";
}

Dataset open_packet_capture(const fs::path& file, const ReadOptions& options) {
  const Traffic traffic(file);
  if (const auto metadata = find_metadata(file))
    return open_ouster(file, *metadata, traffic, options);
  if (!traffic.has_size(kVelodynePacket)) {
    throw InputError(
        file.string(), "holds no packets that can be read without metadata",
        "of an Ouster, put its metadata (JSON) beside the capture; it holds " + traffic.text());
  }
  Dataset dataset;
  dataset.path = file;
  dataset.rig = single_lidar_rig(file, options);
  dataset.rig.lidars.front().kind = "spinning";
  dataset.notes.push_back("packets of a Velodyne are read; sweeps begin at azimuth 0");
  dataset.events = std::make_unique<VelodyneEvents>(file, dataset.report);
  return dataset;
}

}  // namespace lidarena::dataset
