// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/register.hpp"

#include "components/live_view/live_view.hpp"

namespace strata::live_view {

void register_component(runtime::Registry& registry) { registry.add<LiveView>("strata::LiveView"); }

}  // namespace strata::live_view
