// SPDX-License-Identifier: Apache-2.0
/// Where tests find real logs, and what happens when they are not there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace strata::test {

/// Path of a file below the folder of real logs (STRATA_DATA_DIR, default ../shared/data), or
/// nothing when the folder is missing.
[[nodiscard]] std::optional<std::filesystem::path> find_data(const std::string& relative);

/// Whether a missing folder of logs is a failure: with CI set it is.
[[nodiscard]] bool data_is_required();

/// What a file holds; nothing when it cannot be read.
[[nodiscard]] std::string bytes_of(const std::filesystem::path& path);

/// A fresh directory that is removed at the end of the scope.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace strata::test

/// Declares `variable`, the path of real data; without the data the test is skipped, or fails in
/// CI.
#define STRATA_REQUIRE_DATA(variable, relative)                                          \
  const auto variable##_found = ::strata::test::find_data(relative);                     \
  if (!variable##_found) {                                                               \
    if (::strata::test::data_is_required()) {                                            \
      GTEST_FAIL() << "missing " << (relative) << "; set STRATA_DATA_DIR to the folder"; \
    }                                                                                    \
    GTEST_SKIP() << "no " << (relative) << " in STRATA_DATA_DIR";                        \
  }                                                                                      \
  const std::filesystem::path variable = *variable##_found
