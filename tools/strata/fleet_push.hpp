// SPDX-License-Identifier: Apache-2.0
/// `strata fleet push`: what a robot saw, to where others learn from it.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "components/fleet/connection.hpp"
#include "components/fleet/visits.hpp"
#include "tools/strata/fleet_actions.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

struct FleetPushed {
  nlohmann::json summary;
  std::string text;                       ///< the same for people
  std::optional<fleet::VisitName> clash;  ///< refused: the server has another visit of its begin
};

/// Sends the visits in `options.folder` that the server does not have; with `options.against`,
/// relative to the active version of that site. Throws InputError where that is another site, and
/// as fleet::push().
[[nodiscard]] FleetPushed push_visits(fleet::Connection& connection, const FleetOptions& options,
                                      VerbContext& context);

}  // namespace strata::tools
