// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study_recording.hpp"

#include <filesystem>

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// The value of each key in which `own` is not the default, else that of `other`.
StudyRecording merged(const StudyRecording& own, const StudyRecording& other) {
  const Json mine = to_json(own), defaults = to_json(StudyRecording{});
  Json both = to_json(other);
  for (const auto& [key, value] : mine.items())
    if (value != defaults[key]) both[key] = value;
  StudyRecording recording;
  read_json(both, recording, "recording");
  return recording;
}

std::string absolute(const StudyRecording& recording, const char* key, const std::string& path) {
  const std::string place = "study: recording " + recording.name;
  if (path.empty())
    throw InputError(place, std::string("has no ") + key, std::string("add ") + key + ": FILE");
  if (!fs::exists(path))
    throw InputError(
        place, std::string(key) + ": " + path + " does not exist",
        recording.source.empty() ? "check the path" : "it can be had from " + recording.source);
  return fs::absolute(path).lexically_normal().string();
}

}  // namespace

StudyRecording resolved(const StudyRecording& recording, const stages::ConfigFolder& configs) {
  StudyRecording whole = recording;
  if (!recording.like.empty())
    whole = merged(recording,
                   load_config<StudyRecording>(configs.resolve("recordings", recording.like)));
  if (whole.name.empty() || whole.name.find('/') != std::string::npos)
    throw InputError("study: recordings", "a recording has the name '" + whole.name + "'",
                     "give each a name without '/', since a folder is named after it");
  whole.file = absolute(whole, "file", whole.file);
  whole.truth = absolute(whole, "truth", whole.truth);
  return whole;
}

std::uint64_t bytes_of(const StudyRecording& recording) {
  if (!fs::is_directory(recording.file)) return fs::file_size(recording.file);
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(recording.file))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

}  // namespace lidarena::study
