// SPDX-License-Identifier: BSD-3-Clause
// usage: write_recording_sample FOLDER [mcap|bag [driver]]
//            writes the dataset that the scripts for the official readers expect
//        write_recording_sample check FILE
//            reads a recording and compares it with that dataset
#include <cstdio>
#include <exception>
#include <string_view>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/sample_events.hpp"

namespace lidarena::dataset {
namespace {

constexpr int kScans = 20;
constexpr int kPoints = 5000;  // several chunks

void write_sample(const char* folder, const WriteOptions& options) {
  DatasetWriter out(folder, sample::rig(), options);
  int next_truth = 0;
  for (const Event& event : sample::events(kScans, kPoints)) {
    if (std::holds_alternative<ImuSample>(event.data)) out.write_truth(sample::truth(next_truth++));
    out.write(event);
  }
  out.close();
}

bool is_same(const Event& a, const Event& b) {
  if (a.sensor_id != b.sensor_id || a.data.index() != b.data.index()) return false;
  if (const auto* sample = std::get_if<ImuSample>(&a.data)) {
    const auto& other = std::get<ImuSample>(b.data);
    return sample->stamp == other.stamp && sample->gyro == other.gyro &&
           sample->accel == other.accel;
  }
  const auto& scan = std::get<Scan>(a.data);
  const auto& other = std::get<Scan>(b.data);
  return scan.stamp == other.stamp &&
         std::ranges::equal(scan.points, other.points,
                            [](const Point& p, const Point& q) { return dataset::is_same(p, q); });
}

void check_sample(const char* file) {
  const Dataset dataset = open_dataset(file);
  const std::vector<Event> expected = sample::events(kScans, kPoints);
  const std::vector<Event> found = drain(*dataset.events);
  if (!std::ranges::equal(found, expected,
                          [](const Event& a, const Event& b) { return is_same(a, b); })) {
    throw Error(std::string(file) + ": its events differ from those of the sample");
  }
}

}  // namespace
}  // namespace lidarena::dataset

int main(int argc, char** argv) try {
  if (argc == 3 && std::string_view(argv[1]) == "check") {
    lidarena::dataset::check_sample(argv[2]);
    return 0;
  }
  if (argc < 2 || argc > 4) {
    std::fputs("usage: write_recording_sample FOLDER [mcap|bag [driver]] or check FILE\n", stderr);
    return 2;
  }
  lidarena::dataset::WriteOptions options;
  if (argc > 2 && std::string_view(argv[2]) == "bag")
    options.format = lidarena::dataset::DatasetFormat::kBag;
  if (argc == 4) options.dialect = lidarena::dataset::Dialect::kDriver;
  lidarena::dataset::write_sample(argv[1], options);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
