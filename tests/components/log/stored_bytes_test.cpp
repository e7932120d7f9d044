// SPDX-License-Identifier: Apache-2.0
#include "components/log/stored_bytes.hpp"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

void write(const std::filesystem::path& file, std::size_t bytes) {
  std::ofstream(file) << std::string(bytes, 'x');
}

TEST(StoredBytes, AreThoseOfAFileWithWhatSqliteKeepsBesideIt) {
  const test::TemporaryDirectory dir;
  write(dir.path() / "a.db", 100);
  EXPECT_EQ(stored_bytes(dir.path() / "a.db"), 100U);
  write(dir.path() / "a.db-wal", 20);
  write(dir.path() / "a.db-shm", 3);
  write(dir.path() / "a.db2", 1000);
  EXPECT_EQ(stored_bytes(dir.path() / "a.db"), 123U);
}

TEST(StoredBytes, AreThoseOfAllFilesInAFolder) {
  const test::TemporaryDirectory dir;
  std::filesystem::create_directories(dir.path() / "in" / "it");
  write(dir.path() / "a", 5);
  write(dir.path() / "in" / "it" / "b", 6);
  EXPECT_EQ(stored_bytes(dir.path()), 11U);
}

TEST(StoredBytes, AreNoneWhereNothingIs) { EXPECT_EQ(stored_bytes("/nowhere/at/all"), 0U); }

}  // namespace
}  // namespace strata::log
