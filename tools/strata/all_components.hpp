// SPDX-License-Identifier: Apache-2.0
/// Every component that compositions can name.
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::tools {

[[nodiscard]] runtime::Registry all_components();

}  // namespace strata::tools
