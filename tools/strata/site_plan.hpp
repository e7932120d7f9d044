// SPDX-License-Identifier: Apache-2.0
/// `strata site plan SITE ACTION`: the drawn floor plan of a site.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/strata/site_actions.hpp"

namespace strata::tools {

void add_plan_actions(CLI::App& plan, SiteOptions& options);
/// What was chosen of them.
void run_plan_action(const SiteOptions& options, VerbContext& context);

}  // namespace strata::tools
