// SPDX-License-Identifier: Apache-2.0
/// A connection to PostgreSQL: statements with parameters, and errors that say what to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/error.hpp"

namespace strata::fleet {

/// A statement that the server refused or could not do; what it changed was undone.
class ServerError : public OutputError {
 public:
  ServerError(const std::string& place, const std::string& what, const std::string& remedy,
              std::string sqlstate)
      : OutputError(place, what, remedy), sqlstate_(std::move(sqlstate)) {}
  /// PostgreSQL's code of five characters.
  [[nodiscard]] const std::string& sqlstate() const { return sqlstate_; }

 private:
  std::string sqlstate_;
};

/// What the role may not do, or is not there for it.
class DeniedError : public InputError {
 public:
  using InputError::InputError;
};

/// The server cannot be reached, or is gone: nobody knows whether the statement under way was done.
class LostError : public OutputError {
 public:
  using OutputError::OutputError;
};

/// The value of $1, $2, ... in a statement.
class Parameter {
 public:
  Parameter(std::string text) : text_(std::move(text)) {}  // NOLINT(google-explicit-constructor)
  Parameter(const char* text) : text_(text) {}             // NOLINT(google-explicit-constructor)
  template <class Number>
  requires std::is_arithmetic_v<Number> Parameter(Number number)
      : text_(text_of(number)) {}  // NOLINT(google-explicit-constructor)
  /// A bytea, which must outlive the parameter.
  Parameter(std::span<const std::byte> bytes)  // NOLINT(google-explicit-constructor)
      : bytes_(bytes), is_bytes_(true) {}

  [[nodiscard]] bool is_bytes() const { return is_bytes_; }
  [[nodiscard]] const char* data() const;
  [[nodiscard]] std::size_t size() const { return is_bytes_ ? bytes_.size() : text_.size(); }

 private:
  static std::string text_of(bool value) { return value ? "true" : "false"; }
  static std::string text_of(std::int64_t value) { return std::to_string(value); }
  static std::string text_of(std::uint64_t value) { return std::to_string(value); }
  static std::string text_of(int value) { return std::to_string(value); }
  static std::string text_of(double value);

  std::string text_;
  std::span<const std::byte> bytes_;
  bool is_bytes_ = false;
};

/// What a query gave.
class Rows {
 public:
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool is_null(std::size_t row, int column) const;
  [[nodiscard]] std::string text(std::size_t row, int column) const;
  /// Throws OutputError where it is none.
  [[nodiscard]] std::int64_t integer(std::size_t row, int column) const;
  [[nodiscard]] double real(std::size_t row, int column) const;
  /// Of query_bytes. Lives as long as the rows.
  [[nodiscard]] std::span<const std::byte> bytes(std::size_t row, int column) const;
  /// How many rows the statement changed.
  [[nodiscard]] std::int64_t changed() const { return changed_; }

 private:
  friend class Connection;
  struct Result;
  std::shared_ptr<const Result> result_;
  std::int64_t changed_ = 0;
};

/// How long a server may take.
struct Patience {
  int connect_s = 10;
  int statement_s = 120;  ///< one statement, as the server counts
  int silence_s = 30;     ///< data that nobody acknowledges
};

/// One thread at a time.
class Connection {
 public:
  /// url: as libpq has it, postgresql://USER@HOST/DATABASE?sslmode=verify-full; what it says of
  /// timeouts holds. A password comes from there, PGPASSWORD or ~/.pgpass. Throws LostError when
  /// the server does not answer, DeniedError when it lets nobody in.
  explicit Connection(const std::string& url, const Patience& patience = {});
  ~Connection();
  Connection(Connection&&) noexcept;
  Connection& operator=(Connection&&) = delete;

  /// The server and its database, without user and password.
  [[nodiscard]] const std::string& place() const;
  /// Who logged in.
  [[nodiscard]] std::string user() const;
  /// Whether what is said is encrypted.
  [[nodiscard]] bool is_encrypted() const;

  /// One statement; values only as parameters. Throws ServerError, DeniedError and LostError.
  Rows query(const std::string& sql, std::span<const Parameter> parameters = {});
  Rows query(const std::string& sql, std::initializer_list<Parameter> parameters) {
    return query(sql, std::span(parameters.begin(), parameters.size()));
  }
  /// The same of a query whose columns are all bytea.
  Rows query_bytes(const std::string& sql, std::initializer_list<Parameter> parameters);
  /// Several statements without parameters, of our own making.
  void script(const std::string& sql);
  /// What the server keeps of a role's password (SCRAM-SHA-256), so that the password itself is
  /// never said, nor written to its log.
  [[nodiscard]] std::string verifier_of(const std::string& password, const std::string& role);
  /// Whoever waits for the server is told that it is gone (LostError), now and later. Thread-safe,
  /// as waited_s().
  void cut() const;
  /// How long the statement under way has been; 0: none is.
  [[nodiscard]] double waited_s() const;
  /// All that `body` does, or, when it throws, nothing of it.
  void transaction(const std::function<void()>& body);

 private:
  struct State;
  Rows run(const std::string& sql, std::span<const Parameter> parameters, bool as_bytes);
  [[noreturn]] void fail(const void* result);

  std::unique_ptr<State> state_;
};

/// The same server for another user, without a password.
[[nodiscard]] std::string url_for(const std::string& place, const std::string& user);
/// For messages: "postgresql://HOST:PORT/DATABASE". Throws InputError for what is no URL of libpq.
[[nodiscard]] std::string url_without_secrets(const std::string& url);

}  // namespace strata::fleet
