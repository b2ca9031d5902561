// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/run_events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeader = "t_sensor_s,duration_s,kind,value";

RunEventKind kind_at(std::string_view word, const std::string& place) {
  const auto* const found = std::ranges::find(kRunEvents, word, &RunEventInfo::name);
  if (found != kRunEvents.end()) return found->kind;
  std::string known;
  for (const RunEventInfo& info : kRunEvents)
    known += (known.empty() ? "" : ", ") + std::string(info.name);
  throw InputError(place, fmt::format("'{}' is not a kind of event", word), "known: " + known);
}

}  // namespace

void write_events(const fs::path& file, const std::vector<RunEvent>& events) {
  std::string text = std::string(kHeader) + "\n";
  for (const RunEvent& event : events) {
    fmt::format_to(std::back_inserter(text), "{:.9f},{:.9f},{},{:.9g}\n", event.t_sensor_s,
                   event.duration_s, info_of(event.kind).name, event.value);
  }
  write_text_file(file, text);
}

std::vector<RunEvent> read_events(const fs::path& file) {
  TextRows rows(file);
  const auto header = rows.next();
  if (!header || *header != kHeader) {
    throw InputError(file.string() + ":1", "is not the header of events.csv",
                     fmt::format("it must be {}", kHeader));
  }
  std::vector<RunEvent> events;
  while (const auto row = rows.next()) {
    const auto parts = split_commas(*row);
    const std::string place = rows.place();
    if (parts.size() != 4)
      throw InputError(place, fmt::format("holds {} columns, not 4", parts.size()));
    RunEvent event{finite_number(parts[0], place), finite_number(parts[1], place),
                   kind_at(parts[2], place), finite_number(parts[3], place)};
    if (event.duration_s < 0.0)
      throw InputError(place, fmt::format("'{}' is a negative duration", parts[1]));
    events.push_back(event);
  }
  return events;
}

}  // namespace lidarena::dataset
