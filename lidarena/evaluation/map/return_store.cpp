// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/return_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/existing_folder.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"

namespace lidarena::evaluation {
namespace {

namespace fs = std::filesystem;

/// What stands before the points of a scan.
struct ScanHeader {
  std::int64_t stamp_ns = 0;
  std::uint64_t points = 0;
  std::uint64_t timed = 0;
};

/// A Point without alignment and constructors, as it lies in the file.
struct KeptPoint {
  float x, y, z, intensity;
  std::int32_t dt_ns;
  std::uint16_t ring;
  std::uint8_t echo;
};

KeptPoint kept_of(const Point& p) {
  return {p.position.x(), p.position.y(), p.position.z(), p.intensity, p.dt_ns, p.ring, p.echo};
}

Point point_of(const KeptPoint& p) {
  return {{p.x, p.y, p.z}, p.intensity, p.dt_ns, p.ring, p.echo};
}

[[noreturn]] void fail(const fs::path& folder, const char* what) {
  throw Error(folder.string() + ": " + what + ": " + std::strerror(errno));
}

/// A file without a name.
std::FILE* open_unnamed(const fs::path& folder) {
  std::string name = (folder / ".returns_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail(folder, "cannot create a temporary file");
  unlink(name.c_str());
  return fdopen(descriptor, "w+b");
}

}  // namespace

ReturnStore::ReturnStore(const fs::path& folder, std::string lidar_id, std::size_t max_returns)
    : folder_(dataset::existing_folder(folder)),
      lidar_id_(std::move(lidar_id)),
      max_returns_(max_returns),
      file_(open_unnamed(folder_), &std::fclose) {}

void ReturnStore::keep(const Scan& scan) {
  const std::size_t stride = scoring_stride(scan.points.size(), max_returns_);
  std::vector<KeptPoint> kept;
  for (std::size_t i = 0; i < scan.points.size(); i += stride)
    kept.push_back(kept_of(scan.points[i]));
  const ScanHeader header{scan.stamp.count(), kept.size(), scan.timed ? 1U : 0U};
  if (std::fwrite(&header, sizeof(header), 1, file_.get()) != 1 ||
      std::fwrite(kept.data(), sizeof(KeptPoint), kept.size(), file_.get()) != kept.size())
    fail(folder_, "cannot keep the scored returns");
}

/// Passes events on.
class ReturnStore::Keeper : public EventSource {
 public:
  Keeper(ReturnStore& store, std::unique_ptr<EventSource> events)
      : store_(store), events_(std::move(events)) {}
  std::optional<Event> next() override {
    std::optional<Event> event = events_->next();
    const auto* scan = event ? std::get_if<Scan>(&event->data) : nullptr;
    if (scan != nullptr && event->sensor_id == store_.lidar_id_) store_.keep(*scan);
    return event;
  }

 private:
  ReturnStore& store_;
  std::unique_ptr<EventSource> events_;
};

class ReturnStore::Reader : public EventSource {
 public:
  explicit Reader(const ReturnStore& store) : store_(store) {
    if (std::fflush(file()) != 0) fail(store.folder_, "cannot keep the scored returns");
    std::rewind(file());
  }
  std::optional<Event> next() override {
    ScanHeader header;
    if (std::fread(&header, sizeof(header), 1, file()) != 1) return std::nullopt;
    std::vector<KeptPoint> kept(header.points);
    if (std::fread(kept.data(), sizeof(KeptPoint), kept.size(), file()) != kept.size())
      fail(store_.folder_, "cannot read the scored returns again");
    Scan scan{Time{header.stamp_ns}, {}, header.timed != 0};
    for (const KeptPoint& point : kept) scan.points.push_back(point_of(point));
    return Event{store_.lidar_id_, std::move(scan)};
  }

 private:
  std::FILE* file() const { return store_.file_.get(); }
  const ReturnStore& store_;
};

std::unique_ptr<EventSource> ReturnStore::keep_from(std::unique_ptr<EventSource> events) {
  return std::make_unique<Keeper>(*this, std::move(events));
}

std::unique_ptr<EventSource> ReturnStore::read() const { return std::make_unique<Reader>(*this); }

}  // namespace lidarena::evaluation
