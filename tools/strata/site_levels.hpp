// SPDX-License-Identifier: Apache-2.0
/// `strata site levels SITE ...`.
#pragma once

#include "tools/strata/site_actions.hpp"

namespace strata::tools {

void add_level_actions(CLI::App& levels, SiteOptions& options);
void run_level_action(const SiteOptions& options, VerbContext& context);

/// What lifts are named that no level is, for people; empty: nothing.
[[nodiscard]] std::string unknown_lift_levels(const site::Site& site);

}  // namespace strata::tools
