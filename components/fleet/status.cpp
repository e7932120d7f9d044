// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/status.hpp"

namespace strata::fleet {
namespace {

const std::string kFigures =
    "count(v.visit), coalesce(sum(v.bytes), 0), coalesce(sum(v.path_m), 0), "
    "coalesce(to_char(max(v.received_at) AT TIME ZONE 'UTC', 'YYYY-MM-DD\"T\"HH24:MI:SS\"Z\"'), "
    "'')";

std::vector<RobotStatus> robots_of(Connection& connection, const Member& me,
                                   const std::string& site) {
  // A robot may not ask who else there is.
  const Rows rows =
      me.kind == MemberKind::kRobot
          ? connection.query("SELECT $2, " + kFigures +
                                 ", '' FROM strata.visit AS v WHERE site = $1 AND robot = $2",
                             {site, me.name})
          : connection.query("SELECT r.robot, " + kFigures +
                                 ", coalesce(r.set_aside, '') FROM strata.robot AS r LEFT JOIN "
                                 "strata.visit AS v USING (site, robot) WHERE r.site = $1 GROUP BY "
                                 "r.site, r.robot ORDER BY r.robot::text COLLATE \"C\"",
                             {site});
  std::vector<RobotStatus> robots;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    robots.push_back({rows.text(i, 0), rows.integer(i, 1), rows.integer(i, 2), rows.real(i, 3),
                      rows.text(i, 4), rows.text(i, 5)});
  }
  return robots;
}

}  // namespace

SiteStatus status(Connection& connection, const std::string& site) {
  SiteStatus found;
  found.me = require_member(connection, site);
  found.site = site;
  found.frame =
      connection.query("SELECT frame FROM strata.site WHERE site = $1", {site}).text(0, 0);
  found.is_encrypted = connection.is_encrypted();
  found.robots = robots_of(connection, found.me, site);
  found.versions = versions(connection, site);
  return found;
}

void set_aside(Connection& connection, const std::string& site, const std::string& robot,
               const std::string& why) {
  (void)require_member(connection, site);
  const Rows changed = connection.query(
      "UPDATE strata.robot SET set_aside = nullif($3, '') WHERE site = $1 AND robot = $2",
      {site, robot, why});
  if (changed.changed() == 1) return;
  throw InputError(connection.place(), "site " + site + " has no robot '" + robot + "'",
                   "`strata fleet status` says which there are");
}

}  // namespace strata::fleet
