// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/workplace.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/hits_file.hpp"
#include "lidarena/dataset/md5.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kData = "data.mcap";
constexpr const char* kWorld = "world.ply";
constexpr const char* kTold = "doing.txt";
constexpr std::array kDataFiles{"data.mcap", "data.mcap.part", "metadata.yaml"};

/// Whether a file of a dataset is large and is needed only while its cells are run and scored.
bool is_data(const fs::path& file) {
  return std::ranges::find(kDataFiles, file) != kDataFiles.end() ||
         file.string().find(dataset::kHitsEnding) != std::string::npos;
}

fs::path staging_of(const fs::path& study, const std::string& token) {
  return study / "work" / token;
}

fs::path root_of(const fs::path& study, const fs::path& scratch, const std::string& token) {
  return scratch.empty() ? staging_of(study, token) : scratch / ("lidarena-" + token);
}

/// Deletes a folder; a process that is just being killed may still create a file in it.
void remove_folder(const fs::path& folder) {
  std::error_code error;
  for (int attempt = 0; attempt < 50; ++attempt) {
    fs::remove_all(folder, error);
    if (!error) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

Workplace::Workplace(fs::path study, const fs::path& scratch, const std::string& token)
    : study_(std::move(study)),
      staging_(staging_of(study_, token)),
      root_(root_of(study_, scratch, token)) {
  for (const char* part : {"runs", "datasets"}) {
    fs::create_directories(study_ / part);
    fs::create_directories(staging_ / part);
    fs::create_directories(root_ / part);
  }
}

Workplace::~Workplace() {
  remove_folder(root_);
  remove_folder(staging_);
}

void Workplace::fetch_run(const std::string& name) const {
  const fs::path place = fs::path("runs") / name;
  fs::copy(study_ / place, root_ / place, fs::copy_options::recursive);
}

void Workplace::publish_run(const std::string& name) const {
  const fs::path place = fs::path("runs") / name;
  if (root_ != staging_) {
    fs::remove_all(staging_ / place);
    fs::copy(root_ / place, staging_ / place, fs::copy_options::recursive);
    fs::remove_all(root_ / place);
  }
  replace(staging_ / place, study_ / place);
}

void Workplace::publish_dataset(const std::string& name) const {
  const fs::path place = fs::path("datasets") / name;
  const fs::path ready = staging_ / "dataset";
  fs::remove_all(ready);
  fs::copy(root_ / place, ready, fs::copy_options::recursive | fs::copy_options::directories_only);
  for (const auto& entry : fs::recursive_directory_iterator(root_ / place)) {
    const fs::path file = entry.path().lexically_relative(root_ / place);
    if (entry.is_regular_file() && !is_data(file)) fs::copy_file(entry.path(), ready / file);
  }
  if (fs::exists(ready / kWorld)) store_world(ready / kWorld);
  replace(ready, study_ / place);
}

/// Moves a world to worlds/, unless it is there, and leaves a link.
void Workplace::store_world(const fs::path& file) const {
  const fs::path name = dataset::md5_of(dataset::read_bytes(file)) + ".ply";
  const fs::path stored = study_ / "worlds" / name;
  fs::create_directories(stored.parent_path());
  if (!fs::exists(stored)) {
    const fs::path copy = staging_ / name;
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    fs::rename(copy, stored);
  }
  const fs::path link = staging_ / "link";
  std::error_code no_links;
  fs::remove(link);
  fs::create_symlink(fs::path("../../worlds") / name, link, no_links);
  if (!no_links) fs::rename(link, file);
}

/// Renames a finished folder into its place; what was there is deleted.
void Workplace::replace(const fs::path& ready, const fs::path& place) const {
  const fs::path old = staging_ / "old";
  remove_folder(old);
  std::error_code nothing_there;
  fs::rename(place, old, nothing_there);
  fs::rename(ready, place);
  remove_folder(old);
}

void Workplace::drop_data(const std::string& dataset) const {
  const fs::path folder = root_ / "datasets" / dataset;
  if (!fs::exists(folder)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  for (const fs::path& file : files)
    if (is_data(file.filename())) fs::remove(file);
}

std::uint64_t Workplace::data_bytes(const std::string& dataset) const {
  std::error_code none;
  const std::uint64_t bytes = fs::file_size(root_ / "datasets" / dataset / kData, none);
  return none ? 0 : bytes;
}

void Workplace::tell(const std::string& what) const {
  try {
    dataset::write_text_file(staging_ / kTold, what);
  } catch (const Error&) {
    // It is for people to look at; a worker that has lost its lease learns that elsewhere.
  }
}

std::string told_by(const fs::path& study, const std::string& token) {
  try {
    return dataset::read_bytes(staging_of(study, token) / kTold);
  } catch (const Error&) {
    return {};
  }
}

void clear_workplace(const fs::path& study, const fs::path& scratch, const std::string& token) {
  remove_folder(root_of(study, scratch, token));
  remove_folder(staging_of(study, token));
}

bool disk_is_full(const fs::path& folder) {
  const fs::path probe = folder / "probe";
  bool full = false;
  try {
    dataset::write_text_file(probe, std::string(std::size_t{1} << 20U, '\0'));
  } catch (const Error&) {
    full = true;
  }
  std::error_code ignored;
  fs::remove(probe, ignored);
  fs::remove(probe.string() + ".part", ignored);
  return full;
}

}  // namespace lidarena::study
