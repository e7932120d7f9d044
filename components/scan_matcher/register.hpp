// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::scan_matcher {

/// Makes strata::ScanMatcher known.
void register_component(runtime::Registry& registry);

}  // namespace strata::scan_matcher
