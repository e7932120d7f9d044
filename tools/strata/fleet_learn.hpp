// SPDX-License-Identifier: Apache-2.0
/// `strata fleet learn`: what all robots of a site saw, learned together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/fleet/connection.hpp"
#include "components/site/site.hpp"
#include "tools/site/robot_check.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

struct FleetLearnTask {
  std::string out;                          ///< folder for the maps
  std::optional<site::RobotLimits> limits;  ///< none: nobody is judged
  std::vector<std::string> without;         ///< visits, as ROBOT:NUMBER
};

/// Learns every visit of the site on the server that its active version does not hold yet, on top
/// of that version, and writes the maps. Visits are taken in the order of their begin,
/// then of the robots' names: the same visits give the same bits, whoever pushed when. What is
/// wrong (fleet_check.hpp) or cannot be read is left out, and warned of. Returns summary.json, with
/// `visits`, `robots`, `checked` and `left_out`. Throws InputError where the site has no
/// active version or the server nothing new.
nlohmann::json learn_fleet(fleet::Connection& connection, const site::Site& site,
                           const FleetLearnTask& task, VerbContext& context);

/// What was left out, who was set aside and why, for a line of text; empty: nothing was.
[[nodiscard]] std::string set_aside_in(const nlohmann::json& summary);

}  // namespace strata::tools
