// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/register.hpp"

#include "components/scan_matcher/scan_matcher.hpp"

namespace strata::scan_matcher {

void register_component(runtime::Registry& registry) {
  registry.add<ScanMatcher>("strata::ScanMatcher");
}

}  // namespace strata::scan_matcher
