// SPDX-License-Identifier: Apache-2.0
/// Owned handles of SQLite's C interface.
#pragma once

#include <memory>
#include <new>
#include <string>

#include <sqlite3.h>

namespace strata::log {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

/// What went wrong with the last call, for people. Throws std::bad_alloc where memory ran out,
/// which is no fault of the file. Null: there was no memory for a handle.
[[nodiscard]] inline std::string fault_of(sqlite3* database) {
  const int code = database == nullptr ? SQLITE_NOMEM : sqlite3_extended_errcode(database);
  if ((code & 0xff) == SQLITE_NOMEM || code == SQLITE_IOERR_NOMEM) throw std::bad_alloc();
  return sqlite3_errmsg(database);
}

/// Null when the statement does not fit the database; fault_of() says why.
[[nodiscard]] inline Statement prepare_statement(sqlite3* database, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql, -1, &statement, nullptr);
  return Statement(statement);
}

}  // namespace strata::log
