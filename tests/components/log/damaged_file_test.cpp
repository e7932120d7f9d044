// SPDX-License-Identifier: Apache-2.0
#include "components/log/damaged_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class DamagedFile : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path file(const std::string& name = "kept.db") const {
    return folder_.path() / name;
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(file(name), std::ios::binary | std::ios::trunc) << content;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    return test::bytes_of(file(name));
  }
  static void fail() { throw DamageError("kept.db: chunk 3", "is damaged", "mend it"); }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(DamagedFile, IsSetAsideUnderANameOfItsOwnEachTime) {
  write("kept.db", "first");
  EXPECT_EQ(set_aside(file()), file("kept.db.damaged"));
  write("kept.db", "second");
  EXPECT_EQ(set_aside(file()), file("kept.db.damaged-2"));
  write("kept.db.damaged-3-wal", "what a crash left");
  write("kept.db", "third");
  EXPECT_EQ(set_aside(file()), file("kept.db.damaged-4"));
  EXPECT_FALSE(fs::exists(file()));
  EXPECT_EQ(read("kept.db.damaged"), "first");
  EXPECT_EQ(read("kept.db.damaged-2"), "second");
  EXPECT_EQ(read("kept.db.damaged-4"), "third");
  EXPECT_TRUE(is_set_aside(file("kept.db.damaged-4-wal")));
  EXPECT_FALSE(is_set_aside(file()));
}

TEST_F(DamagedFile, TakesWhatSqliteKeepsBesideItAlongAndComesLastItself) {
  write("kept.db", "a");
  write("kept.db-wal", "b");
  write("kept.db-shm", "c");
  const strata::test::WatchedDisk disk;
  (void)set_aside(file(), disk);
  EXPECT_THAT(disk.steps(), ElementsAre("rename kept.db-shm to kept.db.damaged-shm",
                                        "rename kept.db-wal to kept.db.damaged-wal",
                                        "rename kept.db to kept.db.damaged",
                                        "sync " + file().parent_path().filename().string()));
  EXPECT_EQ(read("kept.db.damaged-wal"), "b");
  EXPECT_EQ(read("kept.db.damaged-shm"), "c");
}

TEST_F(DamagedFile, IsNamedWithWhatIsWrongAndWhereItIsNow) {
  write("kept.db", "content");
  const auto told = restore_or_set_aside(file(), fail);
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->place(), "kept.db: chunk 3");
  EXPECT_THAT(told->what(), HasSubstr("is damaged"));
  EXPECT_THAT(told->what(), HasSubstr(file("kept.db.damaged").string()));
  EXPECT_FALSE(told->remedy().empty());
  EXPECT_EQ(read("kept.db.damaged"), "content");
}

TEST_F(DamagedFile, IsOneThatIsEmptyOrOfUnknownContentToo) {
  write("kept.db", "");
  bool is_read = false;
  EXPECT_TRUE(restore_or_set_aside(file(), [&] { is_read = true; }).has_value());
  EXPECT_FALSE(is_read);
  write("kept.db", "who knows");
  EXPECT_TRUE(restore_or_set_aside(file(), [] {
                throw UnknownContentError("kept.db", "is no store", "name another");
              }).has_value());
  EXPECT_EQ(read("kept.db.damaged-2"), "who knows");
}

TEST_F(DamagedFile, IsNotOneThatIsWholeOrMissingOrNotForUs) {
  EXPECT_FALSE(restore_or_set_aside(file(), [] {}).has_value());
  write("kept.db", "content");
  EXPECT_FALSE(restore_or_set_aside(file(), [] {}).has_value());
  EXPECT_THROW(
      (void)restore_or_set_aside(
          file(), [] { throw InputError("kept.db", "was written by a newer Strata", "update"); }),
      InputError);
  EXPECT_THROW((void)restore_or_set_aside(
                   file(), [] { throw ConfigError("kept.db", "other settings", "give those"); }),
               ConfigError);
  EXPECT_EQ(read("kept.db"), "content");
}

TEST_F(DamagedFile, ThatCannotBeSetAsideIsAnErrorWithBothReasons) {
  write("kept.db", "content");
  strata::test::WatchedDisk disk;
  disk.before_step = [&](std::size_t) {
    throw OutputError(file().string(), "read-only file system", "check the disk");
  };
  try {
    (void)restore_or_set_aside(file(), fail, disk);
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is damaged"));
    EXPECT_THAT(error.what(), HasSubstr("read-only file system"));
  }
  EXPECT_EQ(read("kept.db"), "content");
}

}  // namespace
}  // namespace strata::log
