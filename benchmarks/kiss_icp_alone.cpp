// SPDX-License-Identifier: BSD-3-Clause
// Runs KISS-ICP on a sequence of synthetic rooms (scans.txt, scans/%06d.bin with x y z t in
// doubles) with as little other code as when the cost of the published program was measured. Under
// `valgrind --tool=callgrind` the difference of two runs with different numbers of scans gives the
// instructions per scan; prints the process's peak memory. Usage:
//   kiss_icp_alone FOLDER SCANS [published|head|indoor]
#include <sys/resource.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

namespace lidarena {
namespace {

Scan scan_of(const std::string& file, double begin_s) {
  constexpr std::size_t kColumns = 4;
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw InputError(file, "cannot be opened", "use a sequence with scans.txt and scans/");
  std::vector<double> values(static_cast<std::size_t>(in.tellg()) / sizeof(double));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(values.data()),
          static_cast<std::streamsize>(values.size() * sizeof(double)));
  Scan scan;
  scan.stamp = from_seconds(begin_s);
  for (std::size_t i = 0; i + kColumns <= values.size(); i += kColumns) {
    Point point;
    point.position = Eigen::Vector3d(values[i], values[i + 1], values[i + 2]).cast<float>();
    point.dt_ns = static_cast<std::int32_t>((from_seconds(values[i + 3]) - scan.stamp).count());
    scan.points.push_back(point);
  }
  return scan;
}

odometry::kiss_icp::Config config_of(const std::string& preset, const LidarInfo& lidar) {
  if (preset == "published") return odometry::kiss_icp::published(lidar);
  if (preset == "head") return odometry::kiss_icp::head(lidar);
  if (preset == "indoor") return odometry::kiss_icp::indoor(lidar);
  throw InputError("preset", "there is no '" + preset + "'", "use published, head or indoor");
}

int run(const std::string& folder, int scans, const std::string& preset) {
  const LidarInfo lidar;
  odometry::kiss_icp::KissIcp odometry(config_of(preset, lidar), lidar, Parallel(1));
  std::ifstream index(folder + "/scans.txt");
  double begin_s = 0.0, end_s = 0.0;
  int number = 0, done = 0;
  for (; done < scans && index >> number >> begin_s >> end_s; ++done) {
    char name[32];
    std::snprintf(name, sizeof(name), "/scans/%06d.bin", number);
    odometry.register_scan(scan_of(folder + name, begin_s));
  }
  if (done == 0) throw InputError(folder + "/scans.txt", "lists no scans", "check the folder");
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const Eigen::Vector3d end = odometry.trajectory().poses().back().world_from_body.translation();
  std::printf("%d scans, at %.3f %.3f %.3f m, peak %.1f MiB\n", done, end.x(), end.y(), end.z(),
              static_cast<double>(usage.ru_maxrss) / 1024.0);
  return 0;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "kiss_icp_alone FOLDER SCANS [published|head|indoor]\n");
    return 2;
  }
  try {
    return lidarena::run(argv[1], std::stoi(argv[2]), argc > 3 ? argv[3] : "indoor");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kiss_icp_alone: %s\n", error.what());
    return 2;
  }
}
