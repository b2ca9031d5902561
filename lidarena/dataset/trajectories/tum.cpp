// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/tum.hpp"

#include <fmt/format.h>

#include <iterator>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

namespace lidarena::dataset {
namespace {

void append_comments(std::string& text, std::string_view header) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find('\n'), header.size());
    fmt::format_to(std::back_inserter(text), "# {}\n", header.substr(0, end));
    header.remove_prefix(std::min(end + 1, header.size()));
  }
}

void append_row(std::string& text, const StampedPose& row) {
  Eigen::Quaterniond q = Eigen::Quaterniond(row.world_from_body.linear()).normalized();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  text += format_seconds(row.stamp);
  const Eigen::Vector3d t = row.world_from_body.translation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    fmt::format_to(std::back_inserter(text), " {:.9g}", value + 0.0);  // no "-0"
  }
  text += '\n';
}

}  // namespace

Trajectory read_tum(const std::filesystem::path& file, EmptyTrajectory empty,
                    std::vector<StampedPose>* repeated) {
  TextRows rows(file);
  TrajectoryRows poses(repeated);
  while (const auto row = rows.next()) {
    const auto words = split_words(*row);
    const std::string place = rows.place();
    if (words.size() != 8) {
      throw InputError(place, fmt::format("holds {} columns, not 8", words.size()),
                       "rows are t x y z qx qy qz qw, separated by blanks");
    }
    const auto number = [&](std::size_t i) { return finite_number(words[i], place); };
    const Eigen::Vector3d position(number(1), number(2), number(3));
    const Eigen::Quaterniond rotation(number(7), number(4), number(5), number(6));
    poses.add(seconds_at(words[0], place), pose_from_row(position, rotation, place), place);
  }
  if (poses.empty() && empty == EmptyTrajectory::kAllowed) return {};
  return poses.finish(file.string());
}

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::string& header) {
  TumWriter out(file, header);
  for (const StampedPose& pose : trajectory.poses()) out.write(pose);
  out.close();
}

TumWriter::TumWriter(const std::filesystem::path& file, const std::string& header)
    : place_(file.string()), out_(file) {
  std::string comments;
  append_comments(comments, header);
  out_.write(comments);
}

void TumWriter::write(const StampedPose& pose) {
  if (latest_ && pose.stamp <= *latest_) {
    throw InputError(place_,
                     fmt::format("a pose at {} s comes after one at {} s",
                                 format_seconds(pose.stamp), format_seconds(*latest_)),
                     "write poses in time order, one per time");
  }
  if (!pose.world_from_body.matrix().allFinite()) {
    throw InputError(place_,
                     fmt::format("the pose at {} s is not finite", format_seconds(pose.stamp)),
                     "the estimate has diverged");
  }
  latest_ = pose.stamp;
  std::string row;
  append_row(row, pose);
  out_.write(row);
}

void TumWriter::close() { out_.commit(); }

}  // namespace lidarena::dataset
