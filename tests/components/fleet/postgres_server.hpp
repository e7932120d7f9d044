// SPDX-License-Identifier: Apache-2.0
/// A PostgreSQL server of a test's own, from Debian's package, in a temporary folder, on a socket.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "components/fleet/connection.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {

class PostgresServer {
 public:
  /// Where Debian keeps its programs; nothing when they are not installed.
  [[nodiscard]] static std::optional<std::filesystem::path> programs();

  /// Makes a cluster whose superuser is `admin`, and starts it. Everybody needs a password.
  /// Requires programs(). more: settings as `-c NAME=VALUE`.
  explicit PostgresServer(const std::string& more = "");
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// For a role; `admin` without a password has its own.
  [[nodiscard]] std::string url(const std::string& role = "admin",
                                const std::string& password = "admin secret",
                                const std::string& more = "") const;
  [[nodiscard]] fleet::Connection admin() const { return fleet::Connection(url()); }

  /// All its processes die at once, as at a power cut.
  void kill_hard();
  /// Starts what was killed, and waits until it has recovered.
  void start();
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TemporaryDirectory folder_;
  std::string more_;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace strata::test

/// Skips the test where there is no PostgreSQL, or fails it with CI set.
#define STRATA_REQUIRE_POSTGRES()                                                \
  if (!::strata::test::PostgresServer::programs()) {                             \
    if (::strata::test::data_is_required()) {                                    \
      GTEST_FAIL() << "no PostgreSQL; tools/install-packages --tests";           \
    }                                                                            \
    GTEST_SKIP() << "no PostgreSQL; tools/install-packages --tests installs it"; \
  }                                                                              \
  static_assert(true)
