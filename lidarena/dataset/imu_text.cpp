// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/imu_text.hpp"

#include <fmt/format.h>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {

std::vector<ImuSample> read_imu_text(const std::filesystem::path& file) {
  TextRows rows(file);
  std::vector<ImuSample> samples;
  while (const auto row = rows.next()) {
    const auto words = split_words(*row);
    const std::string place = rows.place();
    if (words.size() != 7) {
      throw InputError(place, fmt::format("holds {} columns, not 7", words.size()),
                       "rows are t wx wy wz ax ay az");
    }
    const auto number = [&](std::size_t i) { return finite_number(words[i], place); };
    samples.push_back({seconds_at(words[0], place),
                       {number(1), number(2), number(3)},
                       {number(4), number(5), number(6)}});
    if (samples.size() > 1 && samples.back().stamp <= samples[samples.size() - 2].stamp) {
      throw InputError(place, "the time is not later than that of the previous row",
                       "sort the rows by time and remove duplicates");
    }
  }
  return samples;
}

ImuTextWriter::ImuTextWriter(const std::filesystem::path& file) : out_(file) {
  out_.write("# t[s] wx wy wz[rad/s] ax ay az[m/s^2]\n");
}

void ImuTextWriter::write(const ImuSample& sample) {
  const Eigen::Vector3d& w = sample.gyro;
  const Eigen::Vector3d& a = sample.accel;
  out_.write(fmt::format("{} {} {} {} {} {} {}\n", format_seconds(sample.stamp), w.x(), w.y(),
                         w.z(), a.x(), a.y(), a.z()));
}

}  // namespace lidarena::dataset
