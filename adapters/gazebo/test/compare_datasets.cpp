// SPDX-License-Identifier: BSD-3-Clause
// Checks that two datasets of one scene have the same measurements; one may begin later.
// usage: compare_datasets DATASET DATASET      exits with 1 if more than one point in 1000 differs
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <tuple>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena {
namespace {

constexpr float kTolerance = 1e-4F;  // m

struct Measurements {
  std::map<Time, Scan> scans;
  std::map<Time, ImuSample> samples;
};

Measurements read(const char* path) {
  Measurements all;
  const dataset::Dataset dataset = dataset::open_dataset(path);
  while (auto event = dataset.events->next()) {
    if (auto* scan = std::get_if<Scan>(&event->data)) {
      all.scans[scan->stamp] = std::move(*scan);
    } else {
      const auto& sample = std::get<ImuSample>(event->data);
      all.samples[sample.stamp] = sample;
    }
  }
  return all;
}

struct Differences {
  std::size_t scans = 0, points = 0, same = 0, moved = 0, unmatched = 0;
  double worst_of_same = 0.0, sum_of_same = 0.0;
};

auto key(const Point& p) { return std::tuple(p.dt_ns, p.ring, p.echo); }

/// Points of the same shot are matched by their instant and ring.
void compare(Scan a, Scan b, Differences& d) {
  const auto before = [](const Point& p, const Point& q) { return key(p) < key(q); };
  std::sort(a.points.begin(), a.points.end(), before);
  std::sort(b.points.begin(), b.points.end(), before);
  ++d.scans;
  auto p = a.points.begin();
  auto q = b.points.begin();
  while (p != a.points.end() && q != b.points.end()) {
    if (key(*p) != key(*q)) {
      ++d.unmatched;
      key(*p) < key(*q) ? ++p : ++q;
      continue;
    }
    const float apart = (p->position - q->position).norm();
    ++d.points;
    if (apart <= kTolerance) {
      ++d.same;
      d.sum_of_same += static_cast<double>(apart);
      d.worst_of_same = std::max(d.worst_of_same, static_cast<double>(apart));
    } else {
      ++d.moved;
    }
    ++p;
    ++q;
  }
  d.unmatched += static_cast<std::size_t>((a.points.end() - p) + (b.points.end() - q));
}

int main_of(const char* first, const char* second) {
  const Measurements a = read(first), b = read(second);
  Differences d;
  for (const auto& [stamp, scan] : a.scans) {
    const auto other = b.scans.find(stamp);
    if (other != b.scans.end()) compare(scan, other->second, d);
  }
  double gyro = 0.0, accel = 0.0;
  std::size_t samples = 0;
  for (const auto& [stamp, sample] : a.samples) {
    const auto other = b.samples.find(stamp);
    if (other == b.samples.end()) continue;
    ++samples;
    gyro = std::max(gyro, (sample.gyro - other->second.gyro).norm());
    accel = std::max(accel, (sample.accel - other->second.accel).norm());
  }
  fmt::print(
      "{} scans, {} points of the same shots: {} within {} m (mean {:.2e}, largest {:.2e}), {} "
      "farther apart; {} shots with a return in only one dataset\n",
      d.scans, d.points, d.same, kTolerance, d.sum_of_same / static_cast<double>(d.same),
      d.worst_of_same, d.moved, d.unmatched);
  fmt::print(
      "{} IMU samples: angular rates within {:.2e} rad/s, accelerations within {:.2e} m/s^2\n",
      samples, gyro, accel);
  return d.points > 0 && 1000 * (d.moved + d.unmatched) <= d.points ? 0 : 1;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    return lidarena::main_of(argv[1], argv[2]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
