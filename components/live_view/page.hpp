// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace strata::live_view {

/// page/index.html, packed into the program by CMake.
[[nodiscard]] std::string_view page();

}  // namespace strata::live_view
