// SPDX-License-Identifier: Apache-2.0
/// Which visits `strata fleet learn` leaves out, and which robots it sets aside.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/fleet/connection.hpp"
#include "components/fleet/visits.hpp"
#include "tools/site/robot_check.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// "ROBOT:NUMBER", as warnings and --without name it.
[[nodiscard]] std::string name_of(const fleet::VisitName& visit);

/// The hashes of visits that are named so. Throws InputError for a name that the server has not.
[[nodiscard]] std::set<std::string> hashes_of(fleet::Connection& connection,
                                              const std::string& site,
                                              const std::vector<std::string>& names);

struct FleetCheck {
  nlohmann::json checked = nlohmann::json::array();   ///< what was found of each robot
  nlohmann::json left_out = nlohmann::json::array();  ///< visits, with the reason
};

/// Takes away what is not to be learned: visits from the server's future, and those that contradict
/// the active version's maps in `base` beyond the limits. A robot is set aside on the server, with
/// all of its visits, where most of those that it sent last are such. Warns of each. known: hashes
/// of visits that are not learned. Throws InputError where most robots' visits are from the future.
[[nodiscard]] FleetCheck check_visits(fleet::Connection& connection, const std::string& site,
                                      const std::filesystem::path& base,
                                      const std::set<std::string>& known,
                                      const site::RobotLimits& limits,
                                      std::vector<fleet::LearnedVisit>& visits,
                                      VerbContext& context);

}  // namespace strata::tools
