// SPDX-License-Identifier: Apache-2.0
/// Which setting makes a verb need less memory.
#pragma once

#include <string>
#include <string_view>

namespace strata::tools {

/// For a verb that ran out of memory in a stage of its work (Progress); empty when none is known.
[[nodiscard]] std::string memory_advice(std::string_view verb, std::string_view stage);

}  // namespace strata::tools
