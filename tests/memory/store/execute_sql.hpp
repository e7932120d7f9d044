// SPDX-License-Identifier: Apache-2.0
/// SQL beside the store, for tests of what others did to its file.
#pragma once

#include <filesystem>

#include <gtest/gtest.h>
#include <sqlite3.h>

namespace strata::test {

inline void execute(const std::filesystem::path& path, const char* sql) {
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &handle), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(handle);
  sqlite3_close(handle);
}

}  // namespace strata::test
