// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/recording_parts.hpp"

#include <stdlib.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/points/sweeps.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

bool is_compressed(const fs::path& file) {
  return file.extension() == ".zstd" || file.extension() == ".zst";
}

/// The files in the order of their first messages; those of equal time keep their order.
std::vector<fs::path> by_time(const std::vector<fs::path>& files) {
  std::vector<std::pair<Time, fs::path>> parts;
  for (const fs::path& file : files) parts.emplace_back(read_recording_info(file).start, file);
  std::ranges::stable_sort(parts, {}, [](const auto& part) { return part.first; });
  std::vector<fs::path> sorted;
  for (auto& [start, file] : parts) sorted.push_back(std::move(file));
  return sorted;
}

/// Reads files one after the other; where one is damaged, the error comes after all files.
class Parts final : public RecordingReader {
 public:
  explicit Parts(std::vector<fs::path> files) : files_(std::move(files)) {}

  std::optional<RecordedMessage> next() override {
    while (next_ <= files_.size()) {
      try {
        if (reader_) {
          if (auto message = reader_->next()) return message;
        }
      } catch (const DamagedFile& error) {
        if (damage_.empty()) damage_ = error.what();
      }
      if (next_ == files_.size()) break;
      reader_ = open_recording(files_[next_++]);
    }
    if (!damage_.empty()) throw DamagedFile(damage_, "the other parts of the recording were read");
    return std::nullopt;
  }

 private:
  std::vector<fs::path> files_;
  std::size_t next_ = 0;
  std::unique_ptr<RecordingReader> reader_;
  std::string damage_;
};

void add(const RecordingInfo& part, RecordingInfo& all) {
  for (const RecordedTopic& topic : part.topics) {
    const auto same = std::ranges::find_if(all.topics, [&](const RecordedTopic& other) {
      return other.topic == topic.topic && other.type == topic.type &&
             other.message_encoding == topic.message_encoding;
    });
    if (same == all.topics.end()) {
      all.topics.push_back(topic);
    } else {
      same->message_count += topic.message_count;
    }
  }
  if (part.message_count > 0) {
    all.start = all.message_count == 0 ? part.start : std::min(all.start, part.start);
    all.end = std::max(all.end, part.end);
  }
  all.message_count += part.message_count;
  all.chunk_count += part.chunk_count;
  all.from_summary = all.from_summary && part.from_summary;
  if (all.damage.empty()) all.damage = part.damage;
  all.metadata.insert(part.metadata.begin(), part.metadata.end());
}

}  // namespace

bool is_recording_name(const fs::path& file) {
  fs::path name = file.filename();
  if (is_compressed(name)) name = name.stem();
  if (name.extension() == ".active" || name.extension() == ".part") name = name.stem();
  static constexpr std::array kEndings{".mcap", ".bag", ".db3"};
  return std::ranges::find(kEndings, name.extension().string()) != kEndings.end();
}

std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_recording_name(entry.path())) files.push_back(entry.path());
  }
  // what was unpacked beside its compressed file exists once
  std::erase_if(files, [&](const fs::path& file) {
    return is_compressed(file) && fs::exists(fs::path(file).replace_extension());
  });
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

std::unique_ptr<RecordingReader> open_parts(const std::vector<fs::path>& files) {
  return std::make_unique<Parts>(by_time(files));
}

RecordingInfo read_parts_info(const std::vector<fs::path>& files) {
  RecordingInfo all;
  all.from_summary = true;
  for (const fs::path& file : files) add(read_recording_info(file), all);
  return all;
}

UnpackedRecording::UnpackedRecording(const fs::path& recording) : path_(recording) {
  const bool is_folder = fs::is_directory(recording);
  const auto files = is_folder ? recordings_in(recording) : std::vector{recording};
  if (std::ranges::none_of(files, is_compressed)) return;
  std::string name = (fs::temp_directory_path() / "lidarena-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(name + ": cannot be created; set TMPDIR to a folder with space");
  folder_ = name;
  for (const fs::path& file : files) {
    const fs::path unpacked = folder_ / (is_compressed(file) ? file.stem() : file.filename());
    try {
      if (is_compressed(file)) {
        decompress_zstd_file(file, unpacked);
      } else {
        fs::create_symlink(fs::absolute(file), unpacked);
      }
    } catch (const std::exception& error) {
      fs::remove_all(folder_);
      if (dynamic_cast<const Error*>(&error) != nullptr) throw;
      throw InputError(file.string(), error.what(), "copy the file again");
    }
    path_ = is_folder ? folder_ : unpacked;
  }
}

UnpackedRecording::~UnpackedRecording() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace lidarena::dataset
