// SPDX-License-Identifier: Apache-2.0
/// Bags to look into and to spoil.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "components/log/bag.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {

inline std::vector<std::int64_t> numbers(std::int64_t count) {
  std::vector<std::int64_t> all;
  for (std::int64_t i = 0; i < count; ++i) all.push_back(i);
  return all;
}

class BagFilesTest : public ::testing::Test {
 protected:
  void execute(const std::filesystem::path& file, const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    char* error = nullptr;
    sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error);
    EXPECT_EQ(error, nullptr) << error;
    sqlite3_free(error);
    sqlite3_close(database);
  }
  /// `count` messages of 1,000 bytes, one a nanosecond.
  std::filesystem::path write(const BagOptions& options, std::int64_t count,
                              const std::string& name = "bag") {
    const std::filesystem::path bag = folder_.path() / name;
    BagWriter writer(bag, options);
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    const std::vector<std::uint8_t> data(1000, 0);
    for (std::int64_t i = 0; i < count; ++i) writer.write(topic, {i}, data);
    writer.close();
    return bag;
  }
  strata::test::TemporaryDirectory folder_;
};

}  // namespace strata::log
