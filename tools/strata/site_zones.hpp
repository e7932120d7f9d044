// SPDX-License-Identifier: Apache-2.0
/// `strata site zones SITE ACTION`: what people draw over a site's maps.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "tools/strata/site_actions.hpp"

namespace strata::tools {

void add_zone_actions(CLI::App& zones, SiteOptions& options);
/// What was chosen of them.
void run_zone_action(const SiteOptions& options, VerbContext& context);

}  // namespace strata::tools
