// SPDX-License-Identifier: Apache-2.0
/// Robots' clocks beside the server's.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "components/fleet/connection.hpp"
#include "components/fleet/visits.hpp"

namespace strata::fleet {

/// A clock that is off by more puts visits of several robots into a wrong order.
inline constexpr double kMaxClockOff_s = 2.0;
/// A visit that ends so long after the server received it was stamped by a wrong clock.
inline constexpr double kMaxVisitAhead_s = 60.0;

/// How this machine's clock stands to the server's, by one question: its answer is of some moment
/// between question and answer.
struct ClockOffset {
  double ahead_s = 0.0;   ///< negative: behind
  double within_s = 0.0;  ///< half the time that the answer took
  /// Certainly by more than kMaxClockOff_s.
  [[nodiscard]] bool is_off() const;
  /// What to say then; empty: it is not off.
  [[nodiscard]] std::string warning() const;
};
/// now_ns: Unix time.
[[nodiscard]] ClockOffset clock_offset(Connection& connection,
                                       const std::function<std::int64_t()>& now_ns);
/// ... by the system's clock.
[[nodiscard]] ClockOffset clock_offset(Connection& connection);

struct AheadVisit {
  VisitName name;
  double ahead_s = 0.0;  ///< its last scan is so long after the server received it
};
/// Of the visits that would be learned (visits.hpp), those whose clock was ahead by more than
/// kMaxVisitAhead_s. One that was behind cannot be told from one that was pushed late.
[[nodiscard]] std::vector<AheadVisit> visits_ahead(Connection& connection, const std::string& site,
                                                   const std::set<std::string>& known);

}  // namespace strata::fleet
