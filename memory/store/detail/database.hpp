// SPDX-License-Identifier: Apache-2.0
/// A thin owner of one SQLite connection and its statements; errors become InputError when reading
/// and OutputError when writing, with the path as the place, and std::bad_alloc where memory ran
/// out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace strata::memory::detail {

/// One open database file. Not thread-safe.
class Database {
 public:
  /// Opens or creates (read_only: opens) the file; waits up to busy_timeout_ms for other writers.
  Database(const std::filesystem::path& path, bool read_only, int busy_timeout_ms);

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] bool read_only() const { return read_only_; }

  /// The write-ahead log stays beside the file when this is closed.
  void leave_log();
  /// Whether no transaction is under way.
  [[nodiscard]] bool is_between_transactions() const;
  /// Runs statements that return nothing of interest.
  void execute(const char* sql);
  /// The same for a statement that SQLite answers with "busy" without waiting (changing the journal
  /// mode): tries again until the busy timeout is over.
  void execute_patiently(const char* sql);
  /// First column of the first row as an integer; 0 without a row.
  [[nodiscard]] std::int64_t query_integer(const char* sql);
  /// First column of the first row as text; empty without a row.
  [[nodiscard]] std::string query_text(const char* sql);

  /// Throws the error of the last failed call. doing: "read" or "write", for the message.
  [[noreturn]] void fail(const char* doing);
  [[nodiscard]] sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  void open(const std::string& uri, int flags);

  std::string place_;
  bool read_only_ = false;
  int busy_timeout_ms_ = 0;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A prepared statement. Values are bound in order, columns read in order.
class Statement {
 public:
  Statement(Database& database, const char* sql);

  Statement& bind(std::int64_t value);
  Statement& bind(int value) { return bind(static_cast<std::int64_t>(value)); }
  /// NaN becomes NULL, which `real` reads back as NaN.
  Statement& bind(double value);
  Statement& bind(const std::string& value);
  Statement& bind(std::span<const std::byte> value);
  Statement& bind_null();

  /// True when there is a row to read; false at the end.
  [[nodiscard]] bool step();
  /// Runs to the end and makes ready for the next binding.
  void run();
  /// Makes ready for the next binding.
  void reset();

  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::vector<std::byte> blob(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void check(int code);

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int next_parameter_ = 1;
};

}  // namespace strata::memory::detail
