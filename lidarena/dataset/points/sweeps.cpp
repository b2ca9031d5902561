// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/sweeps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/points/sweep_file.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kEndings{".pcd", ".ply", ".bin"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_sweep_name(const fs::path& file) {
  const std::string ending = file.extension().string();
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

/// Removes the leading digits from `text` and returns them.
std::string_view take_digits(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  const std::string_view run = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(run.size());
  return run;
}

std::string_view without_leading_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

/// Sweep files directly in `folder`, in natural order.
std::vector<fs::path> sweeps_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_sweep_name(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

void check_one_kind(const fs::path& place, const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (file.extension() != files.front().extension()) {
      throw InputError(place.string(),
                       fmt::format("holds both {} and {} sweeps",
                                   files.front().extension().string(), file.extension().string()),
                       "keep one kind in the folder, or give the files one by one");
    }
  }
}

/// Stamps from file names of 19 digits; empty unless all names are such.
std::vector<Time> stamps_of_names(const std::vector<fs::path>& files) {
  std::vector<Time> stamps;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    std::int64_t ns = 0;
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), ns);
    if (stem.size() != 19 || error != std::errc{} || end != stem.data() + stem.size() || ns < 0) {
      return {};
    }
    stamps.emplace_back(ns);
  }
  return stamps;
}

std::vector<Time> stamps_at_rate(std::size_t count, double rate_hz) {
  std::vector<Time> stamps;
  for (std::size_t i = 0; i < count; ++i) {
    stamps.push_back(from_seconds(static_cast<double>(i) / rate_hz));
  }
  return stamps;
}

/// Stamps of the sweeps; adds to `notes` if neither times.txt nor the names state them. (64-bit
/// times of points, known only when a sweep is read, replace them.)
std::vector<Time> stamps_of(const std::vector<fs::path>& files,
                            const std::optional<fs::path>& times_file, double rate_hz,
                            std::vector<std::string>& notes) {
  if (times_file) {
    auto stamps = read_times(*times_file);
    if (stamps.size() != files.size()) {
      throw InputError(times_file->string(),
                       fmt::format("holds {} times for {} sweeps", stamps.size(), files.size()),
                       "it must hold one time per sweep; complete or remove it");
    }
    return stamps;
  }
  auto stamps = stamps_of_names(files);
  if (!stamps.empty()) return stamps;
  notes.push_back(
      fmt::format("no times.txt and no stamps in file names: a sweep rate of {} Hz is assumed, "
                  "unless points have absolute times",
                  rate_hz));
  return stamps_at_rate(files.size(), rate_hz);
}

/// Names of the layouts whose point size divides the sizes of all files.
std::vector<std::string> fitting_layouts(const std::vector<fs::path>& files) {
  std::vector<std::string> fitting = raw_layouts();
  for (const fs::path& file : files) {
    const std::uintmax_t bytes = fs::file_size(file);
    std::erase_if(fitting,
                  [&](const std::string& layout) { return bytes % raw_point_size(layout) != 0; });
  }
  return fitting;
}

/// The layout of raw sweeps; adds to `notes` when it is inferred from the file sizes.
std::string layout_of(const std::vector<fs::path>& files, const ReadOptions& options,
                      std::vector<std::string>& notes) {
  if (!options.layout.empty()) {
    raw_point_size(options.layout);
    return options.layout;
  }
  const auto fitting = fitting_layouts(files);
  if (fitting.size() == 1) {
    notes.push_back(
        fmt::format("raw sweeps are taken as {}: the only known layout whose point size divides "
                    "the sizes of all {} files",
                    fitting.front(), files.size()));
    return fitting.front();
  }
  const std::string fits = fitting.empty() ? "none" : fmt::format("{}", fmt::join(fitting, ", "));
  throw InputError(
      files.front().string(),
      fmt::format(
          "no file states the layout of these raw sweeps; the layouts that fit their sizes: {}",
          fits),
      fmt::format("choose one with --layout {}", fmt::join(raw_layouts(), "|")));
}

/// Mean sweep rate (Hz) by the stamps; `fallback` if they do not give one.
double mean_rate(const std::vector<Time>& stamps, double fallback) {
  if (stamps.size() < 2 || stamps.back() <= stamps.front()) return fallback;
  return static_cast<double>(stamps.size() - 1) / to_seconds(stamps.back() - stamps.front());
}

class SweepSource : public EventSource {
 public:
  SweepSource(std::vector<fs::path> files, std::vector<Time> stamps, std::string layout,
              std::string sensor_id, std::shared_ptr<ReadReport> report)
      : files_(std::move(files)),
        stamps_(std::move(stamps)),
        layout_(std::move(layout)),
        sensor_id_(std::move(sensor_id)),
        report_(std::move(report)) {}

  std::optional<Event> next() override {
    if (next_ == files_.size()) return std::nullopt;
    Scan scan = read_sweep(files_[next_], stamps_[next_], layout_);
    if (next_ > 0 && scan.stamp <= last_stamp_) {
      throw InputError(
          files_[next_].string(), "its stamp is not later than that of the previous sweep",
          "check the file names, times.txt, and that 64-bit times of points are absolute");
    }
    if (!scan.timed)
      report_->count("sweep without times of its points, not de-skewed by time", scan.stamp);
    last_stamp_ = scan.stamp;
    ++next_;
    return Event{sensor_id_, std::move(scan)};
  }

 private:
  std::vector<fs::path> files_;
  std::vector<Time> stamps_;
  std::string layout_;
  std::string sensor_id_;
  std::shared_ptr<ReadReport> report_;
  std::size_t next_ = 0;
  Time last_stamp_{0};
};

Dataset open_files(const fs::path& place, const std::vector<fs::path>& files,
                   const std::optional<fs::path>& times_file, const ReadOptions& options) {
  if (!(options.rate_hz > 0.0 && options.rate_hz <= 1e6)) {
    throw InputError("rate_hz", fmt::format("{} is not a valid sweep rate", options.rate_hz));
  }
  check_one_kind(place, files);
  Dataset dataset;
  dataset.path = place;
  const bool raw = files.front().extension() == ".bin";
  const std::string layout = raw ? layout_of(files, options, dataset.notes) : "";
  auto stamps = stamps_of(files, times_file, options.rate_hz, dataset.notes);
  if (!options.body_from_lidar) {
    dataset.notes.push_back(
        "no file states how the LiDAR is mounted; its frame is taken to be the body frame");
  }
  dataset.rig = single_lidar_rig(place, options);
  dataset.rig.lidars.front().rate_hz = mean_rate(stamps, options.rate_hz);
  dataset.scan_count = files.size();
  dataset.events = std::make_unique<SweepSource>(files, std::move(stamps), layout,
                                                 dataset.rig.lidars.front().id, dataset.report);
  return dataset;
}

/// The folder that holds the sweeps: `path`, or velodyne/ in it.
fs::path folder_of_sweeps(const fs::path& path) {
  const fs::path velodyne = path / "velodyne";
  return fs::is_directory(velodyne) && sweeps_in(path).empty() ? velodyne : path;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view run_a = take_digits(a);
      const std::string_view run_b = take_digits(b);
      const std::string_view value_a = without_leading_zeros(run_a);
      const std::string_view value_b = without_leading_zeros(run_b);
      if (value_a.size() != value_b.size()) return value_a.size() < value_b.size();
      if (value_a != value_b) return value_a < value_b;
      if (run_a.size() != run_b.size()) return run_a.size() < run_b.size();
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

bool has_sweeps(const fs::path& path) {
  if (fs::is_regular_file(path)) return is_sweep_name(path);
  return fs::is_directory(path) && !sweeps_in(folder_of_sweeps(path)).empty();
}

Dataset open_sweep_folder(const fs::path& path, const ReadOptions& options) {
  if (fs::is_regular_file(path)) return open_sweep_files({path}, options);
  if (!fs::is_directory(path)) {
    throw InputError(path.string(), "there is no such folder", "check the path");
  }
  const auto files = sweeps_in(folder_of_sweeps(path));
  if (files.empty()) {
    throw InputError(path.string(), "holds no sweep", "give a folder of .pcd, .ply or .bin files");
  }
  const fs::path times = path / "times.txt";
  return open_files(path, files, fs::exists(times) ? std::optional(times) : std::nullopt, options);
}

Dataset open_sweep_files(const std::vector<fs::path>& files, const ReadOptions& options) {
  if (files.empty()) throw InputError("sweeps", "no file is given");
  for (const fs::path& file : files) {
    if (!fs::is_regular_file(file) || !is_sweep_name(file)) {
      throw InputError(file.string(), "is not a sweep file", "give .pcd, .ply or .bin files");
    }
  }
  return open_files(files.front(), files, std::nullopt, options);
}

}  // namespace lidarena::dataset
