// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/clock.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

namespace strata::fleet {
namespace {

constexpr double kNs = 1e9;

std::int64_t unix_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string seconds_text(double seconds) {
  char text[32];
  (void)std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

}  // namespace

bool ClockOffset::is_off() const { return std::abs(ahead_s) - within_s > kMaxClockOff_s; }

std::string ClockOffset::warning() const {
  if (!is_off()) return "";
  return "this machine's clock is " + seconds_text(std::abs(ahead_s)) +
         (ahead_s > 0.0 ? " ahead of" : " behind") +
         " the server's; set both by NTP: visits are learned in the order of their stamps";
}

ClockOffset clock_offset(Connection& connection, const std::function<std::int64_t()>& now_ns) {
  const std::int64_t asked = now_ns();
  const Rows rows =
      connection.query("SELECT (extract(epoch FROM clock_timestamp()) * 1e9)::bigint");
  const std::int64_t answered = now_ns();
  const double middle_s = static_cast<double>(asked - rows.integer(0, 0)) / kNs +
                          0.5 * static_cast<double>(answered - asked) / kNs;
  return {middle_s, 0.5 * static_cast<double>(answered - asked) / kNs};
}

ClockOffset clock_offset(Connection& connection) { return clock_offset(connection, unix_now_ns); }

std::vector<AheadVisit> visits_ahead(Connection& connection, const std::string& site,
                                     const std::set<std::string>& known) {
  const Rows rows = connection.query(
      "SELECT v.robot, v.visit, v.sha256, v.end_ns - (extract(epoch FROM v.received_at) * "
      "1e9)::bigint AS ahead FROM strata.visit AS v JOIN strata.robot AS r USING (site, robot) "
      "WHERE v.site = $1 AND r.set_aside IS NULL ORDER BY v.robot::text COLLATE \"C\", v.visit",
      {site});
  std::vector<AheadVisit> ahead;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double ahead_s = static_cast<double>(rows.integer(i, 3)) / kNs;
    if (ahead_s <= kMaxVisitAhead_s || known.contains(rows.text(i, 2))) continue;
    ahead.push_back({{rows.text(i, 0), rows.integer(i, 1), rows.text(i, 2)}, ahead_s});
  }
  return ahead;
}

}  // namespace strata::fleet
