// SPDX-License-Identifier: Apache-2.0
/// What a fleet's server holds, as far as the one who asks may know.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/fleet/connection.hpp"
#include "components/fleet/schema.hpp"
#include "components/fleet/versions.hpp"

namespace strata::fleet {

struct RobotStatus {
  std::string robot;
  std::int64_t visits = 0;
  std::int64_t bytes = 0;  ///< of their payloads
  double path_m = 0.0;
  std::string last;       ///< when the last one came, in UTC; empty: none came
  std::string set_aside;  ///< why nothing is learned from it; empty: it is
};

struct SiteStatus {
  Member me;
  std::string site;
  std::string frame;
  bool is_encrypted = false;
  std::vector<RobotStatus> robots;  ///< by name; for a robot only itself
  std::vector<ServerVersion> versions;
};

/// O(visits). Throws InputError where there is no such site for who asks.
[[nodiscard]] SiteStatus status(Connection& connection, const std::string& site);

/// Nothing is learned from a robot's visits, old or new, for the reason given; an empty one takes
/// it back. Its visits stay. For an operator. Throws InputError where there is no such robot.
void set_aside(Connection& connection, const std::string& site, const std::string& robot,
               const std::string& why);

}  // namespace strata::fleet
