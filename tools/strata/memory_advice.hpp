// SPDX-License-Identifier: Apache-2.0
/// Which setting makes a verb or a component need less memory.
#pragma once

#include <string>
#include <string_view>

namespace strata::tools {

/// For a verb that ran out of memory in a stage of its work (Progress); empty when none is known.
[[nodiscard]] std::string memory_advice(std::string_view verb, std::string_view stage);

/// For the component `name` of a type such as "strata::Localizer"; for others what helps most of
/// them.
[[nodiscard]] std::string memory_advice_of_component(std::string_view type, std::string_view name);

}  // namespace strata::tools
