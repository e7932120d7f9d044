// SPDX-License-Identifier: Apache-2.0
/// Owned handles of SQLite's C interface.
#pragma once

#include <memory>

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

/// Null when the statement does not fit the database; sqlite3_errmsg says why.
[[nodiscard]] inline Statement prepare_statement(sqlite3* database, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql, -1, &statement, nullptr);
  return Statement(statement);
}

}  // namespace strata::log
