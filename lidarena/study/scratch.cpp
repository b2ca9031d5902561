// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/scratch.hpp"

#include <array>
#include <limits>
#include <utility>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kData = "data.mcap";
constexpr std::array kDataFiles{"data.mcap", "data.mcap.part", "metadata.yaml"};

void remove_data(const fs::path& dataset) {
  for (const char* file : kDataFiles) fs::remove(dataset / file);
}

}  // namespace

Scratch::Scratch(fs::path datasets, std::uint64_t budget_bytes,
                 std::map<std::string, std::uint64_t> needed)
    : datasets_(std::move(datasets)), budget_(budget_bytes), expected_(std::move(needed)) {
  if (!fs::exists(datasets_)) return;
  for (const auto& entry : fs::directory_iterator(datasets_)) {
    if (!is_kept(entry.path().filename())) remove_data(entry.path());
  }
}

bool Scratch::is_kept(const std::string& dataset) const {
  const auto bytes = expected_.find(dataset);
  return bytes != expected_.end() && bytes->second <= budget_;
}

bool Scratch::fits_now(const std::string& dataset) const {
  std::uint64_t bytes = expected_.at(dataset);
  for (const auto& [name, held] : held_) bytes += name == dataset ? 0 : held;
  return bytes <= budget_ || held_.empty();
}

bool Scratch::has_data(const std::string& dataset) const {
  return fs::exists(datasets_ / dataset / kData);
}

void Scratch::reserve(const std::string& dataset) { held_[dataset] = expected_.at(dataset); }

void Scratch::settle(const std::string& dataset) {
  held_.erase(dataset);
  std::error_code none;
  const std::uint64_t bytes = fs::file_size(datasets_ / dataset / kData, none);
  if (!none) held_[dataset] = bytes;
}

void Scratch::drop(const std::string& dataset) {
  remove_data(datasets_ / dataset);
  held_.erase(dataset);
}

void Scratch::give_up(const std::string& dataset) {
  drop(dataset);
  expected_.erase(dataset);
}

std::uint64_t default_scratch_bytes(const fs::path& folder) {
  fs::path place = fs::absolute(folder);
  while (!fs::exists(place) && place.has_relative_path()) place = place.parent_path();
  return fs::space(place).available / 2;
}

}  // namespace lidarena::study
