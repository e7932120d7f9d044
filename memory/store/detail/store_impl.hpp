// SPDX-License-Identifier: Apache-2.0
/// What a Store holds, shared by the files that implement it.
#pragma once

#include <filesystem>
#include <string>

#include "memory/store/detail/database.hpp"
#include "memory/store/store.hpp"

namespace strata::memory {

struct Store::Impl {
  Impl(const std::filesystem::path& path, const StoreOptions& options)
      : database(path, options.read_only, options.busy_timeout_ms) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  detail::Database database;
  int transaction_depth = 0;
};

namespace detail {

/// While it lives, all reads see the store as of the first one, whatever others write.
class ReadScope {
 public:
  explicit ReadScope(Database& database) : database_(database) {
    database_.execute("SAVEPOINT read_scope");
  }
  ~ReadScope() {
    try {
      database_.execute("RELEASE read_scope");
    } catch (...) {  // a read has failed before this; its error is the one to report
    }
  }
  ReadScope(const ReadScope&) = delete;
  ReadScope& operator=(const ReadScope&) = delete;

 private:
  Database& database_;
};

[[noreturn]] void throw_missing(const std::string& place, const std::string& what);

/// Any grid of the table `grid`; kinds are told apart so that one is not read as another.
template <typename T>
void write_grid(Database& database, const std::string& name, const Grid<T>& grid);
template <typename T>
[[nodiscard]] Grid<T> read_grid(Database& database, const std::string& name);

}  // namespace detail
}  // namespace strata::memory
