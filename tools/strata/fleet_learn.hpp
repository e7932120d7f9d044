// SPDX-License-Identifier: Apache-2.0
/// `strata fleet learn`: what all robots of a site saw, learned together.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "components/fleet/connection.hpp"
#include "components/site/site.hpp"
#include "tools/site/robot_check.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Learns every visit of the site on the server that its active version does not hold yet, on top
/// of that version, and writes the maps to `out`. Visits are taken in the order of their begin,
/// then of the robots' names: the same visits give the same bits, whoever pushed when. With
/// `limits`, robots beyond them are set aside on the server first, and warned of. Returns
/// summary.json, with `visits`, `robots` and `checked`. Throws InputError where the site has no
/// active version or the server nothing new.
nlohmann::json learn_fleet(fleet::Connection& connection, const site::Site& site,
                           const std::string& out, const std::optional<site::RobotLimits>& limits,
                           VerbContext& context);

/// Who was set aside and why, for a line of text; empty: nobody.
[[nodiscard]] std::string set_aside_in(const nlohmann::json& summary);

}  // namespace strata::tools
