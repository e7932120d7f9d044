// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/database.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <new>

#include <sqlite3.h>

#include "core/base/damage.hpp"
#include "memory/store/detail/schema.hpp"

namespace strata::memory::detail {
namespace {

/// Of a file that SQLite cannot read: whether it was a store once.
bool was_ours(const std::string& path) {
  // "SQLite format 3", and at byte 68 the application id.
  constexpr std::size_t kIdAt = 68;
  std::array<char, kIdAt + 4> head{};
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), head.size());
  const auto size = static_cast<std::size_t>(in.gcount());
  const std::string_view bytes(head.data(), size);
  if (!may_have_begun_with(bytes, std::string_view("SQLite format 3\0", 16))) return false;
  std::uint32_t id = 0;
  for (std::size_t i = kIdAt; i < size; ++i) {
    id = id << 8U | static_cast<std::uint8_t>(head.at(i));
  }
  const bool is_blank = size == 0 || head.front() == '\0';
  return size < head.size() || is_blank || id == kApplicationId;
}

[[noreturn]] void throw_error(const std::string& place, int code, const std::string& message,
                              bool writing) {
  const int primary = code & 0xff;
  if (primary == SQLITE_NOMEM || code == SQLITE_IOERR_NOMEM) throw std::bad_alloc();
  std::string what = writing ? "cannot write: " + message : "cannot read: " + message;
  std::string remedy;
  switch (primary) {
    case SQLITE_CANTOPEN:
      remedy = "check that the path exists and may be opened";
      break;
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      remedy = "take it from a backup, or learn the maps again into a new folder";
      if (was_ours(place)) throw DamageError(place, "is damaged (" + message + ")", remedy);
      throw UnknownContentError(place, "is not a Strata store (" + message + ")", remedy);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      what = "another program is writing to it and did not finish in time";
      remedy = "stop the other program or wait for it, then try again";
      break;
    case SQLITE_FULL:
      what = "the disk is full";
      remedy = "free some space and try again";
      break;
    case SQLITE_READONLY:
      what = "may not be written";
      remedy = "check the permissions of the file and its folder";
      break;
    default:
      remedy = "check the disk, then try again";
  }
  if (writing) throw OutputError(place, what, remedy);
  throw InputError(place, what, remedy);
}

/// A path as SQLite's URI form wants it.
std::string percent_encoded(const std::string& path) {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string result;
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      const auto byte = static_cast<unsigned char>(c);
      result += {'%', kHex[byte >> 4U], kHex[byte & 15U]};
    } else {
      result += c;
    }
  }
  return result;
}

/// Whether SQLite could not make its -wal and -shm files: in a folder that may not be written, or
/// on a full disk.
bool lacks_side_files(int code) {
  const int primary = code & 0xff;
  return primary == SQLITE_CANTOPEN || primary == SQLITE_READONLY || primary == SQLITE_FULL ||
         code == SQLITE_IOERR_SHMSIZE || code == SQLITE_IOERR_SHMOPEN ||
         code == SQLITE_IOERR_SHMMAP;
}

/// Whether a write-ahead log with content lies beside the file.
bool has_pending_log(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path.string() + "-wal", ignored);
  return !ignored && size > 0;
}

}  // namespace

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }

void Database::open(const std::string& uri, int flags) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(uri.c_str(), &raw, flags | SQLITE_OPEN_URI, nullptr);
  handle_.reset(raw);
  if (code != SQLITE_OK) {
    const std::string message = raw != nullptr ? sqlite3_errmsg(raw) : "out of memory";
    throw_error(place_, code, message, !read_only_);
  }
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, busy_timeout_ms_);
}

Database::Database(const std::filesystem::path& path, bool read_only, int busy_timeout_ms)
    : place_(path.string()), read_only_(read_only), busy_timeout_ms_(busy_timeout_ms) {
  const std::string uri = "file:" + percent_encoded(std::filesystem::absolute(path).string());
  if (!read_only) {
    open(uri, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    return;
  }
  std::error_code unreachable;
  if (!std::filesystem::exists(path, unreachable)) {
    throw InputError(place_, "there is no such file",
                     "check the path and its permissions, or learn the maps first");
  }
  // Opened for writing although nothing may be written through it: only such a connection removes
  // the -wal and -shm files when it is the last one to close.
  open(uri, SQLITE_OPEN_READWRITE);
  // Where those files cannot be made and no log is pending, the file alone holds everything.
  const int code =
      sqlite3_exec(handle(), "SELECT count(*) FROM sqlite_master; PRAGMA query_only = ON", nullptr,
                   nullptr, nullptr);
  if (lacks_side_files(code) && !has_pending_log(path)) {
    open(uri + "?immutable=1", SQLITE_OPEN_READONLY);
  } else if (code != SQLITE_OK) {
    fail("read");
  }
}

void Database::leave_log() {
  sqlite3_db_config(handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

bool Database::is_between_transactions() const { return sqlite3_get_autocommit(handle()) != 0; }

void Database::execute(const char* sql) {
  if (sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail(read_only_ ? "read" : "write");
  }
}

void Database::execute_patiently(const char* sql) {
  constexpr int kPauseMs = 5;
  for (int waited_ms = 0; waited_ms < busy_timeout_ms_; waited_ms += kPauseMs) {
    const int code = sqlite3_exec(handle(), sql, nullptr, nullptr, nullptr);
    if ((code & 0xff) != SQLITE_BUSY) break;
    sqlite3_sleep(kPauseMs);
  }
  execute(sql);
}

std::int64_t Database::query_integer(const char* sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string Database::query_text(const char* sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.text(0) : std::string();
}

void Database::fail(const char* doing) {
  const int code = sqlite3_extended_errcode(handle());
  // A connection for writing fails at its first read where it may not write.
  const bool may_not_write = !read_only_ && (code & 0xff) == SQLITE_READONLY;
  const bool is_damaged = (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB;
  if (is_damaged) leave_log();
  throw_error(place_, code, sqlite3_errmsg(handle()),
              std::string_view(doing) == "write" || may_not_write);
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(Database& database, const char* sql) : database_(database) {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v2(database.handle(), sql, -1, &raw, nullptr);
  statement_.reset(raw);
  if (code == SQLITE_OK) return;
  if ((code & 0xff) == SQLITE_ERROR) {  // the statements are ours: it is the tables that differ
    database.leave_log();
    throw DamageError(database.place(),
                      "is damaged (" + std::string(sqlite3_errmsg(database.handle())) + ")",
                      "take it from a backup, or learn the maps again into a new folder");
  }
  database.fail("read");
}

void Statement::check(int code) {
  if (code != SQLITE_OK) database_.fail("write");
}

Statement& Statement::bind(std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), next_parameter_++, value));
  return *this;
}

Statement& Statement::bind(double value) {
  if (std::isnan(value)) return bind_null();
  check(sqlite3_bind_double(statement_.get(), next_parameter_++, value));
  return *this;
}

Statement& Statement::bind(const std::string& value) {
  check(sqlite3_bind_text64(statement_.get(), next_parameter_++, value.data(), value.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(std::span<const std::byte> value) {
  // A null pointer would bind NULL; an empty blob is a value.
  const void* data = value.empty() ? static_cast<const void*>("") : value.data();
  check(sqlite3_bind_blob64(statement_.get(), next_parameter_++, data, value.size(),
                            SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_null() {
  check(sqlite3_bind_null(statement_.get(), next_parameter_++));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  database_.fail(sqlite3_stmt_readonly(statement_.get()) != 0 ? "read" : "write");
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
  next_parameter_ = 1;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const {
  if (is_null(column)) return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(statement_.get(), column);
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::string Statement::text(int column) const {
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  const void* data = sqlite3_column_blob(statement_.get(), column);
  return data == nullptr ? std::string() : std::string(static_cast<const char*>(data), size);
}

std::vector<std::byte> Statement::blob(int column) const {
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  if (data == nullptr) return {};
  return {data, data + size};
}

}  // namespace strata::memory::detail
