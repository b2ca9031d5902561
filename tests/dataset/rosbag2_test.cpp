// SPDX-License-Identifier: BSD-3-Clause
// Bags of rosbag2: SQLite storage, several files, compressed files and messages.
#include <gmock/gmock.h>
#include <zstd.h>

#include <fstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/recording_parts.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/foreign_recording.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

#ifdef LIDARENA_TEST_SQLITE
#include <sqlite3.h>
#endif

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string zstd(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

/// Sweeps `first` to `last` of a LiDAR of 10 Hz, as MCAP.
void write_sweeps(const fs::path& file, int first, int last) {
  ForeignRecording out(file);
  for (int k = first; k < last; ++k) {
    const Time stamp = ForeignRecording::kEpoch + k * std::chrono::milliseconds(100);
    out.sweep("/points", stamp, {"t", ros::FieldType::kUint32}, {0.0, 5e7, 9.9e7}, stamp);
  }
  out.close();
}

std::size_t scans_in(const fs::path& path) { return drain(*open_dataset(path).events).size(); }

TEST(Rosbag2, AFolderWithoutMetadataIsRead) {
  const TemporaryFolder folder;
  write_sweeps(folder.path() / "a_0.mcap", 0, 20);
  EXPECT_EQ(scans_in(folder.path()), 20U);
}

TEST(Rosbag2, SplitFilesAreReadInTheOrderOfTime) {
  const TemporaryFolder folder;
  write_sweeps(folder.path() / "a_10.mcap", 30, 40);
  write_sweeps(folder.path() / "a_9.mcap", 0, 30);
  folder.write("metadata.yaml", "rosbag2_bagfile_information: {}\n");
  EXPECT_EQ(open_dataset(folder.path()).scan_count, 40U);
  EXPECT_EQ(scans_in(folder.path()), 40U);
}

TEST(Rosbag2, CompressedFilesAreUnpackedAndLeaveNothingBehind) {
  const TemporaryFolder folder;
  const auto plain = folder.path() / "plain.mcap";
  write_sweeps(plain, 0, 20);
  const auto packed = folder.write("bag/z_0.mcap.zstd", zstd(file_text(plain)));
  for (const fs::path& path : {packed, packed.parent_path()}) EXPECT_EQ(scans_in(path), 20U);
  fs::path unpacked;
  {
    const UnpackedRecording recording(packed);
    unpacked = recording.path();
    EXPECT_TRUE(fs::exists(unpacked));
  }
  EXPECT_FALSE(fs::exists(unpacked.parent_path()));
}

TEST(Rosbag2, ADamagedCompressedFileIsNamed) {
  const TemporaryFolder folder;
  write_sweeps(folder.path() / "plain.mcap", 0, 20);
  const std::string packed = zstd(file_text(folder.path() / "plain.mcap"));
  const auto cut = folder.write("bag/z_0.mcap.zstd", packed.substr(0, packed.size() / 2));
  EXPECT_THAT(input_error([&] { open_dataset(cut); }),
              testing::AllOf(HasSubstr("z_0.mcap.zstd"), HasSubstr("cut off")));
}

TEST(Rosbag2, AnMcapWithAnotherNameIsRead) {
  const TemporaryFolder folder;
  write_sweeps(folder.path() / "a.mcap", 0, 20);
  fs::rename(folder.path() / "a.mcap", folder.path() / "a.bag");
  EXPECT_EQ(scans_in(folder.path() / "a.bag"), 20U);
}

#ifdef LIDARENA_TEST_SQLITE

/// Copies a recording to SQLite storage, as rosbag2 does; `compress` packs each message.
void write_db3(const fs::path& from, const fs::path& to, bool compress = false) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(to.c_str(), &db), SQLITE_OK);
  const auto run = [&](const std::string& sql) {
    ASSERT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(db);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  std::map<std::string, int> ids;
  const auto reader = open_recording(from);
  while (const auto message = reader->next()) {
    const std::string topic(message->topic);
    if (!ids.contains(topic)) {
      ids.emplace(topic, static_cast<int>(ids.size()) + 1);
      run("INSERT INTO topics VALUES(" + std::to_string(ids[topic]) + ",'" + topic + "','" +
          std::string(message->type) + "','cdr','')");
    }
    const auto* bytes = reinterpret_cast<const char*>(message->data.data());
    const std::string data =
        compress ? zstd({bytes, message->data.size()}) : std::string(bytes, message->data.size());
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)", -1,
                       &insert, nullptr);
    sqlite3_bind_int(insert, 1, ids[topic]);
    sqlite3_bind_int64(insert, 2, message->log_time.count());
    sqlite3_bind_blob(insert, 3, data.data(), static_cast<int>(data.size()), SQLITE_STATIC);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_finalize(insert);
  }
  sqlite3_close(db);
}

TEST(Rosbag2, SqliteStorageHasTheEventsOfTheMcap) {
  const TemporaryFolder folder;
  const auto mcap = folder.path() / "plain.mcap";
  write_sweeps(mcap, 0, 20);
  const std::vector<Event> expected = drain(*open_dataset(mcap).events);
  for (const bool compress : {false, true}) {
    const auto db3 = folder.path() / (compress ? "a b%c_0.db3" : "b_0.db3");
    write_db3(mcap, db3, compress);
    Dataset dataset = open_dataset(db3);
    EXPECT_EQ(dataset.scan_count, 20U);
    EXPECT_EQ(dataset.topics.at(0).topic, "/points");
    expect_same(drain(*dataset.events), expected);
  }
}

TEST(Rosbag2, OfACutDatabaseTheRowsBeforeTheCutAreRead) {
  const TemporaryFolder folder;
  write_sweeps(folder.path() / "plain.mcap", 0, 2000);
  const auto db3 = folder.path() / "cut.db3";
  write_db3(folder.path() / "plain.mcap", db3);
  fs::resize_file(db3, fs::file_size(db3) * 6 / 10);
  Dataset dataset = open_dataset(db3);
  std::size_t scans = 0;
  try {
    while (dataset.events->next()) ++scans;
    FAIL() << "the cut was not detected";
  } catch (const DamagedFile& error) {
    EXPECT_THAT(error.what(), HasSubstr("cut.db3: the database is cut off or damaged"));
  }
  EXPECT_GT(scans, 500U);
}

TEST(Rosbag2, ADatabaseThatIsNoBagIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "other.db3";
  sqlite3* db = nullptr;
  sqlite3_open(file.c_str(), &db);
  sqlite3_exec(db, "CREATE TABLE t(a INTEGER)", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_THAT(input_error([&] { open_dataset(file); }), HasSubstr("is no bag of rosbag2"));
  EXPECT_THROW(open_dataset(folder.write(
                   "head.db3", std::string("SQLite format 3") + '\0' + std::string(100, '\0'))),
               InputError);
}

TEST(Rosbag2, ABagOfAVelodyneIsListed) {
  const auto bag = shared_data("lidar/vlp16_static/rosbag2");
  LIDARENA_NEEDS(bag);
  const RecordingInfo info = read_recording_info(bag);
  ASSERT_EQ(info.topics.size(), 1U);
  EXPECT_EQ(info.topics[0].type, "velodyne_msgs/msg/VelodyneScan");
  EXPECT_EQ(info.message_count, 4U);
}

#endif

}  // namespace
}  // namespace lidarena::dataset
