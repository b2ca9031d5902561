// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/part_file.hpp"

#include <gmock/gmock.h>

#include "lidarena/base/error.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

TEST(PartFile, HasItsNameOnlyOnceCommitted) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.txt";
  PartFile out(file);
  out.write("hello ");
  EXPECT_FALSE(exists(file));
  EXPECT_TRUE(exists(folder.path() / "a.txt.part"));
  out.write("world");
  EXPECT_EQ(out.size(), 11U);
  out.commit();
  EXPECT_EQ(file_text(file), "hello world");
  EXPECT_FALSE(exists(folder.path() / "a.txt.part"));
}

TEST(PartFile, KeepsTheOldFileUntilTheNewOneIsComplete) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.txt";
  write_text_file(file, "old");
  {
    PartFile abandoned(file);
    abandoned.write("new");
  }
  EXPECT_EQ(file_text(file), "old");
  EXPECT_TRUE(exists(folder.path() / "a.txt.part"));
}

TEST(PartFile, KeepsTheOrderOfSmallAndLargePieces) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.bin";
  const std::string large(700'000, 'x');
  PartFile out(file);
  out.write("head");
  out.write(large);
  out.write("tail");
  out.commit();
  EXPECT_EQ(file_text(file), "head" + large + "tail");
}

TEST(PartFile, SaysThatTheDiskIsFullAndLeavesNoWholeFile) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full: not tested";
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.txt";
  std::filesystem::create_symlink("/dev/full", folder.path() / "a.txt.part");
  PartFile out(file);
  out.write("hello");
  try {
    out.commit();
    FAIL() << "a full disk was not detected";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(file.string()),
                                             testing::HasSubstr("No space left")));
  }
  EXPECT_FALSE(exists(file));
}

TEST(PartFile, AMissingFolderIsBadInput) {
  const TemporaryFolder folder;
  EXPECT_THROW(PartFile(folder.path() / "missing" / "a.txt"), InputError);
}

}  // namespace
}  // namespace lidarena::dataset
