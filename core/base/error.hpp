// SPDX-License-Identifier: Apache-2.0
/// Typed errors that say where, what and how to mend it.
///
/// Constructors and parsers throw these; estimators return results with a `converged` flag instead.
#pragma once

#include <stdexcept>
#include <string>

namespace strata {

/// Base of all errors that a user can cause. `what()` reads "PLACE: WHAT; REMEDY".
class Error : public std::runtime_error {
 public:
  /// place: file:line, key path, topic or byte offset. remedy: what the user can do about it.
  Error(std::string place, std::string what, std::string remedy);

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }

 private:
  std::string place_;
  std::string problem_;
  std::string remedy_;
};

/// A log, map or composition file that cannot be read: missing, truncated or damaged.
class InputError : public Error {
 public:
  using Error::Error;
};

/// A configuration value that is unknown, of the wrong type or out of range.
class ConfigError : public Error {
 public:
  using Error::Error;
};

/// Writing failed: full disk, missing permission, locked database.
class OutputError : public Error {
 public:
  using Error::Error;
};

/// The user asked to stop (Progress::cancelled); what was written before stays readable.
class Cancelled : public Error {
 public:
  explicit Cancelled(std::string place);
};

}  // namespace strata
