// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/sqlite/db3_reader.hpp"

#include <fstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"

#ifdef LIDARENA_HAVE_SQLITE
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>

#include "lidarena/dataset/messages/ros_messages.hpp"
#endif

namespace lidarena::dataset {

namespace fs = std::filesystem;

bool is_sqlite(const fs::path& file) {
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string beginning(kMagic.size(), '\0');
  std::ifstream(file, std::ios::binary)
      .read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  return beginning == kMagic;
}

#ifdef LIDARENA_HAVE_SQLITE

namespace {

/// "file:PATH?mode=ro", with the characters that a URI reserves escaped. Without a journal beside
/// it, nothing else writes the file, and SQLite needs no lock.
std::string uri_of(const fs::path& file) {
  std::string uri = "file:";
  for (const char c : fs::absolute(file).string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  const bool has_journal = fs::exists(file.string() + "-wal");
  return uri + (has_journal ? "?mode=ro" : "?mode=ro&immutable=1");
}

/// A database, closed at the end of its life.
class Database {
 public:
  explicit Database(const fs::path& file) : place_(file.string()) {
    const int result = sqlite3_open_v2(uri_of(file).c_str(), &database_,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    if (result == SQLITE_OK) {
      // Lets SQLite open a file that is shorter than its header says; nothing is ever written.
      sqlite3_exec(database_, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
      return;
    }
    const std::string why = sqlite3_errmsg(database_);
    sqlite3_close(database_);
    throw InputError(place_, "cannot be opened: " + why, "check the path");
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  [[noreturn]] void damaged(std::uint64_t messages) const {
    throw DamagedFile(place_,
                      fmt::format("the database is cut off or damaged after {} messages ({})",
                                  messages, sqlite3_errmsg(database_)),
                      "the messages before are intact; copy the file again");
  }
  sqlite3* get() const { return database_; }
  const std::string& place() const { return place_; }

 private:
  std::string place_;
  sqlite3* database_ = nullptr;
};

/// A query whose rows are read one by one.
class Query {
 public:
  Query(const Database& database, const char* sql) : database_(database) {
    const int result = sqlite3_prepare_v2(database.get(), sql, -1, &statement_, nullptr);
    if (result == SQLITE_OK) return;
    if (result == SQLITE_ERROR || result == SQLITE_NOTADB) {  // no such table, no pages
      throw InputError(database.place(),
                       std::string("is no bag of rosbag2: ") + sqlite3_errmsg(database.get()),
                       "give a file that 'ros2 bag record' wrote");
    }
    database.damaged(0);
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  /// False at the end.
  bool step() {
    const int result = sqlite3_step(statement_);
    if (result == SQLITE_ROW) ++rows_;
    if (result != SQLITE_ROW && result != SQLITE_DONE) database_.damaged(rows_);
    return result == SQLITE_ROW;
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text == nullptr ? std::string{} : text;
  }
  Bytes blob(int column) const {
    const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_, column));
    return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  std::uint64_t rows_ = 0;
};

std::map<std::int64_t, RecordedTopic> topics_of(const Database& database) {
  std::map<std::int64_t, RecordedTopic> topics;
  Query query(database, "SELECT id, name, type, serialization_format FROM topics");
  while (query.step())
    topics[query.integer(0)] = {query.text(1), ros::ros2_name(query.text(2)), query.text(3), 0};
  return topics;
}

}  // namespace

struct Db3Reader::Impl {
  explicit Impl(const fs::path& file) : database(file), topics(topics_of(database)) {}

  Database database;
  std::map<std::int64_t, RecordedTopic> topics;
  Query messages{database, "SELECT topic_id, timestamp, data FROM messages ORDER BY id"};
};

Db3Reader::Db3Reader(const fs::path& file) : impl_(std::make_unique<Impl>(file)) {}
Db3Reader::~Db3Reader() = default;

std::optional<RecordedMessage> Db3Reader::next() {
  while (impl_->messages.step()) {
    const auto topic = impl_->topics.find(impl_->messages.integer(0));
    if (topic == impl_->topics.end()) continue;
    const auto encoding = encoding_of(topic->second);
    if (!encoding) continue;
    return RecordedMessage{topic->second.topic, topic->second.type, *encoding,
                           Time{impl_->messages.integer(1)}, impl_->messages.blob(2)};
  }
  return std::nullopt;
}

RecordingInfo read_db3_info(const fs::path& file) {
  const Database database(file);
  std::map<std::int64_t, RecordedTopic> topics = topics_of(database);
  RecordingInfo info;
  try {
    Query rows(database, "SELECT topic_id, timestamp FROM messages ORDER BY id");
    while (rows.step()) {
      const Time time{rows.integer(1)};
      info.start = info.message_count == 0 ? time : std::min(info.start, time);
      info.end = std::max(info.end, time);
      ++info.message_count;
      if (const auto topic = topics.find(rows.integer(0)); topic != topics.end())
        ++topic->second.message_count;
    }
  } catch (const DamagedFile& error) {
    info.damage = error.what();
  }
  for (auto& [id, topic] : topics) info.topics.push_back(std::move(topic));
  return info;
}

#else

namespace {
[[noreturn]] void reject(const fs::path& file) {
  throw InputError(file.string(), "is a bag in SQLite storage, which this build cannot read",
                   "build with libsqlite3-dev, or convert it with 'ros2 bag convert' to mcap");
}
}  // namespace

struct Db3Reader::Impl {};
Db3Reader::Db3Reader(const fs::path& file) { reject(file); }
Db3Reader::~Db3Reader() = default;
std::optional<RecordedMessage> Db3Reader::next() { return std::nullopt; }
RecordingInfo read_db3_info(const fs::path& file) { reject(file); }

#endif

}  // namespace lidarena::dataset
