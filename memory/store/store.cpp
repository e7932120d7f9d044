// SPDX-License-Identifier: Apache-2.0
#include "memory/store/store.hpp"

#include <new>

#include <sqlite3.h>

#include "core/base/damage.hpp"
#include "memory/store/detail/schema.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace detail {

void throw_missing(const std::string& place, const std::string& what) {
  throw InputError(place, "has no " + what, "learn it first, or give another store");
}

namespace {

/// SQLite tells of a page that it had no memory for as of one that is damaged.
void require_memory_to_check() {
  constexpr sqlite3_uint64 kCheckBytes = sqlite3_uint64{4} << 20U;  // twice its cache
  void* room = sqlite3_malloc64(kCheckBytes);
  if (room == nullptr) throw std::bad_alloc();
  sqlite3_free(room);
}

void check_for_damage(Database& database) {
  const std::string verdict = database.query_text("PRAGMA quick_check(1)");
  if (verdict == "ok") return;
  require_memory_to_check();
  database.leave_log();
  throw DamageError(database.place(), "is damaged (" + verdict + ")",
                    "take it from a backup, or learn the maps again into a new folder");
}

}  // namespace
}  // namespace detail

Store::Store(const std::filesystem::path& path, const StoreOptions& options)
    : path_(path), impl_(std::make_shared<Impl>(path, options)) {
  detail::prepare_schema(impl_->database);
  if (options.check) detail::check_for_damage(impl_->database);
}

Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

void Store::leave_as_is() { impl_->database.leave_log(); }

void Store::require_writable() const {
  if (!impl_->database.read_only()) return;
  throw OutputError(path_.string(), "was opened for reading only", "open it for writing");
}

void Store::transaction(const std::function<void()>& body) {
  require_writable();
  detail::Database& database = impl_->database;
  const bool is_inner = impl_->transaction_depth > 0;
  if (is_inner && database.is_between_transactions()) {
    // SQLite gave the outer one up at an error that its body did not pass on.
    throw OutputError(path_.string(), "a transaction was given up", "free some space, try again");
  }
  // IMMEDIATE takes the write lock now: waiting for it inside a transaction could not be retried.
  database.execute(is_inner ? "SAVEPOINT inner_transaction" : "BEGIN IMMEDIATE");
  ++impl_->transaction_depth;
  try {
    body();
    database.execute(is_inner ? "RELEASE inner_transaction" : "COMMIT");
  } catch (...) {
    --impl_->transaction_depth;
    try {
      database.execute(is_inner ? "ROLLBACK TO inner_transaction; RELEASE inner_transaction"
                                : "ROLLBACK");
    } catch (const Error&) {
      // SQLite has rolled back by itself already; the first error says why.
    }
    throw;
  }
  --impl_->transaction_depth;
}

void Store::save_text(const std::string& key, const std::string& value) {
  transaction([&] {
    detail::Statement(impl_->database, "REPLACE INTO text (key, value) VALUES (?, ?)")
        .bind(key)
        .bind(value)
        .run();
  });
}

std::optional<std::string> Store::find_text(const std::string& key) const {
  detail::Statement statement(impl_->database, "SELECT value FROM text WHERE key = ?");
  if (!statement.bind(key).step()) return std::nullopt;
  return statement.text(0);
}

std::vector<std::string> Store::text_keys(const std::string& prefix) const {
  detail::Statement statement(impl_->database, "SELECT key FROM text ORDER BY key");
  std::vector<std::string> keys;
  while (statement.step()) {
    if (std::string key = statement.text(0); key.starts_with(prefix)) {
      keys.push_back(std::move(key));
    }
  }
  return keys;
}

}  // namespace strata::memory
