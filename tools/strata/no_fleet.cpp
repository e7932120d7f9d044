// SPDX-License-Identifier: Apache-2.0
// In place of fleet_actions.cpp in a build without PostgreSQL.
#include "core/base/error.hpp"
#include "tools/strata/fleet_actions.hpp"

namespace strata::tools {

void run_fleet_action(const std::string& name, const FleetOptions& /*options*/,
                      VerbContext& /*context*/) {
  throw ConfigError("fleet " + name, "this program was built without PostgreSQL",
                    "build with STRATA_FLEET=ON, and run tools/install-packages before");
}

}  // namespace strata::tools
