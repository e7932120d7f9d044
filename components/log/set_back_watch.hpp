// SPDX-License-Identifier: Apache-2.0
/// A clock that is set back while messages come, told from messages that come late.
#pragma once

#include <optional>

#include "core/base/time.hpp"

namespace strata::log {

/// A stamp further back than this is no mere disorder.
inline constexpr double kMinSetBackS = 1.0;

/// For one stream of a running robot. A whole log is mended by mend_set_back_clock, which sees what
/// comes after.
class SetBackWatch {
 public:
  enum class Verdict {
    kOn,       ///< at the newest stamp or past it
    kLate,     ///< a little before it
    kSuspect,  ///< far before it: late, or the first one of a clock that was set back
    kSetBack,  ///< the second one: the last suspect and this begin anew
  };
  Verdict add(Stamp stamp);
  /// By the clock as it is now; nothing before the first message.
  [[nodiscard]] std::optional<Stamp> newest() const { return newest_; }

 private:
  std::optional<Stamp> newest_;
  std::optional<Stamp> suspect_;
};

}  // namespace strata::log
